/* Tests curves that pass through a pole or end in one. In the domain, a pole is a whole line, on
 * which a path's end cannot slide. The test also checks the errors of tiny lengths. */
#include "tests/unit/nurbs/surfaces.h"

#include "gd/geodesic_like.h"

static const double promise = 1e-10; /* permitted relative error of a length */
static const double right = 1e-8;    /* permitted error of a right angle at an end */

/* Computes shortest paths from a point to a polyline, or from the polyline to the point if
 * `backwards`. */
static struct gd_geodesics solve(const struct gd_tessellation *tessellation, const double point[2],
                                 const double (*corners)[2], uint32_t count, bool backwards)
{
    const struct gd_parametric *surface = gd_tessellation_surface(tessellation);
    struct gd_domain_curve *at = point_at(surface, point[0], point[1]), *line;
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    check_ok(gd_domain_curve_polyline(surface, &(struct gd_domain_polyline){corners, count}, NULL,
                                      &line, NULL),
             NULL);
    check_ok(gd_geodesic_solve(tessellation,
                               &(struct gd_geodesic_request){.from = backwards ? line : at,
                                                             .to = backwards ? at : line},
                               NULL, &found, &detail),
             &detail);
    gd_domain_curve_release(at);
    gd_domain_curve_release(line);
    return found;
}

static double colatitude(const struct gd_parametric *sphere, const double at[2])
{
    struct gd_jet x;
    check_ok(gd_parametric_evaluate(sphere, at[0], at[1], &x), NULL);
    return atan2(hypot(x.x.x, x.x.y), -x.x.z); /* from the south pole */
}

/* Uses a meridian from pole to pole. From points of the opposite half of the sphere, the nearest
 * point of the meridian is a pole. */
static void a_curve_that_ends_in_a_pole(void **state)
{
    (void)state;
    struct gd_parametric *sphere = nurbs_sphere();
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(sphere, NULL, NULL, &tessellation, NULL), NULL);
    const double meridian[2][2] = {{0.1, 0}, {0.1, 1}};
    for (double u = 0.35; u < 0.85; u += 0.15 * TEST_STRIDE) {
        for (int backwards = 0; backwards < 2; backwards++) {
            const double point[2] = {u, 0.2};
            struct gd_geodesics found = solve(tessellation, point, meridian, 2, backwards);
            const struct gd_geodesic *path = &found.items[0];
            check_close(path->length, colatitude(sphere, point), promise);
            assert_true(path->is_minimum && path->warnings == GD_GEODESIC_CURVE_CORNER);
            double parameter = backwards ? path->from_parameter : path->to_parameter;
            double angle = backwards ? M_PI - path->from_angle : path->to_angle;
            assert_true(parameter == 0);
            /* from this end on, the distance grows along the curve */
            assert_true(angle <= M_PI_2 + 1e-8);
            gd_geodesics_free(&found);
        }
    }
    gd_tessellation_release(tessellation);
    gd_parametric_release(sphere);
}

/* From a point that is slightly less than a quarter turn away from the meridian, the path ends
 * close to the pole and meets the meridian at a right angle. */
static void a_path_end_close_to_a_pole(void **state)
{
    (void)state;
    struct gd_parametric *sphere = nurbs_sphere();
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(sphere, NULL, NULL, &tessellation, NULL), NULL);
    for (double off = 0.05; off > 1e-4; off /= 4) {
        const double meridian[2][2] = {{0.125, 0}, {0.125, 1}},
                     point[2] = {circle_parameter(0.75 * M_PI - off), 0.2};
        struct gd_geodesics found = solve(tessellation, point, meridian, 2, false);
        const struct gd_geodesic *path = &found.items[0];
        check_close(path->length, asin(sin(colatitude(sphere, point)) * cos(off)), promise);
        assert_true(path->is_minimum && path->warnings == 0 &&
                    fabs(path->to_angle - M_PI_2) < right);
        assert_true(path->to_parameter > 0);
        gd_geodesics_free(&found);
    }
    gd_tessellation_release(tessellation);
    gd_parametric_release(sphere);
}

/* Two meridians that meet in a pole form a curve, and the pole is a corner of this curve. */
static void a_curve_with_a_corner_in_a_pole(void **state)
{
    (void)state;
    struct gd_parametric *sphere = nurbs_sphere();
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(sphere, NULL, NULL, &tessellation, NULL), NULL);
    const double bent[4][2] = {{0.1, 0.4}, {0.1, 0}, {0.2, 0}, {0.2, 0.4}}, point[2] = {0.65, 0.3};
    struct gd_geodesics found = solve(tessellation, point, bent, 4, false);
    check_close(found.items[0].length, colatitude(sphere, point), promise);
    assert_true(found.items[0].is_minimum && found.items[0].warnings & GD_GEODESIC_CURVE_CORNER);
    assert_true(found.items[0].to_parameter >= 1 && found.items[0].to_parameter <= 2);
    gd_geodesics_free(&found);
    gd_tessellation_release(tessellation);
    gd_parametric_release(sphere);
}

/* Coordinates have rounding errors. The reported error is at least the true one. */
static void tiny_lengths(void **state)
{
    (void)state;
    struct gd_parametric *cylinder = nurbs_ruled(1, 0, 1, 3);
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(cylinder, NULL, NULL, &tessellation, NULL), NULL);
    struct rng rng = {3};
    for (double off = 1e-3; off > 1e-12; off /= TEST_IS_SANITIZED ? 1000 : 10) {
        for (int i = 0; i < 2; i++) {
            double u = rng_between(&rng, 0.3, 0.7), v = rng_between(&rng, 0.1, 0.9), w = v + off;
            struct gd_domain_curve *from = point_at(cylinder, u, v), *to = point_at(cylinder, u, w);
            struct gd_geodesics found;
            check_ok(gd_geodesic_solve(tessellation,
                                       &(struct gd_geodesic_request){.from = from, .to = to}, NULL,
                                       &found, NULL),
                     NULL);
            double exact = 3 * (w - v), error = fabs(found.items[0].length - exact);
            assert_true(error <= found.items[0].error + 1e-15 * exact &&
                        found.items[0].error < 1e-14);
            assert_true((found.items[0].warnings & GD_GEODESIC_NOT_CONVERGED) ||
                        found.items[0].error < 1e-11 * exact);
            gd_geodesics_free(&found);
            gd_domain_curve_release(from);
            gd_domain_curve_release(to);
        }
    }
    gd_tessellation_release(tessellation);
    gd_parametric_release(cylinder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_curve_that_ends_in_a_pole),
        cmocka_unit_test(a_path_end_close_to_a_pole),
        cmocka_unit_test(a_curve_with_a_corner_in_a_pole),
        cmocka_unit_test(tiny_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
