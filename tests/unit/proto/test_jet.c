#include "support.h"

#include "proto/queries/jet.h"

static struct gd_parametric *new_sheet(void)
{
    struct gd_parametric *sheet;
    const double zero = 0, range[] = {0, 1};
    assert_int_equal(
        gd_parametric_graph(&(struct gd_graph){0, 0, &zero, range, range}, &sheet, NULL), GD_OK);
    return sheet;
}

static void places_are_read(void **state)
{
    struct gd_parametric *sheet = new_sheet();
    json_t *good = parse("{\"uv\":[[0,0],[1,0.5]]}"), *outside = parse("{\"uv\":[[0,0],[1,2]]}");
    struct proto_problem problem;
    struct proto_uvs uvs;
    (void)state;
    assert_true(proto_jets_decode(good, sheet, &uvs, &problem));
    assert_int_equal(uvs.count, 2);
    proto_uvs_free(&uvs);
    assert_false(proto_jets_decode(outside, sheet, &uvs, &problem));
    assert_int_equal(problem.code, PROTO_PROBLEM_POINT_NOT_ON_SURFACE);
    assert_string_equal(problem.pointer, "/uv/1");
    json_decref(good);
    json_decref(outside);
    gd_parametric_release(sheet);
}

static void a_point_has_the_wanted_fields(void **state)
{
    struct gd_parametric *sheet = new_sheet();
    struct proto_writer writer = new_writer();
    struct gd_jet jet, flat = {.x = {1, 2, 3}, .u = {1, 0, 0}, .v = {2, 0, 0}};
    (void)state;
    assert_int_equal(gd_parametric_evaluate(sheet, 0.5, 0.25, &jet), GD_OK);
    proto_jet_encode(&writer, &jet, FIELDS(jet, PROTO_JET_FIELD_ALL));
    assert_written(&writer, "{\"xyz\":[0.5,0.25,0],\"normal\":[0,0,1],\"du\":[1,0,0],\"dv\":[0,1,0]"
                            ",\"duu\":[0,0,0],\"duv\":[0,0,0],"
                            "\"dvv\":[0,0,0],\"gaussian_curvature\":0,\"mean_curvature\":0}");
    writer = new_writer();
    proto_jet_encode(&writer, &flat,
                     FIELDS(jet, PROTO_JET_FIELD_NORMAL | PROTO_JET_FIELD_GAUSSIAN_CURVATURE |
                                     PROTO_JET_FIELD_MEAN_CURVATURE));
    assert_written(&writer,
                   "{\"normal\":null,\"gaussian_curvature\":null,\"mean_curvature\":null}");
    gd_parametric_release(sheet);
}

static void nearest_points_are_read_and_written(void **state)
{
    json_t *good = parse("{\"xyz\":[1,2,3]}"), *bad = parse("{\"xyz\":[1,2]}");
    const struct gd_parametric_closest foot = {0.5, 0.25, {1, 2, 3}, 4};
    struct proto_writer writer = new_writer();
    struct proto_problem problem;
    struct proto_point wanted;
    (void)state;
    assert_true(proto_foot_decode(good, &wanted, &problem));
    assert_true(wanted.xyz[0] == 1 && wanted.xyz[1] == 2 && wanted.xyz[2] == 3);
    assert_true(proto_foot_check(&wanted, 1e9, &problem));
    wanted.has_max_snap = true;
    wanted.max_snap = 1;
    assert_true(proto_foot_check(&wanted, 1, &problem));
    assert_false(proto_foot_check(&wanted, 1.5, &problem));
    assert_false(proto_foot_decode(bad, &wanted, &problem));
    assert_pointer(&problem, "/xyz");
    proto_foot_encode(&writer, &foot, FIELDS(foot, PROTO_FOOT_FIELD_ALL));
    assert_written(&writer, "{\"uv\":[0.5,0.25],\"xyz\":[1,2,3],\"distance\":4}");
    writer = new_writer();
    proto_foot_encode(&writer, &foot, FIELDS(foot, PROTO_FOOT_FIELD_DISTANCE));
    assert_written(&writer, "{\"distance\":4}");
    json_decref(good);
    json_decref(bad);
}

/* Names are in the order of the bits. */
static void names_of_fields_match_their_bits(void **state)
{
    (void)state;
    assert_string_equal(proto_jet_fields[__builtin_ctz(PROTO_JET_FIELD_MEAN_CURVATURE)],
                        "mean_curvature");
    assert_string_equal(proto_jet_fields[__builtin_ctz(PROTO_JET_FIELD_DVV)], "dvv");
    assert_null(proto_jet_fields[__builtin_ctz(PROTO_JET_FIELD_MEAN_CURVATURE) + 1]);
    assert_string_equal(proto_foot_fields[__builtin_ctz(PROTO_FOOT_FIELD_DISTANCE)], "distance");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_read),
        cmocka_unit_test(a_point_has_the_wanted_fields),
        cmocka_unit_test(nearest_points_are_read_and_written),
        cmocka_unit_test(names_of_fields_match_their_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
