#include "support.h"

#include <math.h>

#include "proto/queries/made_mesh.h"
#include "proto/queries/jet.h"
#include "proto/queries/limit_paths.h"

/* Creates a surface from a triangle and a square. */
static struct gd_subdivision *new_surface(void)
{
    static double positions[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
    static uint32_t corners[] = {1, 4, 2, 0, 1, 2, 3}, first[] = {0, 3, 7};
    const struct gd_control_mesh mesh = {.polygons = {.positions = positions,
                                                      .position_count = 5,
                                                      .polygon_count = 2,
                                                      .corners = corners,
                                                      .first = first}};
    struct gd_subdivision *surface = NULL;
    assert_int_equal(gd_subdivision_create(&mesh, GD_SCHEME_CATMULL_CLARK, NULL, &surface, NULL),
                     GD_OK);
    return surface;
}

static void decodes_places(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
        enum proto_problem_code code;
    } cases[] = {
        {"{\"points\":7}", "/points", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"points\":[]}", "/points", PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"points\":[{\"face\":1,\"uv\":[0,0]},{\"face\":2,\"uv\":[0,0]}]}", "/points/1/face",
         PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"points\":[{\"face\":0,\"corner\":3,\"uv\":[0,0]}]}", "/points/0/face",
         PROTO_PROBLEM_INVALID_REQUEST},
        {"{\"points\":[{\"face\":0,\"uv\":[0,1.5]}]}", "/points/0/uv",
         PROTO_PROBLEM_POINT_NOT_ON_SURFACE},
        {"{\"points\":[{\"face\":0,\"uv\":[0,1],\"w\":1}]}", "/points/0/w",
         PROTO_PROBLEM_INVALID_REQUEST},
    };
    struct gd_subdivision *surface = new_surface();
    struct proto_limit_places found;
    struct proto_problem problem;
    for (size_t i = 0; i < COUNT(cases); i++) {
        json_t *document = parse(cases[i].text);
        assert_false(proto_limit_jets_decode(document, surface, &found, &problem));
        assert_int_equal(problem.code, cases[i].code);
        assert_string_equal(problem.pointer, cases[i].pointer);
        json_decref(document);
    }
    json_t *document = parse("{\"points\":[{\"face\":0,\"corner\":2,\"uv\":[0.25,1.0000000001]},{"
                             "\"uv\":[1,0],\"face\":1}]}");
    assert_true(proto_limit_jets_decode(document, surface, &found, &problem));
    assert_true(found.count == 2 && found.items[0].corner == 2 && found.items[0].v == 1 &&
                found.items[1].face == 1);
    struct proto_writer writer = new_writer();
    proto_limit_place_encode(&writer, &found.items[0], (struct gd_vec3){1, 2, 3});
    assert_written(&writer, "{\"face\":0,\"corner\":2,\"uv\":[0.25,1],\"xyz\":[1,2,3]}");
    proto_limit_places_free(&found);
    proto_limit_places_free(&found);
    json_decref(document);
    gd_subdivision_release(surface);
}

