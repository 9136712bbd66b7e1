#include "tests/unit/subdiv/surfaces.h"

#include "gd/limit_path.h"

/* Checks that relaxation finds a traced geodesic again from three points. The middle point is not
 * on the geodesic. */
static void check_found(const struct gd_subdivision *surface, uint32_t faces, double length)
{
    struct rng rng = {2};
    for (int n = 0; n < 12; n++) {
        struct gd_limit_point start = {rng_below(&rng, faces), 0, rng_between(&rng, 0.1, 0.5),
                                       rng_between(&rng, 0.1, 0.5)};
        struct gd_limit_jet jet = jet_at(surface, start.face, 0, start.u, start.v);
        double angle = rng_between(&rng, 0, 2 * M_PI);
        struct gd_vec3 direction =
            gd_vec3_along(gd_vec3_scale(jet.du, cos(angle)), sin(angle), jet.dv);
        struct gd_vec3 aside = gd_vec3_along(direction, 0.2, gd_vec3_cross(jet.normal, direction));
        struct gd_limit_path path, off;
        check_ok(gd_limit_trace(surface, &(struct gd_limit_trace_request){start, direction, length},
                                NULL, &path, NULL),
                 NULL);
        check_ok(gd_limit_trace(surface, &(struct gd_limit_trace_request){start, aside, length / 2},
                                NULL, &off, NULL),
                 NULL);
        struct gd_limit_point polyline[3] = {start, off.steps[off.step_count - 1].place,
                                             path.steps[path.step_count - 1].place};
        struct gd_limit_geodesic found = {0};
        check_ok(
            gd_limit_relax(surface, &(struct gd_limit_places){polyline, 3}, NULL, &found, NULL),
            NULL);
        assert_true(found.converged);
        check_close(found.path.length, length, 1e-10);
        assert_true(fabs(found.path.length - length) <= found.error_estimate + 1e-13 * length);
        struct gd_vec3 end = path.steps[path.step_count - 1].position;
        check_near(found.path.steps[found.path.step_count - 1].position, end.x, end.y, end.z,
                   1e-11);
        gd_limit_path_free(&found.path);
        gd_limit_path_free(&path);
        gd_limit_path_free(&off);
    }
}

static void finds_the_geodesic_again(void **state)
{
    (void)state;
    struct gd_subdivision *surface = surface_from(CUBE, GD_SCHEME_CATMULL_CLARK);
    check_found(surface, 6, 0.7);
    gd_subdivision_release(surface);
    surface = surface_from(OCTAHEDRON, GD_SCHEME_LOOP);
    check_found(surface, 8, 0.5);
    gd_subdivision_release(surface);
}

/* Around a corner the shortest path follows the boundary and is not a geodesic. The result is "not
 * converged". */
static void around_a_corner(void **state)
{
    (void)state;
    struct gd_subdivision *corner =
        surface_from("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2 0\n"
                     "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\n",
                     GD_SCHEME_CATMULL_CLARK);
    const struct gd_limit_point polyline[3] = {
        {1, 0, 0.9, 0.9}, {0, 0, 0.8, 0.8}, {2, 0, 0.9, 0.9}};
    struct gd_limit_geodesic found = {0};
    check_ok(gd_limit_relax(corner, &(struct gd_limit_places){polyline, 3}, NULL, &found, NULL),
             NULL);
    assert_false(found.converged);
    assert_null(found.path.steps);
    /* the initial line crosses the gap */
    const struct gd_limit_point chord[2] = {polyline[0], polyline[2]};
    check_ok(gd_limit_relax(corner, &(struct gd_limit_places){chord, 2}, NULL, &found, NULL), NULL);
    assert_false(found.converged);
    assert_int_equal(
        gd_limit_relax(corner, &(struct gd_limit_places){polyline, 1}, NULL, &found, NULL),
        GD_INVALID_ARGUMENT);
    const struct gd_limit_point nowhere[2] = {polyline[0], polyline[0]};
    assert_int_equal(
        gd_limit_relax(corner, &(struct gd_limit_places){nowhere, 2}, NULL, &found, NULL),
        GD_INVALID_ARGUMENT);
    gd_subdivision_release(corner);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_the_geodesic_again),
                                       cmocka_unit_test(around_a_corner)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
