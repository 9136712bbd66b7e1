#include "support.h"

#include "proto/queries/nearest.h"

static bool decode(const char *text, struct proto_nearest *out, struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool decoded = proto_nearest_decode(document, out, problem);
    json_decref(document);
    return decoded;
}

static void decodes_bodies(void **state)
{
    (void)state;
    struct proto_nearest request;
    struct proto_problem problem;
    assert_true(decode("{\"point\":{\"vertex\":2}}", &request, &problem));
    assert_true(request.point.form == PROTO_POINT_VERTEX);
    assert_false(decode("{}", &request, &problem));
    assert_pointer(&problem, "/point");
    assert_false(decode("{\"point\":{\"vertex\":2},\"from\":1}", &request, &problem));
    assert_pointer(&problem, "/from");
    assert_false(decode("{\"point\":{\"xyz\":[1,2]}}", &request, &problem));
    assert_pointer(&problem, "/point/xyz");
}

static void parses_query_strings(void **state)
{
    (void)state;
    struct proto_nearest request;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("point", "p:1,2,3");
    assert_true(proto_nearest_parse(&parameters, &request, &problem));
    assert_true(request.point.form == PROTO_POINT_XYZ);
    parameters = NO_QUERY;
    assert_false(proto_nearest_parse(&parameters, &request, &problem));
    assert_parameter(&problem, "point");
}

static void answers_with_the_fields_that_are_wanted(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct gd_point point;
    assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){1}, &point, NULL), GD_OK);
    struct proto_options options;
    struct proto_problem problem;
    struct proto_parameters parameters = QUERY("fields", "snap_distance,xyz,t");
    assert_true(proto_options_parse(&parameters, proto_point_fields, proto_nearest_parameters,
                                    &options, &problem));
    struct proto_writer writer = new_writer();
    proto_nearest_encode(&writer, mesh, &point, 0.25, &options);
    assert_written(&writer, "{\"xyz\":[1,0,0],\"snap_distance\":0.25}");
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_bodies),
        cmocka_unit_test(parses_query_strings),
        cmocka_unit_test(answers_with_the_fields_that_are_wanted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
