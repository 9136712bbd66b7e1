#include "tests/unit/server/support.h"

#include <math.h>

#include "server/query/query.h"

static struct gd_pair_answer leg(const struct gd_mesh *mesh, uint32_t from, uint32_t to,
                                 bool want_path)
{
    struct gd_point a = vertex_point(mesh, from), b = vertex_point(mesh, to);
    struct gd_pair_answer answer;
    assert_int_equal(
        gd_pair_solve(mesh, &(struct gd_pair_request){.from = &a, .to = &b, .output = want_path},
                      NULL, &answer, NULL),
        GD_OK);
    return answer;
}

/* Asserts that consecutive points differ. So the point between two parts of the path occurs only
 * once. */
static void assert_polyline(const struct gd_mesh *mesh, const struct gd_path *path)
{
    double length = 0;
    for (uint32_t i = 1; i < path->count; i++) {
        assert_false(gd_point_equal(&path->points[i - 1], &path->points[i]));
        length += gd_vec3_distance(gd_point_position(mesh, &path->points[i - 1]),
                                   gd_point_position(mesh, &path->points[i]));
    }
    assert_true(fabs(length - path->length) < 1e-12 * (1 + length));
}

static void legs_become_one_path(void **state)
{
    (void)state;
    static const uint32_t stops[] = {0, 40, 7, 7, 100, 0};
    struct gd_mesh *mesh = new_mesh();
    struct gd_pair_answer route = {0};
    double sum = 0;
    for (size_t i = 1; i < COUNT(stops); i++) {
        struct gd_pair_answer next = leg(mesh, stops[i - 1], stops[i], true);
        sum += next.distance;
        assert_int_equal(server_pair_append(&route, &next), GD_OK);
        assert_true(next.path.points == NULL);
        struct gd_point end = vertex_point(mesh, stops[i]);
        assert_true(gd_point_equal(&route.path.points[route.path.count - 1], &end));
    }
    struct gd_point begin = vertex_point(mesh, stops[0]);
    assert_true(gd_point_equal(&route.path.points[0], &begin));
    assert_true(fabs(route.distance - sum) < 1e-15 * sum &&
                fabs(route.path.length - sum) < 1e-12 * sum);
    assert_polyline(mesh, &route.path);
    gd_pair_answer_free(&route);
    gd_mesh_release(mesh);
}

static void a_leg_without_a_path_leaves_no_path(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_mesh();
    struct gd_pair_answer route = {0}, first = leg(mesh, 0, 9, true), gap = {.distance = INFINITY};
    assert_int_equal(server_pair_append(&route, &first), GD_OK);
    assert_int_equal(server_pair_append(&route, &gap), GD_OK);
    assert_true(isinf(route.distance) && route.path.count == 0 && !route.path.points);
    gd_mesh_release(mesh);
}

static void distances_need_no_paths(void **state)
{
    (void)state;
    struct gd_mesh *mesh = new_mesh();
    struct gd_pair_answer route = {0}, first = leg(mesh, 0, 9, false),
                          second = leg(mesh, 9, 30, false);
    double sum = first.distance + second.distance;
    assert_int_equal(server_pair_append(&route, &first), GD_OK);
    assert_int_equal(server_pair_append(&route, &second), GD_OK);
    assert_true(route.distance == sum && route.path.count == 0);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(legs_become_one_path),
        cmocka_unit_test(a_leg_without_a_path_leaves_no_path),
        cmocka_unit_test(distances_need_no_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