static void encodes_jets(void **state)
{
    (void)state;
    struct gd_limit_jet jet = {.normal = {0, 0, 1}, .du = {1, 0, 0}, .curvatures = {-1, 2}};
    uint32_t fields = PROTO_LIMIT_JET_FIELD_NORMAL | PROTO_LIMIT_JET_FIELD_DUU |
                      PROTO_LIMIT_JET_FIELD_CURVATURES | PROTO_LIMIT_JET_FIELD_SINGULAR;
    struct proto_writer writer = new_writer();
    proto_limit_jet_encode(&writer, &jet, FIELDS(limit_jet, fields));
    assert_written(&writer, "{\"normal\":[0,0,1],\"duu\":[0,0,0],\"curvatures\":[-1,2]}");
    jet.singular = true;
    writer = new_writer();
    proto_limit_jet_encode(&writer, &jet, FIELDS(limit_jet, fields));
    assert_written(&writer,
                   "{\"normal\":[0,0,1],\"duu\":null,\"curvatures\":null,\"singular\":true}");
    jet.normal.x = NAN; /* simulates the tip of a spike, which has no normal */
    writer = new_writer();
    proto_limit_jet_encode(
        &writer, &jet, FIELDS(limit_jet, PROTO_LIMIT_JET_FIELD_NORMAL | PROTO_LIMIT_JET_FIELD_DU));
    assert_written(&writer, "{\"normal\":null,\"du\":[1,0,0]}");
    const struct gd_limit_closest foot = {
        .place = {3, 0, 0.5, 0.25}, .position = {1, 0, 0}, .distance = 2};
    writer = new_writer();
    proto_limit_foot_encode(&writer, &foot, FIELDS(limit_foot, PROTO_LIMIT_FOOT_FIELD_ALL));
    assert_written(&writer, "{\"face\":3,\"uv\":[0.5,0.25],\"xyz\":[1,0,0],\"distance\":2}");
}

static void traces(void **state)
{
    (void)state;
    struct gd_subdivision *surface = new_surface();
    struct proto_limit_trace trace;
    struct proto_problem problem;
    json_t *document = parse("{\"start\":{\"face\":1,\"uv\":[0.5,0.5]},\"fan\":4,\"length\":2}");
    assert_true(proto_limit_trace_decode(document, surface, &trace, &problem));
    json_decref(document);
    assert_true(trace.request.length == 2 && !trace.request.smooth && trace.count == 4);
    assert_int_equal(trace.request.vertex_rule, PROTO_VERTEX_RULE_LIMIT_NORMAL);
    assert_int_equal(trace.level, gd_limit_mesh_usual_level(surface));
    const struct gd_limit_jet jet = {.normal = {0, 0, 1}, .du = {2, 0, 0}, .dv = {0, 2, 0}};
    struct gd_vec3 up = proto_limit_trace_direction(&trace, &jet, 1);
    assert_true(fabs(up.x) < 1e-15 && up.y == 1 && up.z == 0);
    proto_limit_trace_request_free(&trace.request);
    document = parse("{\"start\":{\"face\":1,\"uv\":[0.5,0.5]},\"directions\":[[0,0,3]],\"length\":"
                     "0,\"smooth\":true,"
                     "\"level\":1,\"vertex_rule\":\"bisect\"}");
    assert_true(proto_limit_trace_decode(document, surface, &trace, &problem));
    json_decref(document);
    assert_true(trace.request.smooth && trace.level == 1 &&
                trace.request.vertex_rule == PROTO_VERTEX_RULE_BISECT);
    assert_true(proto_limit_trace_direction(&trace, &jet, 0).z == 3);
    proto_limit_trace_request_free(&trace.request);
    document =
        parse("{\"start\":{\"face\":1,\"uv\":[0.5,0.5]},\"directions\":[1,\"x\"],\"length\":0}");
    assert_false(proto_limit_trace_decode(document, surface, &trace, &problem));
    assert_pointer(&problem, "/directions/1");
    json_decref(document);
    gd_subdivision_release(surface);
}

