#include "support.h"

#include "proto/queries/batch.h"

/* --- lines ------------------------------------------------------------------------------------ */

static void assert_line(const struct proto_batch_line *line, const char *text, uint32_t number)
{
    assert_int_equal(line->size, strlen(text));
    assert_memory_equal(line->text, text, line->size);
    assert_int_equal(line->number, number);
}

static void blank_lines_count_and_are_skipped(void **state)
{
    (void)state;
    static const char text[] = "\n \t\r\none\r\n\ntwo";
    struct proto_batch_line line = {0};
    assert_true(proto_batch_next(text, strlen(text), &line));
    assert_line(&line, "one\r", 3);
    assert_true(proto_batch_next(text, strlen(text), &line));
    assert_line(&line, "two", 5);
    assert_false(proto_batch_next(text, strlen(text), &line));
    assert_false(proto_batch_next(text, strlen(text), &line));
    struct proto_batch_line none = {0};
    assert_false(proto_batch_next(NULL, 0, &none));
    assert_false(proto_batch_next("\n\n  ", 4, &none));
    struct proto_batch_line zero = {0};
    assert_true(proto_batch_next("\0\n", 2, &zero)); /* a NUL is not blank */
    assert_int_equal(zero.size, 1);
}

static struct proto_batch_line line_of(const char *text)
{
    return (struct proto_batch_line){
        .text = text, .size = strlen(text), .end = strlen(text), .number = 7};
}

static bool decode(const char *text, struct proto_batch_query *out, struct proto_problem *problem)
{
    struct proto_batch_line line = line_of(text);
    return proto_batch_decode(&line, out, problem);
}

static const char *const path_fields[] = {"distance", "reason", NULL};
static const struct proto_route path = {.fields = path_fields, .has_lines = true},
                                distance = {.fields = path_fields};

static void separates_its_own_members(void **state)
{
    (void)state;
    struct proto_batch_query query;
    struct proto_problem problem;
    assert_true(
        decode("{\"from\":1,\"query\":\"path\",\"geometry\":\"xyz\",\"select\":[\"a\",\"b\"]}",
               &query, &problem));
    assert_string_equal(query.name, "path");
    assert_string_equal(query.select, "a,b");
    assert_string_equal(query.geometry, "xyz");
    assert_true(query.has_select && query.has_geometry);
    assert_int_equal(json_object_size(query.document), 1);
    assert_non_null(json_object_get(query.document, "from"));
    proto_batch_query_free(&query);
    proto_batch_query_free(&query);
    assert_true(decode("{\"query\":\"path\",\"select\":\"a,b\"}", &query, &problem));
    assert_string_equal(query.select, "a,b");
    assert_false(query.has_geometry);
    proto_batch_query_free(&query);
}

static void takes_the_former_name_of_select(void **state)
{
    (void)state;
    struct proto_batch_query query;
    struct proto_problem problem;
    assert_true(decode("{\"query\":\"path\",\"fields\":[\"a\",\"b\"]}", &query, &problem));
    assert_string_equal(query.select, "a,b");
    assert_true(query.has_select && json_object_size(query.document) == 0);
    struct proto_options options;
    struct proto_parameters none = NO_QUERY;
    assert_false(proto_batch_options(&query, &none, &path, &options, &problem));
    assert_pointer(&problem, "/fields");
    proto_batch_query_free(&query);
    assert_false(
        decode("{\"query\":\"path\",\"fields\":\"a\",\"select\":\"a\"}", &query, &problem));
    assert_pointer(&problem, "/fields");
}

