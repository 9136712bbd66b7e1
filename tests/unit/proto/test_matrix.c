#include "support.h"

#include <math.h>

#include "proto/queries/matrix.h"

/* --- the request ------------------------------------------------------------------------------ */

DECODER(decode, struct proto_matrix_request, proto_matrix_request_decode)

#define ONE "[{\"vertex\":1}]"

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_matrix_request matrix;
    struct proto_problem problem;
    assert_true(decode("{\"targets\":[{\"vertex\":1},{\"vertex\":2}],\"sources\":" ONE "}", &matrix,
                       &problem));
    assert_true(matrix.sources.count == 1 && matrix.targets.count == 2 && !matrix.has_max_distance);
    assert_string_equal(matrix.targets.items[1].place, "/targets/1");
    proto_matrix_request_free(&matrix);
    proto_matrix_request_free(&matrix);
    assert_true(decode("{\"targets\":" ONE ",\"sources\":" ONE ",\"max_distance\":0.5}", &matrix,
                       &problem));
    assert_true(matrix.max_distance == 0.5);
    proto_matrix_request_free(&matrix);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{}", "/sources"},
        {"{\"sources\":" ONE "}", "/targets"},
        {"{\"sources\":[],\"targets\":" ONE "}", "/sources"},
        {"{\"sources\":" ONE ",\"targets\":[]}", "/targets"},
        {"{\"sources\":" ONE ",\"targets\":[1]}", "/targets/0"},
        {"{\"sources\":" ONE ",\"targets\":" ONE ",\"max_distance\":0}", "/max_distance"},
        {"{\"sources\":" ONE ",\"targets\":" ONE ",\"max_distance\":-1}", "/max_distance"},
        {"{\"sources\":" ONE ",\"targets\":" ONE ",\"max_distance\":\"1\"}", "/max_distance"},
        {"{\"sources\":" ONE ",\"targets\":" ONE ",\"via\":[]}", "/via"},
    };
    CHECK_REFUSED(decode, struct proto_matrix_request, cases)
}

/* Appends a JSON array of `count` vertices. */
static void append_vertices(struct proto_writer *writer, const char *key, uint32_t count)
{
    proto_write_key(writer, key);
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < count; i++) proto_write_raw(writer, "{\"vertex\":0}", 12);
    proto_write_array_end(writer);
}

static bool decode_size(uint32_t sources, uint32_t targets, struct proto_problem *problem)
{
    struct proto_writer writer = new_writer();
    proto_write_object_begin(&writer);
    append_vertices(&writer, "sources", sources);
    append_vertices(&writer, "targets", targets);
    proto_write_object_end(&writer);
    struct proto_matrix_request matrix = {0};
    json_t *document = proto_decode_document(writer.data, writer.size, problem);
    bool decoded = proto_matrix_request_decode(document, &matrix, problem) &&
                   proto_matrix_check(&matrix, problem);
    json_decref(document);
    proto_writer_free(&writer);
    proto_matrix_request_free(&matrix);
    return decoded;
}

static void has_a_largest_size(void **state)
{
    (void)state;
    struct proto_problem problem;
    assert_true(decode_size(2000, 2000, &problem));
    assert_true(decode_size(200, 20000, &problem));
    assert_false(decode_size(2000, 2001, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
    assert_int_equal(problem.limit, PROTO_MATRIX_ENTRIES);
    assert_non_null(strstr(problem.detail, "4002000"));
}

/* --- the answer ------------------------------------------------------------------------------- */

#define BOTH (PROTO_MATRIX_FIELD_DISTANCES | PROTO_MATRIX_FIELD_REASONS)

static void encodes_rows_and_reasons(void **state)
{
    (void)state;
    static const double whole[] = {0, 1.5, 2, 0.25, 0, 3}, holes[] = {0, INFINITY, NAN, 0.25, 0, 3};
    static const struct {
        const double *distances;
        uint32_t fields;
        const char *text;
    } cases[] = {
        {whole, BOTH, "{\"distances\":[[0,1.5,2],[0.25,0,3]]}"},
        {whole, PROTO_MATRIX_FIELD_REASONS, "{}"},
        {holes, BOTH,
         "{\"distances\":[[0,null,null],[0.25,0,3]],\"reasons\":[[null,\"no_path\",\"beyond_max_"
         "distance\"],"
         "[null,null,null]]}"},
        {holes, PROTO_MATRIX_FIELD_DISTANCES,
         "{\"distances\":[[0,null,null],[0.25,0,3]],\"reasons\":[[null,\"no_path\",\"beyond_max_"
         "distance\"],"
         "[null,null,null]]}"},
        {holes, PROTO_MATRIX_FIELD_REASONS,
         "{\"reasons\":[[null,\"no_path\",\"beyond_max_distance\"],[null,null,null]]}"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_matrix_answer answer = {cases[i].distances, 2, 3};
        struct proto_options options = {.fields = cases[i].fields};
        struct proto_writer writer = new_writer();
        proto_matrix_encode(&writer, &answer, &options);
        assert_written(&writer, cases[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),
        cmocka_unit_test(refuses_bad_bodies),
        cmocka_unit_test(has_a_largest_size),
        cmocka_unit_test(encodes_rows_and_reasons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
