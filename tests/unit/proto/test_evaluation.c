#include "support.h"

#include <math.h>

#include "proto/queries/evaluation.h"

/* --- the request ------------------------------------------------------------------------------ */

DECODER(decode, struct proto_evaluation_request, proto_evaluation_request_decode)
DECODER(decode_with_set, struct proto_set_distance_request, proto_set_distance_request_decode)

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_evaluation_request evaluation;
    struct proto_set_distance_request with_set;
    struct proto_problem problem;
    assert_true(decode("{\"points\":[{\"vertex\":1},{\"vertex\":2}],\"gradient\":true}",
                       &evaluation, &problem));
    assert_int_equal(evaluation.points.count, 2);
    assert_true(evaluation.gradient && !evaluation.path);
    proto_evaluation_request_free(&evaluation);
    proto_evaluation_request_free(&evaluation);
    assert_true(decode_with_set(
        "{\"points\":[{\"vertex\":1}],\"path\":true,\"set\":{\"points\":[{\"vertex\":0}]}}",
        &with_set, &problem));
    assert_true(with_set.path && with_set.points.count == 1);
    proto_set_distance_request_free(&with_set);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool with_set;
        const char *pointer;
    } cases[] = {
        {"[]", false, ""},
        {"{}", false, "/points"},
        {"{\"points\":[]}", false, "/points"},
        {"{\"points\":[{\"vertex\":1},{\"vertex\":-1}]}", false, "/points/1/vertex"},
        {"{\"points\":[{\"vertex\":1}],\"path\":1}", false, "/path"},
        {"{\"points\":[{\"vertex\":1}],\"gradient\":\"yes\"}", false, "/gradient"},
        {"{\"points\":[{\"vertex\":1}],\"set\":{}}", false, "/set"},
        {"{\"points\":[{\"vertex\":1}]}", true, "/set"},
        {"{\"points\":[{\"vertex\":1}],\"set\":{\"points\":[{\"vertex\":0}]},\"gradient\":true}",
         true, "/gradient"},
        {"{\"points\":[{\"vertx\":1}],\"set\":{\"points\":[{\"vertex\":0}]}}", true,
         "/points/0/vertx"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_evaluation_request evaluation;
        struct proto_set_distance_request with_set;
        struct proto_problem problem;
        assert_false(cases[i].with_set ? decode_with_set(cases[i].text, &with_set, &problem)
                                       : decode(cases[i].text, &evaluation, &problem));
        assert_pointer(&problem, cases[i].pointer);
    }
}

/* --- the answer ------------------------------------------------------------------------------- */

static void only_requested_fields_are_computed(void **state)
{
    (void)state;
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = NO_QUERY;
    assert_true(proto_options_parse(&parameters, proto_evaluation_fields,
                                    proto_evaluate_field_parameters, &options, &problem));
    assert_false(proto_evaluation_wanted(&options, false, false) &
                 (PROTO_EVALUATION_FIELD_PATH | PROTO_EVALUATION_FIELD_GRADIENT));
    assert_true(proto_evaluation_wanted(&options, true, true) & PROTO_EVALUATION_FIELD_GRADIENT);
    parameters = QUERY("select", "distance,path");
    assert_true(proto_options_parse(&parameters, proto_evaluation_fields,
                                    proto_evaluate_field_parameters, &options, &problem));
    assert_int_equal(proto_evaluation_wanted(&options, false, false),
                     PROTO_EVALUATION_FIELD_DISTANCE);
    assert_int_equal(proto_evaluation_wanted(&options, true, true),
                     PROTO_EVALUATION_FIELD_DISTANCE | PROTO_EVALUATION_FIELD_PATH);
    parameters = QUERY("select", "results");
    assert_true(proto_options_parse(&parameters, proto_evaluation_fields,
                                    proto_evaluate_field_parameters, &options, &problem));
    assert_true(proto_evaluation_wanted(&options, true, true) & PROTO_EVALUATION_FIELD_NEAREST);
}

#define CORNER "{\"face\":0,\"barycentric\":[1,0,0],\"xyz\":[0,0,0],\"vertex\":0}"

static void encodes_results(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_seed seed;
    struct gd_point ends[2];
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &ends[1], NULL), GD_OK);
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &ends[0], NULL), GD_OK);
    seed = (struct gd_seed){.point = ends[1]};
    uint32_t offset = 0, member = 0;
    const struct proto_located_set set = {.count = 1,
                                          .seed_count = 1,
                                          .seeds = &seed,
                                          .members = &member,
                                          .label_offsets = &offset,
                                          .labels = "a\"",
                                          .label_size = 3};
    const struct gd_path path = {.length = 1, .count = 2, .points = ends};
    const uint32_t all = UINT32_MAX & ~(uint32_t)PROTO_EVALUATION_FIELD_GRADIENT;
    const struct {
        struct proto_result result;
        uint32_t wanted;
        const char *text;
    } cases[] = {
        {{.distance = 1, .path = &path, .nearest = ends[1]},
         all,
         "{\"distance\":1,\"nearest\":{\"index\":0,\"label\":\"a\\\"\",\"point\":" CORNER "},"
         "\"path\":{\"length\":1,\"points\":[[1,0,0],[0,0,0]]}}"},
        {{.distance = 1}, PROTO_EVALUATION_FIELD_DISTANCE, "{\"distance\":1}"},
        {{.distance = INFINITY},
         all,
         "{\"distance\":null,\"reason\":\"no_path\",\"nearest\":null,\"path\":null}"},
        {{.distance = NAN}, PROTO_EVALUATION_FIELD_REASON, "{\"reason\":\"beyond_max_distance\"}"},
        {{.distance = 1, .has_gradient = true, .gradient = {.angle = 0.5, .xyz = {0, 0, 1}}},
         PROTO_EVALUATION_FIELD_GRADIENT,
         "{\"gradient\":{\"angle\":0.5,\"xyz\":[0,0,1]}}"},
        {{.distance = 0}, PROTO_EVALUATION_FIELD_GRADIENT, "{\"gradient\":null}"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct proto_writer writer = new_writer();
        proto_result_encode(&writer, mesh, &set, &cases[i].result, cases[i].wanted,
                            PROTO_GEOMETRY_XYZ);
        assert_written(&writer, cases[i].text);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),
        cmocka_unit_test(refuses_bad_bodies),
        cmocka_unit_test(encodes_results),
        cmocka_unit_test(only_requested_fields_are_computed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
