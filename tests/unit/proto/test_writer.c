#include "support.h"

#include <math.h>

static void places_commas(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    proto_write_object_begin(&writer);
    proto_write_key(&writer, "a");
    proto_write_array_begin(&writer);
    proto_write_array_end(&writer);
    proto_write_key(&writer, "b");
    proto_write_array_begin(&writer);
    proto_write_uint(&writer, UINT64_MAX);
    proto_write_int(&writer, INT64_MIN);
    proto_write_object_begin(&writer);
    proto_write_object_end(&writer);
    proto_write_bool(&writer, true);
    proto_write_bool(&writer, false);
    proto_write_null(&writer);
    proto_write_raw(&writer, "[1]", 3);
    proto_write_string(&writer, NULL);
    proto_write_array_end(&writer);
    proto_write_key(&writer, "c");
    proto_write_numbers(&writer, (const double[]){0.5, -2, NAN, INFINITY, -INFINITY}, 5);
    proto_write_object_end(&writer);
    assert_written(
        &writer,
        "{\"a\":[],\"b\":[18446744073709551615,-9223372036854775808,{},true,false,null,[1],null],"
        "\"c\":[0.5,-2,null,null,null]}");
}

/* Writes more triples than the writer formats at a time. The text equals that of single triples. */
static void triples_are_arrays_of_three(void **state)
{
    (void)state;
    double values[30][3];
    struct proto_writer writer, other;
    proto_writer_init(&writer, 1 << 20);
    proto_writer_init(&other, 1 << 20);
    for (int i = 0; i < 90; i++) (&values[0][0])[i] = i % 7 ? i * 1.1 - 50 : i % 2 ? NAN : 0;
    proto_write_array_begin(&writer);
    proto_write_triples(&writer, values, 0);
    proto_write_triples(&writer, values, 1);
    proto_write_triples(&writer, values + 1, 29);
    proto_write_array_end(&writer);
    proto_write_array_begin(&other);
    for (int i = 0; i < 30; i++) proto_write_numbers(&other, values[i], 3);
    proto_write_array_end(&other);
    assert_int_equal(writer.size, other.size);
    assert_memory_equal(writer.data, other.data, other.size);
    proto_writer_free(&writer);
    proto_writer_free(&other);
}

static void escapes_strings(void **state)
{
    (void)state;
    static const struct {
        const char *text, *json;
    } cases[] = {
        {"", "\"\""},
        {"bunny", "\"bunny\""},
        {"a\"b\\c/d", "\"a\\\"b\\\\c/d\""},
        {"\b\f\n\r\t", "\"\\b\\f\\n\\r\\t\""},
        {"\x01\x1f\x7f", "\"\\u0001\\u001f\x7f\""},
        {"gr\xc3\xb6\xc3\x9f"
         "er",
         "\"gr\xc3\xb6\xc3\x9f"
         "er\""},
        {"\xf0\x9f\x90\xb0", "\"\xf0\x9f\x90\xb0\""},
        {"a\xff"
         "b",
         "\"a\xef\xbf\xbd"
         "b\""},
        {"\xc3", "\"\xef\xbf\xbd\""},
        {"\xed\xa0\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\""},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_writer writer = new_writer();
        proto_write_string(&writer, cases[i].text);
        assert_written(&writer, cases[i].json);
    }
}

static void appends_plain_text(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    proto_append(&writer, "# HELP x\n", 9);
    proto_append_format(&writer, "x %d\n", 42);
    proto_append(&writer, "", 0);
    assert_written(&writer, "# HELP x\nx 42\n");
}

static void grows(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    proto_write_array_begin(&writer);
    for (int i = 0; i < 50000; i++) proto_write_uint(&writer, (uint64_t)i);
    proto_write_array_end(&writer);
    struct proto_problem problem;
    assert_true(proto_writer_check(&writer, &problem));
    assert_int_equal(writer.size,
                     /* number of digits, commas and brackets */
                     10 + 2 * 90 + 3 * 900 + 4 * 9000 + 5 * 40000 + 49999 + 2);
    proto_writer_free(&writer);
}

