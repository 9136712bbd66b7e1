#include "support.h"

#include <stdio.h>

#include "proto/queries/trace.h"

DECODER(decode, struct proto_trace_request, proto_trace_request_decode)

#define START "\"start\":{\"vertex\":3}"

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_trace_request trace;
    struct proto_problem problem;
    assert_true(decode("{" START ",\"length\":2.5,\"directions\":[0,[1,0,0]]}", &trace, &problem));
    assert_true(trace.length == 2.5 && trace.directions.count == 2 && trace.start.vertex == 3);
    assert_string_equal(trace.directions.items[1].place, "/directions/1");
    assert_true(trace.vertex_rule == PROTO_VERTEX_RULE_BISECT &&
                trace.boundary_rule == PROTO_BOUNDARY_RULE_STOP &&
                !trace.stop_at_self_intersection);
    assert_int_equal(trace.step_limit, PROTO_TRACE_STEPS);
    proto_trace_request_free(&trace);
    proto_trace_request_free(&trace);
    assert_true(decode(
        "{" START
        ",\"length\":0,\"fan\":10000,\"vertex_rule\":\"limit_normal\",\"boundary_rule\":\"slide\","
        "\"stop_at_self_intersection\":true,\"step_limit\":7}",
        &trace, &problem));
    assert_true(!trace.directions.items && trace.fan == 10000);
    assert_true(trace.vertex_rule == PROTO_VERTEX_RULE_LIMIT_NORMAL &&
                trace.boundary_rule == PROTO_BOUNDARY_RULE_SLIDE &&
                trace.stop_at_self_intersection);
    assert_int_equal(trace.step_limit, 7);
    proto_trace_request_free(&trace);
}

static void refuses_bad_bodies(void **state)
{
    (void)state;
    static const struct refusal cases[] = {
        {"[]", ""},
        {"{\"length\":1,\"fan\":2}", "/start"},
        {"{" START ",\"fan\":2}", "/length"},
        {"{" START ",\"length\":-1,\"fan\":2}", "/length"},
        {"{" START ",\"length\":1}", ""},
        {"{" START ",\"length\":1,\"fan\":2,\"directions\":[1]}", ""},
        {"{" START ",\"length\":1,\"fan\":0}", "/fan"},
        {"{" START ",\"length\":1,\"directions\":[]}", "/directions"},
        {"{" START ",\"length\":1,\"directions\":5}", "/directions"},
        {"{" START ",\"length\":1,\"directions\":[1,\"2\"]}", "/directions/1"},
        {"{" START ",\"length\":1,\"fan\":2,\"vertex_rule\":\"half\"}", "/vertex_rule"},
        {"{" START ",\"length\":1,\"fan\":2,\"boundary_rule\":true}", "/boundary_rule"},
        {"{" START ",\"length\":1,\"fan\":2,\"step_limit\":0}", "/step_limit"},
        {"{" START ",\"length\":1,\"fan\":2,\"steps\":1}", "/steps"},
    };
    struct proto_trace_request trace;
    struct proto_problem problem;
    CHECK_REFUSED(decode, struct proto_trace_request, cases)
    assert_false(decode("{" START ",\"length\":1,\"fan\":10001}", &trace, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_TOO_LARGE);
}

static void writes_answers(void **state)
{
    (void)state;
    static const char *const reasons[] = {"length", "boundary", "self_intersection", "step_limit"};
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point point;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &point, NULL), GD_OK);
    struct gd_trace trace = {.path = {2, 1, &point}, .direction = {.angle = 0.5, .xyz = {0, 1, 0}}};
    struct proto_writer writer = new_writer();
    proto_trace_encode(&writer, mesh, &trace, PROTO_GEOMETRY_XYZ);
    assert_written(
        &writer,
        "{\"length\":2,\"points\":[[1,0,0]],\"end_direction\":{\"angle\":0.5,\"xyz\":[0,1,0]},"
        "\"end_reason\":\"length\"}");
    for (size_t i = 0; i < COUNT(reasons); i++) {
        char expected[128];
        trace.end = (enum gd_trace_end)i;
        writer = new_writer();
        proto_trace_encode(&writer, mesh, &trace, PROTO_GEOMETRY_NONE);
        snprintf(expected, sizeof expected,
                 "{\"length\":2,\"end_direction\":{\"angle\":0.5,\"xyz\":[0,1,0]},\"end_reason\":"
                 "\"%s\"}",
                 reasons[i]);
        assert_written(&writer, expected);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(decodes_bodies),
                                       cmocka_unit_test(refuses_bad_bodies),
                                       cmocka_unit_test(writes_answers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
