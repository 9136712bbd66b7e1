/* Tests of resampling (points at equal arc lengths) and of offsets (curves at equal distances). */
#include "tests/unit/transport/curves.h"

#include "gd/offset.h"
#include "gd/resampling.h"

static void equal_lengths(void **state)
{
    (void)state;
    struct surface plane = surface_of("grid", (double[SAMPLE_PARAMETERS]){30, 20, 3, 2});
    struct gd_point points[3] = {nearest(plane.mesh, 0.5, 0.5, 0), nearest(plane.mesh, 2.5, 0.5, 0),
                                 nearest(plane.mesh, 2.5, 1.5, 0)};
    for (int closed = 0; closed < 2; closed++) {
        struct gd_curve curve = curve_through(plane.mesh, points, 3, closed);
        struct gd_resampling resampling;
        double length = closed ? 3 + sqrt(5) : 3;
        check_close(gd_curve_length(plane.mesh, &curve), length, exact);
        check_ok(gd_curve_resample(plane.mesh, &(struct gd_resampling_request){&curve, 7}, NULL,
                                   &resampling, NULL),
                 NULL);
        assert_int_equal(resampling.count, 7);
        for (uint32_t i = 0; i < 7; i++) {
            double s = length * i / (closed ? 7 : 6), back = fmax(s - 3, 0);
            struct gd_vec3 at = gd_point_position(plane.mesh, &resampling.points[i]);
            expect_place(at, 0.5 + fmin(s, 2) - 2 * back / sqrt(5),
                         0.5 + fmin(fmax(s - 2, 0), 1) - back / sqrt(5), 0, 1e-12);
        }
        check_curve(plane.mesh, &resampling.curve, 3);
        gd_resampling_free(&resampling);
        gd_curve_free(&curve);
    }
    struct gd_curve dot = curve_through(plane.mesh, points, 1, false);
    struct gd_resampling resampling;
    struct gd_detail detail = {0};
    assert_int_equal(gd_curve_resample(plane.mesh, &(struct gd_resampling_request){&dot, 7}, NULL,
                                       &resampling, &detail),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_curve_resample(plane.mesh, &(struct gd_resampling_request){&dot, 1}, NULL,
                                       &resampling, &detail),
                     GD_INVALID_ARGUMENT);
    gd_curve_free(&dot);
    surface_free(&plane);
}

static void offsets_in_the_plane(void **state)
{
    (void)state;
    struct surface plane = surface_of("grid", (double[SAMPLE_PARAMETERS]){30, 20, 3, 2});
    struct gd_point points[2] = {nearest(plane.mesh, 1, 1, 0), nearest(plane.mesh, 2, 1.1, 0)};
    struct gd_curve curve = curve_through(plane.mesh, points, 2, false);
    struct gd_isoline isoline;
    check_ok(
        gd_curve_offset(plane.mesh, &(struct gd_offset_request){&curve, 0.3}, NULL, &isoline, NULL),
        NULL);
    assert_int_equal(isoline.line_count, 1);
    assert_true(isoline.lines[0].closed);
    check_close(isoline.lines[0].length, 2 * sqrt(1.01) + 2 * M_PI * 0.3, 1e-9);
    gd_isoline_free(&isoline);
    assert_int_equal(
        gd_curve_offset(plane.mesh, &(struct gd_offset_request){&curve, 0}, NULL, &isoline, NULL),
        GD_INVALID_ARGUMENT);
    check_ok(
        gd_curve_offset(plane.mesh, &(struct gd_offset_request){&curve, 7}, NULL, &isoline, NULL),
        NULL);
    assert_int_equal(isoline.line_count, 0);
    gd_isoline_free(&isoline);
    gd_curve_free(&curve);
    surface_free(&plane);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(equal_lengths),
                                       cmocka_unit_test(offsets_in_the_plane)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
