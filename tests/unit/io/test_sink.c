#include "tests/unit/io/reading.h"

#include "io/sink.h"

static void writes_one_thing_after_another(void **state)
{
    (void)state;
    struct gd__sink sink = {0};
    gd__sink_text(&sink, "a ");
    gd__sink_integer(&sink, 0);
    gd__sink_text(&sink, " ");
    gd__sink_integer(&sink, UINT64_MAX);
    gd__sink_text(&sink, " ");
    gd__sink_double(&sink, -0.1);
    gd__sink_little_endian(&sink, 0x04030201, 3);
    gd__sink_f32(&sink, 1);
    gd__sink_f64(&sink, -2);
    static const char expected[] = "a 0 18446744073709551615 -0.1\1\2\3\0\0\x80\x3f\0\0\0\0\0\0\0\xc0";
    assert_false(sink.failed);
    assert_int_equal(sink.size, sizeof expected - 1);
    assert_memory_equal(sink.bytes, expected, sink.size);
    free(sink.bytes);
}

/* By little steps, and by one that is longer than the growth. */
static void grows(void **state)
{
    (void)state;
    static char block[100000];
    memset(block, 'x', sizeof block);
    struct gd__sink sink = {0};
    for (int i = 0; i < 3000; i++) gd__sink_bytes(&sink, block, 1);
    gd__sink_bytes(&sink, block, sizeof block);
    assert_int_equal(sink.size, 3000 + sizeof block);
    assert_true(sink.capacity >= sink.size);
    for (size_t i = 0; i < sink.size; i++) assert_int_equal(sink.bytes[i], 'x');
    free(sink.bytes);
}

/* AddressSanitizer would end the program where malloc says that there is no memory. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "allocator_may_return_null=1";
}

/* What fails gives its memory back and takes no more. */
static void fails_once_for_all(void **state)
{
    (void)state;
    struct gd__sink sink = {0};
    gd__sink_text(&sink, "lost");
    gd__sink_bytes(&sink, "", PTRDIFF_MAX);
    assert_true(sink.failed);
    assert_null(sink.bytes);
    gd__sink_text(&sink, "more");
    gd__sink_double(&sink, 1);
    assert_true(sink.failed);
    assert_int_equal(sink.size, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_one_thing_after_another),
        cmocka_unit_test(grows),
        cmocka_unit_test(fails_once_for_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
