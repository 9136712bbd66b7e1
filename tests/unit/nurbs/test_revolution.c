/* Tests geodesics along meridians. A meridian is a geodesic and a straight line of the domain, but
 * its speed varies like the speed of the profile. */
#include "tests/unit/nurbs/surfaces.h"

#include "gd/geodesic_like.h"

/* Returns the length of a meridian by Simpson's rule with many panels between the profile's
 * knots. */
static double profile_length(const struct gd_parametric *surface, double from, double to)
{
    enum { PANELS = 20000 };
    double sum = 0;
    for (int piece = 0; piece < 3; piece++) {
        double low = fmax(from, piece), high = fmin(to, piece + 1), h = (high - low) / PANELS;
        for (int i = 0; i <= 2 * PANELS && low < high; i++) {
            struct gd_jet x;
            check_ok(gd_parametric_evaluate(surface, 0, fmin(low + 0.5 * h * i, high), &x), NULL);
            double weight = i == 0 || i == 2 * PANELS ? 1 : i % 2 ? 4 : 2;
            sum += weight * h / 6 * gd_vec3_length(x.v);
        }
    }
    return sum;
}

/* Between two parallels, splines of all degrees have the profile's length. */
static void between_parallels_of_a_vase(void **state)
{
    (void)state;
    struct gd_parametric *surface = vase();
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(surface, NULL, NULL, &tessellation, NULL), NULL);
    const double heights[3][2] = {{0, 3}, {0.4, 2.2}, {0.5, 1}};
    for (int i = 0; i < 3; i++) {
        double exact = profile_length(surface, heights[i][0], heights[i][1]);
        struct gd_domain_curve *low = iso_at(surface, GD_ISO_V, heights[i][0]);
        struct gd_domain_curve *high = iso_at(surface, GD_ISO_V, heights[i][1]);
        for (uint32_t degree = 2; degree <= 5; degree++) {
            const struct gd_geodesic_options options = {.degree = degree};
            struct gd_geodesics found;
            check_ok(gd_geodesic_solve(tessellation,
                                       &(struct gd_geodesic_request){
                                           .from = low, .to = high, .options = &options},
                                       NULL, &found, NULL),
                     NULL);
            check_close(found.items[0].length, exact, 1e-11);
            assert_true(fabs(found.items[0].length - exact) <=
                        found.items[0].error + 1e-12 * exact);
            gd_geodesics_free(&found);
        }
        gd_domain_curve_release(low);
        gd_domain_curve_release(high);
    }
    gd_tessellation_release(tessellation);
    gd_parametric_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(between_parallels_of_a_vase)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