static void refuses_bad_lines(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {
        {"nonsense", ""},
        {"[]", ""},
        {"{}", "/query"},
        {"{\"query\":1}", "/query"},
        {"{\"query\":\"path\",\"select\":1}", "/select"},
        {"{\"query\":\"path\",\"select\":[]}", "/select"},
        {"{\"query\":\"path\",\"select\":[\"a\",1]}", "/select"},
        {"{\"query\":\"path\",\"geometry\":[\"xyz\"]}", "/geometry"},
        {"{\"query\":\"path\"} {}", ""},
        {"{\"query\":\"0123456789012345678901234567890123456789012345678901234567890123\"}",
         "/query"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_batch_query query;
        struct proto_problem problem;
        assert_false(decode(cases[i].text, &query, &problem));
        assert_pointer(&problem, cases[i].pointer);
        assert_null(strstr(problem.detail, "line 1"));
    }
}

/* The largest number of names that fits is accepted, and one more name is refused. */
static void fields_have_a_largest_size(void **state)
{
    (void)state;
    for (int names = 127; names <= 129; names++) {
        struct proto_batch_query query;
        struct proto_problem problem;
        char text[1024] = "{\"query\":\"path\",\"select\":[\"a\"";
        for (int i = 1; i < names; i++) strcat(text, ",\"a\"");
        strcat(text, "]}");
        bool fits = names <= PROTO_BATCH_SELECT / 2;
        assert_int_equal(decode(text, &query, &problem), fits);
        if (!fits) assert_pointer(&problem, "/select");
        if (fits) assert_int_equal(strlen(query.select), 2 * names - 1);
        if (fits) proto_batch_query_free(&query);
    }
}

static void a_line_has_a_largest_size(void **state)
{
    (void)state;
    char *text = test_calloc(PROTO_BATCH_LINE + 2, 1);
    memset(text, ' ', PROTO_BATCH_LINE + 1);
    memcpy(text, "{\"query\":\"path\"}", 16);
    struct proto_batch_line line = {.text = text, .size = PROTO_BATCH_LINE, .number = 1};
    struct proto_batch_query query;
    struct proto_problem problem;
    assert_true(proto_batch_decode(&line, &query, &problem));
    proto_batch_query_free(&query);
    line.size++;
    assert_false(proto_batch_decode(&line, &query, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, PROTO_BATCH_LINE);
    test_free(text);
}

/* --- options ---------------------------------------------------------------------------------- */

static void a_line_overrides_the_query_string(void **state)
{
    (void)state;
    struct proto_batch_query query = {.select = "reason", .has_select = true};
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters =
        QUERY("select", "distance", "geometry", "none", "timeout_ms", "5");
    assert_true(proto_batch_options(&query, &parameters, &path, &options, &problem));
    assert_true(options.fields == 2 && options.geometry == PROTO_GEOMETRY_NONE &&
                options.timeout_ms == 5);
    query.has_select = false;
    assert_true(proto_batch_options(&query, &parameters, &path, &options, &problem));
    assert_int_equal(options.fields, 1);
    struct proto_parameters none = NO_QUERY;
    assert_true(proto_batch_options(&query, &none, &path, &options, &problem));
    assert_true(options.fields == 3 && options.geometry == PROTO_GEOMETRY_FULL);
}

static void queries_without_lines_have_no_geometry(void **state)
{
    (void)state;
    struct proto_batch_query query = {.geometry = "none", .has_geometry = true};
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters none = NO_QUERY, all = QUERY("geometry", "none");
    assert_false(proto_batch_options(&query, &none, &distance, &options, &problem));
    assert_pointer(&problem, "/geometry");
    assert_true(proto_batch_options(&query, &none, &path, &options, &problem));
    query = (struct proto_batch_query){.geometry = "full", .has_geometry = true};
    assert_true(proto_batch_options(&query, &none, &distance, &options, &problem));
    /* Operations without the option `geometry` ignore it in the query string. */
    query = (struct proto_batch_query){0};
    assert_true(proto_batch_options(&query, &all, &distance, &options, &problem));
}

static void an_error_names_the_origin_of_a_bad_option(void **state)
{
    (void)state;
    struct proto_batch_query query = {.select = "nix", .has_select = true};
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("select", "x");
    assert_false(proto_batch_options(&query, &parameters, &path, &options, &problem));
    assert_pointer(&problem, "/select");
    assert_string_equal(problem.parameter, "");
    query = (struct proto_batch_query){
        .geometry = "nix", .has_geometry = true, .has_select = true, .select = "reason"};
    assert_false(proto_batch_options(&query, &parameters, &path, &options, &problem));
    assert_pointer(&problem, "/geometry");
    query = (struct proto_batch_query){0};
    assert_false(proto_batch_options(&query, &parameters, &path, &options, &problem));
    assert_parameter(&problem, "select");
}

/* --- the answer ------------------------------------------------------------------------------- */

static void write_object(struct proto_writer *writer, const char *key)
{
    proto_write_object_begin(writer);
    if (key) proto_write_key(writer, key);
    if (key) proto_write_uint(writer, 1);
    proto_write_object_end(writer);
}

static void answers_stand_beside_their_status(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    static const char *const keys[] = {"a", NULL, "b"};
    for (size_t i = 0; i < COUNT(keys); i++) {
        size_t begin = proto_batch_begin(&writer);
        write_object(&writer, keys[i]);
        proto_batch_end(&writer, begin);
    }
    assert_written(&writer,
                   "{\"status\":200,\"a\":1}\n{\"status\":200}\n{\"status\":200,\"b\":1}\n");
}

static void a_problem_takes_the_place_of_its_line_only(void **state)
{
    (void)state;
    struct proto_writer writer = new_writer();
    struct proto_batch_line line = line_of("nonsense");
    struct proto_problem problem;
    size_t begin = proto_batch_begin(&writer);
    write_object(&writer, "a");
    proto_batch_end(&writer, begin);
    begin = proto_batch_begin(&writer);
    write_object(&writer, "half an answer");
    proto_problem_refuse(&problem, "/to", "wrong");
    proto_batch_refuse(&writer, begin, &line, &problem);
    begin = proto_batch_begin(&writer);
    write_object(&writer, "b");
    proto_batch_end(&writer, begin);
    assert_written(
        &writer,
        "{\"status\":200,\"a\":1}\n"
        "{\"type\":\"urn:geodesicd:problem:invalid_request\",\"title\":\"Invalid request\","
        "\"status\":400,\"detail\":\"wrong\",\"code\":\"invalid_request\",\"pointer\":\"/to\","
        "\"elements\":[{\"line\":7}]}\n"
        "{\"status\":200,\"b\":1}\n");
}

static void an_answer_that_does_not_fit_becomes_a_problem(void **state)
{
    (void)state;
    struct proto_writer writer;
    struct proto_batch_line line = line_of("");
    struct proto_problem problem;
    proto_writer_init(&writer, 400);
    size_t begin = proto_batch_begin(&writer);
    for (int i = 0; i < 100; i++) proto_write_uint(&writer, UINT64_MAX);
    assert_int_equal(writer.failure, PROTO_WRITER_TOO_LARGE);
    proto_batch_end(&writer, begin);
    proto_problem_set(&problem, PROTO_PROBLEM_INSUFFICIENT_MEMORY, "no");
    problem.element = GD_ELEMENT_VERTEX;
    problem.element_count = 1;
    problem.elements[0][0] = 3;
    proto_batch_refuse(&writer, begin, &line, &problem);
    assert_written(
        &writer,
        "{\"type\":\"urn:geodesicd:problem:insufficient_memory\",\"title\":\"Insufficient memory\","
        "\"status\":507,\"detail\":\"no\",\"code\":\"insufficient_memory\","
        "\"elements\":[{\"vertex\":3}]}\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blank_lines_count_and_are_skipped),
        cmocka_unit_test(separates_its_own_members),
        cmocka_unit_test(takes_the_former_name_of_select),
        cmocka_unit_test(refuses_bad_lines),
        cmocka_unit_test(fields_have_a_largest_size),
        cmocka_unit_test(a_line_has_a_largest_size),
        cmocka_unit_test(a_line_overrides_the_query_string),
        cmocka_unit_test(queries_without_lines_have_no_geometry),
        cmocka_unit_test(an_error_names_the_origin_of_a_bad_option),
        cmocka_unit_test(answers_stand_beside_their_status),
        cmocka_unit_test(a_problem_takes_the_place_of_its_line_only),
        cmocka_unit_test(an_answer_that_does_not_fit_becomes_a_problem),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