static void stops_at_its_maximum_for_good(void **state)
{
    (void)state;
    struct proto_writer writer;
    struct proto_problem problem;
    proto_writer_init(&writer, 8);
    proto_append(&writer, "12345678", 8);
    assert_true(proto_writer_check(&writer, &problem));
    proto_append(&writer, "9", 1);
    proto_append(&writer, "", 0);
    assert_false(proto_writer_check(&writer, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    assert_int_equal(problem.limit, 8);
    size_t size;
    assert_null(proto_writer_take(&writer, &size));
    assert_int_equal(writer.size, 8);

    proto_writer_free(&writer);

    proto_append(&writer, "123456789", 9); /* too long */
    proto_append(&writer, "1", 1);         /* the text would fit, but the writer has failed */
    proto_append_format(&writer, "%d", 1);
    proto_write_number(&writer, 1);
    assert_int_equal(writer.size, 0);
    assert_false(proto_writer_check(&writer, &problem));
    proto_writer_free(&writer);
}

static void a_maximum_need_not_be_a_power_of_two(void **state)
{
    (void)state;
    struct proto_writer writer;
    struct proto_problem problem;
    proto_writer_init(&writer, 3000);
    for (int i = 0; i < 3000; i++) proto_append(&writer, "x", 1);
    assert_true(proto_writer_check(&writer, &problem));
    assert_int_equal(writer.size, 3000);
    assert_int_equal(writer.capacity, 3000);
    proto_append(&writer, "x", 1);
    assert_false(proto_writer_check(&writer, &problem));
    proto_writer_free(&writer);
    proto_writer_free(&writer);
}

static void reserves_the_expected_size_once(void **state)
{
    (void)state;
    struct proto_writer writer;
    proto_writer_init(&writer, 10000);
    proto_writer_expect(&writer, 5000);
    assert_int_equal(writer.capacity, 5000);
    const char *data = writer.data;
    for (int i = 0; i < 5000; i++) proto_append(&writer, "x", 1);
    assert_ptr_equal(writer.data, data);
    proto_append(&writer, "x", 1);
    assert_int_equal(writer.capacity, 10000);
    proto_writer_expect(&writer, 5000); /* this exceeds the maximum, but only a later write fails */
    assert_int_equal(writer.failure, PROTO_WRITER_FINE);
    proto_writer_free(&writer);
}

/* --- memory account --------------------------------------------------------------------------- */

struct budget {
    size_t taken, most;
};

static bool take(void *user, size_t bytes)
{
    struct budget *budget = user;
    if (budget->taken + bytes > budget->most) return false;
    budget->taken += bytes;
    return true;
}

static void give(void *user, size_t bytes)
{
    struct budget *budget = user;
    assert_true(bytes <= budget->taken);
    budget->taken -= bytes;
}

static void append_many(struct proto_writer *writer, size_t count)
{
    for (size_t i = 0; i < count; i++) proto_append(writer, "x", 1);
}

static void counts_large_buffers_until_they_are_freed(void **state)
{
    (void)state;
    struct budget budget = {.most = SIZE_MAX};
    const struct proto_writer_account account = {take, give, &budget, SIZE_MAX};
    struct proto_writer writer;
    proto_writer_init(&writer, SIZE_MAX);
    writer.account = &account;
    append_many(&writer, PROTO_WRITER_SMALL);
    assert_int_equal(budget.taken, 0);
    append_many(&writer, 1);
    assert_int_equal(budget.taken, writer.capacity);
    append_many(&writer, 3000000);
    assert_int_equal(budget.taken, writer.capacity);
    assert_true(writer.capacity <
                /* the free part of the block is less than a third */
                writer.size + writer.size / 3);
    proto_writer_free(&writer);
    assert_int_equal(budget.taken, 0);

    append_many(&writer, 20000); /* the block is counted again after proto_writer_free */
    size_t size = 0;
    char *text = proto_writer_take(&writer, &size);
    assert_int_equal(budget.taken,
                     proto_writer_counted(size)); /* the free part is no longer counted */
    give(&budget, proto_writer_counted(size));
    free(text);
    proto_writer_free(&writer);
}

static void fails_when_there_is_no_room(void **state)
{
    (void)state;
    struct budget budget = {.most = 100000};
    const struct proto_writer_account account = {take, give, &budget, SIZE_MAX};
    struct proto_writer writer;
    struct proto_problem problem;
    proto_writer_init(&writer, SIZE_MAX);
    writer.account = &account;
    append_many(&writer, 200000);
    assert_true(writer.size <= 100000);
    assert_false(proto_writer_check(&writer, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_INSUFFICIENT_MEMORY);
    assert_int_equal(problem.retry_after, 1);
    proto_writer_free(&writer);
    assert_int_equal(budget.taken, 0);
}

static void a_text_that_never_fits_is_too_large(void **state)
{
    (void)state;
    struct budget budget = {.most = SIZE_MAX};
    const struct proto_writer_account account = {take, give, &budget, 100000};
    struct proto_writer writer;
    struct proto_problem problem;
    proto_writer_init(&writer, SIZE_MAX);
    writer.account = &account;
    append_many(&writer, 100000);
    assert_true(proto_writer_check(&writer, &problem));
    append_many(&writer, 1);
    assert_false(proto_writer_check(&writer, &problem));
    assert_int_equal(problem.limit, 100000);
    assert_int_equal(problem.retry_after, 0);
    proto_writer_free(&writer);
    assert_int_equal(budget.taken, 0);
}

struct drain {
    char text[4096];
    size_t size, most; /* largest block */
    size_t left;       /* number of blocks that the sink still accepts */
};

static bool drain_write(void *user, const char *text, size_t size)
{
    struct drain *drain = user;
    if (drain->left-- == 0) return false;
    assert_true(drain->size + size <= sizeof drain->text);
    memcpy(drain->text + drain->size, text, size);
    drain->size += size;
    if (size > drain->most) drain->most = size;
    return true;
}

static void write_rows(struct proto_writer *writer)
{
    static const double numbers[] = {0.1, 1.0 / 3, 1e-300, NAN, -12345.678901234567};
    proto_write_object_begin(writer);
    proto_write_key(writer, "rows");
    proto_write_array_begin(writer);
    for (int i = 0; i < 20; i++) proto_write_numbers(writer, numbers, 5);
    proto_write_array_end(writer);
    proto_write_string(writer, "the\nend");
    proto_write_object_end(writer);
}

static void passes_the_text_to_a_sink(void **state)
{
    (void)state;
    struct drain drain = {.left = SIZE_MAX};
    const struct proto_writer_sink sink = {drain_write, &drain, 600};
    struct proto_writer whole, writer;
    proto_writer_init(&whole, SIZE_MAX);
    proto_writer_init(&writer, SIZE_MAX);
    writer.sink = &sink;
    write_rows(&whole);
    write_rows(&writer);
    assert_true(writer.capacity <= 600);
    proto_writer_flush(&writer);
    assert_int_equal(writer.failure, PROTO_WRITER_FINE);
    assert_int_equal(writer.flushed, whole.size);
    assert_int_equal(drain.size, whole.size);
    assert_memory_equal(drain.text, whole.data, whole.size);
    assert_true(drain.most <= 600);
    proto_writer_free(&whole);
    proto_writer_free(&writer);
}

/* Tests texts that have exactly the maximum size or one byte more, and a sink that refuses a
 * block. */
static void a_sink_can_stop_the_writer(void **state)
{
    (void)state;
    struct drain drain = {.left = SIZE_MAX};
    struct proto_writer_sink sink = {drain_write, &drain, 600};
    struct proto_writer writer;
    struct proto_problem problem;
    proto_writer_init(&writer, SIZE_MAX);
    write_rows(&writer);
    size_t size = writer.size;
    for (int lacking = 0; lacking < 2; lacking++) {
        proto_writer_free(&writer);
        drain.size = 0;
        /* the limit is 1000 bytes larger, because writing a row reserves memory for later rows */
        proto_writer_init(&writer, lacking ? size - 1 : size + 1000);
        writer.sink = &sink;
        write_rows(&writer);
        proto_writer_flush(&writer);
        assert_int_equal(writer.failure, lacking ? PROTO_WRITER_TOO_LARGE : PROTO_WRITER_FINE);
    }
    proto_writer_free(&writer);
    proto_writer_init(&writer, SIZE_MAX);
    drain = (struct drain){.left = 1};
    writer.sink = &sink;
    write_rows(&writer);
    assert_false(proto_writer_check(&writer, &problem));
    assert_int_equal(writer.failure, PROTO_WRITER_STOPPED);
    proto_writer_free(&writer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triples_are_arrays_of_three),
        cmocka_unit_test(places_commas),
        cmocka_unit_test(escapes_strings),
        cmocka_unit_test(appends_plain_text),
        cmocka_unit_test(grows),
        cmocka_unit_test(stops_at_its_maximum_for_good),
        cmocka_unit_test(a_maximum_need_not_be_a_power_of_two),
        cmocka_unit_test(reserves_the_expected_size_once),
        cmocka_unit_test(counts_large_buffers_until_they_are_freed),
        cmocka_unit_test(fails_when_there_is_no_room),
        cmocka_unit_test(a_text_that_never_fits_is_too_large),
        cmocka_unit_test(passes_the_text_to_a_sink),
        cmocka_unit_test(a_sink_can_stop_the_writer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
