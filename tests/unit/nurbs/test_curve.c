#include "tests/unit/nurbs/surfaces.h"

#include "nurbs/curve.h"

static void iso_lines_and_loops_are_closed(void **state)
{
    (void)state;
    struct gd_parametric *ring = nurbs_torus(2, 1, 1, 0), *flat = plane(2);
    struct gd_domain_curve *line = iso_at(ring, GD_ISO_U, 0.3), *open = iso_at(flat, GD_ISO_V, 0.5),
                           *loop = loop_at(flat, 0, 0, 1, 1);
    double uv[2], low, high;
    assert_true(gd_domain_curve_is_closed(line) && gd_domain_curve_is_closed(loop) &&
                !gd_domain_curve_is_closed(open));
    gd_domain_curve_range(line, &low, &high);
    assert_true(low == 0 && high == 1);
    gd_domain_curve_at(line, 1.25, uv); /* continues around */
    assert_true(uv[0] == 0.3 && fabs(uv[1] - 1.25) < 1e-15);
    gd_domain_curve_at(open, 17, uv); /* the parameter is clamped to the curve's end */
    assert_true(uv[0] == 2 && uv[1] == 0.5);
    gd_domain_curve_release(line);
    gd_domain_curve_release(open);
    gd_domain_curve_release(loop);
    /* the curve runs twice around the axis and once around the tube */
    const double ends[2][2] = {{0.1, 0.2}, {2.1, 1.2}};
    check_ok(
        gd_domain_curve_polyline(ring, &(struct gd_domain_polyline){ends, 2}, NULL, &line, NULL),
        NULL);
    assert_true(gd_domain_curve_is_closed(line));
    gd_domain_curve_release(line);
    gd_parametric_release(ring);
    gd_parametric_release(flat);
}

/* A single span that crosses many knot lines of the surface has a break at each of them. */
static void breaks_at_every_line(void **state)
{
    (void)state;
    /* the surface has 56 inner knot lines in each direction */
    struct gd_parametric *surface = nurbs_bumps(60, 60, 0.3, 11);
    const double ends[2][2] = {{0, 0.031}, {1, 0.957}};
    struct gd_domain_curve *iso = iso_at(surface, GD_ISO_U, 0.3), *line;
    check_ok(
        gd_domain_curve_polyline(surface, &(struct gd_domain_polyline){ends, 2}, NULL, &line, NULL),
        NULL);
    assert_int_equal(iso->break_count, 58);
    for (int i = 0; i < 58; i++) assert_true(fabs(iso->breaks[i] - i / 57.0) < 1e-12);
    assert_int_equal(line->break_count, 58 + 53); /* v from 0.031 to 0.957 crosses lines 2 to 54 */
    gd_domain_curve_release(iso);
    gd_domain_curve_release(line);
    gd_parametric_release(surface);
}

/* A curve along a border stays in the domain despite rounding: v = 3 on a vase with the domain [0,
 * 3]. */
static void a_border_is_in_the_domain(void **state)
{
    (void)state;
    struct gd_parametric *surface = vase();
    struct gd_domain_curve *rim = iso_at(surface, GD_ISO_V, 3);
    for (int i = 0; i <= 1000; i++) {
        double at[2];
        gd_domain_curve_at(rim, 2 * M_PI * i / 1000, at);
        assert_true(gd_parametric_contains(surface, at[0], at[1]) && fabs(at[1] - 3) < 1e-14);
    }
    gd_domain_curve_release(rim);
    gd_parametric_release(surface);
}

static void wrong_curves_are_refused(void **state)
{
    (void)state;
    struct gd_parametric *flat = plane(1), *sphere = nurbs_sphere();
    struct gd_domain_curve *curve = NULL;
    struct gd_detail detail;
    const double outside[2][2] = {{0, 0}, {2, 0}}, twice[2][2] = {{0, 0}, {0, 0}},
                 nowhere[2][2] = {{0, 0}, {NAN, 0}}, good[2][2] = {{0, 0}, {1, 0}},
                 far[2][2] = {{0, 0.5}, {1e300, 0.5}}, falling[4] = {0, 1, 0, 1},
                 empty[4] = {0, 1, 1, 2};
    assert_int_equal(gd_domain_curve_polyline(flat, &(struct gd_domain_polyline){outside, 2}, NULL,
                                              &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_polyline(flat, &(struct gd_domain_polyline){twice, 2}, NULL,
                                              &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_polyline(flat, &(struct gd_domain_polyline){nowhere, 2}, NULL,
                                              &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_polyline(flat, &(struct gd_domain_polyline){good, 1}, NULL,
                                              &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_bspline(flat, &(struct gd_domain_bspline){1, falling, good, 2},
                                             NULL, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_bspline(flat, &(struct gd_domain_bspline){1, empty, good, 2},
                                             NULL, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_bspline(flat, &(struct gd_domain_bspline){0, empty, good, 2},
                                             NULL, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_bspline(flat, &(struct gd_domain_bspline){2, empty, good, 2},
                                             NULL, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_point(flat, 0, INFINITY, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_point(sphere, 1e7, 0.5, &curve, &detail), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_polyline(sphere, &(struct gd_domain_polyline){far, 2}, NULL,
                                              &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_iso(flat, GD_ISO_U, 1.5, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_domain_curve_iso(sphere, GD_ISO_V, 1, &curve, &detail),
                     GD_INVALID_ARGUMENT);
    assert_null(curve);
    gd_parametric_release(flat);
    gd_parametric_release(sphere);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(iso_lines_and_loops_are_closed),
        cmocka_unit_test(breaks_at_every_line),
        cmocka_unit_test(a_border_is_in_the_domain),
        cmocka_unit_test(wrong_curves_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
