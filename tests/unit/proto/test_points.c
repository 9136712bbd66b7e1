#include "support.h"

#include <math.h>

#include "proto/values/points.h"

static bool decode(const char *text, uint32_t most, struct proto_points *points,
                   struct proto_problem *problem)
{
    json_t *document = parse(text);
    bool decoded = proto_points_decode(points, document, "/points", most, problem);
    json_decref(document);
    return decoded;
}

static void appends_decoded_arrays(void **state)
{
    (void)state;
    struct proto_points points = {0};
    struct proto_problem problem;
    assert_true(decode("[]", 0, &points, &problem));
    assert_int_equal(points.count, 0);
    assert_true(decode("[{\"vertex\":1},{\"vertex\":2}]", 2, &points, &problem));
    assert_true(decode("[{\"vertex\":3}]", 1, &points, &problem));
    assert_int_equal(points.count, 3);
    for (uint32_t i = 0; i < 3; i++) assert_int_equal(points.items[i].vertex, i + 1);
    assert_string_equal(points.items[1].place, "/points/1");
    proto_points_free(&points);
    proto_points_free(&points);
    assert_int_equal(points.count, 0);
}

static void refuses_invalid_arrays(void **state)
{
    (void)state;
    struct proto_points points = {0};
    struct proto_problem problem;
    assert_false(decode("{}", 9, &points, &problem));
    assert_pointer(&problem, "/points");
    assert_false(decode("[{\"vertex\":1},{}]", 9, &points, &problem));
    assert_pointer(&problem, "/points/1");
    proto_points_free(&points);
}

static void assert_too_many(const struct proto_problem *problem, uint64_t limit)
{
    assert_int_equal(problem->code, PROTO_PROBLEM_TOO_LARGE);
    assert_true(problem->has_limit);
    assert_int_equal(problem->limit, limit);
}

static void refuses_too_many(void **state)
{
    (void)state;
    struct proto_points points = {0};
    struct proto_problem problem;
    assert_false(decode("[{\"vertex\":1},{\"vertex\":2}]", 1, &points, &problem));
    assert_too_many(&problem, 1);
    assert_string_equal(problem.pointer, "/points");
    assert_false(proto_points_parse(&points, "v:1;v:2;v:3", "via", 2, &problem));
    assert_too_many(&problem, 2);
    assert_string_equal(problem.parameter, "via");
    proto_points_free(&points);
    assert_true(proto_points_parse(&points, "v:1;v:2;v:3", "via", 3, &problem));
    assert_int_equal(points.count, 3);
    proto_points_free(&points);
}

static void a_compact_point_of_a_thousand_digits_is_refused(void **state)
{
    (void)state;
    char text[1024];
    memset(text, '1', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    struct proto_points points = {0};
    struct proto_problem problem;
    assert_false(proto_points_parse(&points, text, "via", 9, &problem));
    assert_parameter(&problem, "via");
    proto_points_free(&points);
}

static void locates_all_or_none(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_tetrahedron();
    struct proto_points points = {0};
    struct proto_located_points located = {.count = 77};
    struct proto_problem problem;
    assert_true(proto_points_parse(&points, "v:1;p:0,0,-2", "via", 9, &problem));
    assert_true(proto_points_locate(mesh, &points, &located, &problem));
    assert_int_equal(located.count, 2);
    assert_true(located.mesh == mesh && isnan(located.snaps[0]) && located.snaps[1] == 2);
    struct proto_writer writer = new_writer();
    proto_located_points_encode(&writer, &located, 0, 1);
    assert_written(&writer, "[{\"face\":0,\"barycentric\":[0,0,1],\"xyz\":[1,0,0],\"vertex\":1}]");
    proto_located_points_free(&located);
    proto_located_points_free(&located);
    located.count = 77;
    assert_true(proto_points_parse(&points, "v:9", "via", 9, &problem));
    assert_false(proto_points_locate(mesh, &points, &located, &problem));
    assert_parameter(&problem, "via");
    assert_int_equal(located.count, 77);
    proto_points_free(&points);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(appends_decoded_arrays),
        cmocka_unit_test(refuses_invalid_arrays),
        cmocka_unit_test(refuses_too_many),
        cmocka_unit_test(a_compact_point_of_a_thousand_digits_is_refused),
        cmocka_unit_test(locates_all_or_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