static void paths(void **state)
{
    (void)state;
    struct gd_limit_step steps[2] = {{{0, 1, 0.5, 0.5}, {0, 0, 0}, 0},
                                     {{1, 0, 0.25, 0.5}, {1, 0, 0}, 1}};
    const struct gd_limit_path path = {.steps = steps,
                                       .step_count = 2,
                                       .length = 1,
                                       .direction = {0, 1, 0},
                                       .end = GD_LIMIT_END_SINGULAR};
    const struct gd_limit_jet end = {.normal = {0, 0, 1}, .du = {0, 1, 0}};
    struct proto_writer writer = new_writer();
    proto_limit_trace_encode_smooth(&writer, &path, &end, PROTO_GEOMETRY_XYZ);
    assert_written(&writer, "{\"length\":1,\"points\":[[0,0,0],[1,0,0]],\"end_direction\":{"
                            "\"angle\":0,\"xyz\":[0,1,0]},"
                            "\"end_reason\":\"singular\"}");
    const struct proto_limit_pair wanted = {
        .from = steps[0].place, .to = steps[1].place, .level = 3};
    const struct gd_vec3 ends[2] = {steps[0].position, steps[1].position};
    struct gd_limit_shortest found = {.distance = 1,
                                      .mesh_distance = 0.5,
                                      .error_estimate = 0.25,
                                      .steps = steps,
                                      .step_count = 2};
    struct proto_options options = {.fields = PROTO_LIMIT_PATH_FIELD_ALL,
                                    .names = proto_limit_path_fields};
    writer = new_writer();
    proto_limit_pair_encode(&writer, &wanted, ends, &found, &options);
    assert_written(
        &writer,
        "{\"distance\":1,\"error_estimate\":0.25,\"relaxed\":false,\"mesh_distance\":0.5,\"level\":"
        "3,"
        "\"from\":{\"face\":0,\"corner\":1,\"uv\":[0.5,0.5],\"xyz\":[0,0,0]},"
        "\"to\":{\"face\":1,\"uv\":[0.25,0.5],\"xyz\":[1,0,0]},\"path\":{\"length\":1,\"points\":["
        "{\"face\":0,\"corner\":1,\"uv\":[0.5,0.5],\"xyz\":[0,0,0]},"
        "{\"face\":1,\"uv\":[0.25,0.5],\"xyz\":[1,0,0]}]}}");
    found = (struct gd_limit_shortest){.distance = INFINITY, .mesh_distance = INFINITY};
    options.fields = PROTO_LIMIT_PATH_FIELD_DISTANCE | PROTO_LIMIT_PATH_FIELD_ERROR_ESTIMATE |
                     PROTO_LIMIT_PATH_FIELD_PATH;
    writer = new_writer();
    proto_limit_pair_encode(&writer, &wanted, ends, &found, &options);
    assert_written(&writer, "{\"distance\":null,\"reason\":\"no_path\",\"path\":null}");
}

static void discretizations(void **state)
{
    (void)state;
    static const struct {
        const char *text, *pointer;
    } cases[] = {
        {"{\"mesh\":\"m\"}", ""},
        {"{\"mesh\":\"m\",\"level\":1,\"tolerance\":1}", ""},
        {"{\"level\":1}", "/mesh"},
        {"{\"mesh\":\"m/n\",\"level\":1}", "/mesh"},
        {"{\"mesh\":\"m\",\"level\":0}", "/level"},
        {"{\"mesh\":\"m\",\"tolerance\":-1}", "/tolerance"},
        {"{\"mesh\":\"m\",\"level\":1,\"scheme\":1}", "/scheme"},
    };
    struct gd_subdivision *surface = new_surface();
    struct proto_discretization wanted;
    struct proto_problem problem;
    for (size_t i = 0; i < COUNT(cases); i++) {
        json_t *document = parse(cases[i].text);
        assert_false(proto_discretization_decode(document, surface, 1000, &wanted, &problem));
        assert_pointer(&problem, cases[i].pointer);
        json_decref(document);
    }
    json_t *document = parse("{\"mesh\":\"m\",\"level\":12}");
    assert_true(proto_discretization_decode(document, surface, 1000, &wanted, &problem));
    assert_true(wanted.options.level == 12 && wanted.options.max_faces == 1000 &&
                strcmp(wanted.mesh.text, "m") == 0);
    json_decref(document);
    gd_subdivision_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(decodes_places),
                                       cmocka_unit_test(encodes_jets), cmocka_unit_test(traces),
                                       cmocka_unit_test(paths), cmocka_unit_test(discretizations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
