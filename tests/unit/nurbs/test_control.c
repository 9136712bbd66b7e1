/* Tests that long calls check their control. Measures the processor time between two checks, and
 * tests the reported progress. */
#include "tests/unit/nurbs/surfaces.h"

#include <time.h>

#include "gd/geodesic_like.h"

enum { CORNERS = 4096, MANY = 2048 };

/* a few milliseconds are usual; with sanitizers on a busy machine with two cores, up to 52 ms were
 * measured */
static const double patience_ms = 100;

struct looking {
    double last, worst; /* ms */
    double fraction;
    uint32_t left; /* number of checks before the call is cancelled */
    bool fell;     /* true if the fraction has decreased */
};

static double processor_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static bool look(void *user, double fraction)
{
    struct looking *looking = user;
    double now = processor_ms();
    looking->worst = fmax(looking->worst, now - looking->last);
    looking->last = now;
    looking->fell = looking->fell || fraction < looking->fraction;
    looking->fraction = fraction;
    return looking->left-- > 0;
}

static struct looking begin(uint32_t looks)
{
    return (struct looking){.last = processor_ms(), .left = looks};
}

static void check_looks(struct looking *looking)
{
    (void)look(looking, looking->fraction); /* records the time since the last check */
    if (looking->worst > patience_ms) print_error("%.1f ms between two looks\n", looking->worst);
    assert_true(looking->worst <= patience_ms && !looking->fell);
}

/* Returns a closed B-spline that crosses many knot lines of the surface. */
static struct gd_domain_curve *winding(const struct gd_parametric *surface, uint32_t degree,
                                       double middle, const struct gd_control *control)
{
    static double points[CORNERS][2], knots[CORNERS + 16];
    for (int i = 0; i < CORNERS; i++) {
        double angle = 2 * M_PI * i / (CORNERS - 1), radius = 0.2 + 0.02 * sin(400 * angle);
        points[i][0] = middle + radius * cos(angle);
        points[i][1] = middle + radius * sin(angle);
    }
    for (uint32_t i = 0; i < CORNERS + degree + 1; i++)
        knots[i] = fmin(fmax((double)i - degree, 0), (double)(CORNERS - degree));
    struct gd_domain_curve *curve;
    check_ok(gd_domain_curve_bspline(
                 surface,
                 &(struct gd_domain_bspline){degree, knots, (const double(*)[2])points, CORNERS},
                 control, &curve, NULL),
             NULL);
    return curve;
}

static void between_curves_of_thousands_of_corners(void **state)
{
    (void)state;
    struct gd_parametric *surface = nurbs_bumps(60, 60, 0.3, 11);
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(surface, NULL, NULL, &tessellation, NULL), NULL);
    struct looking looking = begin(UINT32_MAX);
    const struct gd_control control = {.progress = look, .user = &looking};
    struct gd_domain_curve *from = winding(surface, 15, 0.25, &control);
    check_looks(&looking);
    struct gd_domain_curve *to = winding(surface, 1, 0.75, NULL);
    const struct gd_geodesic_options options = {.all_minima = true, .tolerance = 1e-14};
    struct gd_geodesics found;
    looking = begin(10000);
    assert_int_equal(gd_geodesic_solve(
                         tessellation,
                         &(struct gd_geodesic_request){.from = from, .to = to, .options = &options},
                         &control, &found, NULL),
                     GD_CANCELLED);
    check_looks(&looking);
    gd_domain_curve_release(from);
    gd_domain_curve_release(to);
    gd_tessellation_release(tessellation);
    gd_parametric_release(surface);
}

/* Solves for thousands of control points. Measuring the length of the solution checks the control,
 * too. */
static void on_one_spline_of_thousands_of_points(void **state)
{
    (void)state;
    struct gd_parametric *surface = nurbs_bumps(12, 12, 1.2, 13);
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(surface, NULL, NULL, &tessellation, NULL), NULL);
    struct looking looking = begin(UINT32_MAX);
    const struct gd_control control = {.progress = look, .user = &looking};
    struct gd_domain_curve *from = point_at(surface, 0.1, 0.2), *to = point_at(surface, 0.9, 0.7);
    const struct gd_geodesic_options options = {.control_points = MANY};
    struct gd_geodesics found;
    check_ok(gd_geodesic_solve(
                 tessellation,
                 &(struct gd_geodesic_request){.from = from, .to = to, .options = &options},
                 &control, &found, NULL),
             NULL);
    check_looks(&looking);
    gd_geodesics_free(&found);
    gd_domain_curve_release(from);
    gd_domain_curve_release(to);
    gd_tessellation_release(tessellation);
    gd_parametric_release(surface);
}

/* A call that is cancelled at any check returns no result and leaks nothing. */
static void cancelled_at_any_check(void **state)
{
    (void)state;
    struct gd_parametric *surface = nurbs_bumps(6, 6, 0.8, 5);
    struct gd_tessellation *tessellation;
    check_ok(gd_tessellation_build(surface, NULL, NULL, &tessellation, NULL), NULL);
    struct gd_domain_curve *from = loop_at(surface, 0.25, 0.3, 0.12, 0.15),
                           *to = loop_at(surface, 0.75, 0.7, 0.1, 0.2);
    struct looking looking = begin(UINT32_MAX);
    const struct gd_control control = {.progress = look, .user = &looking};
    struct gd_geodesics found;
    check_ok(gd_geodesic_solve(tessellation, &(struct gd_geodesic_request){.from = from, .to = to},
                               &control, &found, NULL),
             NULL);
    gd_geodesics_free(&found);
    uint32_t all = UINT32_MAX - looking.left;
    assert_true(all > 100 && looking.fraction > 0.5 && looking.fraction <= 1);
    for (uint32_t looks = 0; looks < all; looks += 1 + looks / 16) {
        struct gd_detail detail = {0};
        found = (struct gd_geodesics){.count = 7};
        looking = begin(looks);
        assert_int_equal(gd_geodesic_solve(tessellation,
                                           &(struct gd_geodesic_request){.from = from, .to = to},
                                           &control, &found, &detail),
                         GD_CANCELLED);
        assert_true(found.count == 7 && !found.items && detail.text[0]);
    }
    gd_domain_curve_release(from);
    gd_domain_curve_release(to);
    gd_tessellation_release(tessellation);
    gd_parametric_release(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(between_curves_of_thousands_of_corners),
        cmocka_unit_test(on_one_spline_of_thousands_of_points),
        cmocka_unit_test(cancelled_at_any_check),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
