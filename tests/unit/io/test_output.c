#include "tests/unit/io/reading.h"

#include "io/output.h"

static void writes_nested_values(void **state)
{
    (void)state;
    struct gd__output output = {0};
    gd__output_text(&output, "a ");
    gd__output_integer(&output, 0);
    gd__output_text(&output, " ");
    gd__output_integer(&output, UINT64_MAX);
    gd__output_text(&output, " ");
    gd__output_double(&output, -0.1);
    gd__output_little_endian(&output, 0x04030201, 3);
    gd__output_f32(&output, 1);
    gd__output_f64(&output, -2);
    static const char expected[] =
        "a 0 18446744073709551615 -0.1\1\2\3\0\0\x80\x3f\0\0\0\0\0\0\0\xc0";
    assert_false(output.failed);
    assert_int_equal(output.size, sizeof expected - 1);
    assert_memory_equal(output.bytes, expected, output.size);
    free(output.bytes);
}

/* Tests many small appends, and an append that is larger than the usual growth. */
static void grows(void **state)
{
    (void)state;
    static char block[100000];
    memset(block, 'x', sizeof block);
    struct gd__output output = {0};
    for (int i = 0; i < 3000; i++) gd__output_bytes(&output, block, 1);
    gd__output_bytes(&output, block, sizeof block);
    assert_int_equal(output.size, 3000 + sizeof block);
    assert_true(output.capacity >= output.size);
    for (size_t i = 0; i < output.size; i++) assert_int_equal(output.bytes[i], 'x');
    free(output.bytes);
}

/* Makes AddressSanitizer return NULL for huge allocations instead of ending the program. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "allocator_may_return_null=1";
}

/* A failed output frees its memory and ignores further text. */
static void stays_failed(void **state)
{
    (void)state;
    struct gd__output output = {0};
    gd__output_text(&output, "lost");
    gd__output_bytes(&output, "", PTRDIFF_MAX);
    assert_true(output.failed);
    assert_null(output.bytes);
    gd__output_text(&output, "more");
    gd__output_double(&output, 1);
    assert_true(output.failed);
    assert_int_equal(output.size, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_nested_values),
        cmocka_unit_test(grows),
        cmocka_unit_test(stays_failed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
