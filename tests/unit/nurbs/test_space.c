#include "tests/support/test.h"

#include <math.h>

#include "gd/space_distance.h"

static struct gd_vec3 de_boor(const struct gd_space_curve *curve, double s)
{
    struct gd_vec3 d[8];
    uint32_t p = curve->degree, k = p;
    if (!p) return curve->points[0];
    while (k + 1 < curve->count && s >= curve->knots[k + 1]) k++;
    for (uint32_t j = 0; j <= p; j++) d[j] = curve->points[j + k - p];
    for (uint32_t r = 1; r <= p; r++) {
        for (uint32_t j = p; j >= r; j--) {
            double low = curve->knots[j + k - p],
                   part = (s - low) / (curve->knots[j + 1 + k - r] - low);
            d[j] = gd_vec3_along(gd_vec3_scale(d[j - 1], 1 - part), part, d[j]);
        }
    }
    return d[p];
}

static double brute(const struct gd_space_curve *a, const struct gd_space_curve *b)
{
    enum { PLACES = 600 };
    double least = INFINITY;
    for (int i = 0; i <= PLACES; i++) {
        double low = a->degree ? a->knots[a->degree] : 0, high = a->degree ? a->knots[a->count] : 0;
        struct gd_vec3 x = de_boor(a, low + (high - low) * i / PLACES);
        for (int j = 0; j <= PLACES; j++) {
            double from = b->degree ? b->knots[b->degree] : 0,
                   to = b->degree ? b->knots[b->count] : 0;
            least = fmin(least, gd_vec3_distance(x, de_boor(b, from + (to - from) * j / PLACES)));
        }
    }
    return least;
}

static void skew_lines_and_points(void **state)
{
    (void)state;
    const double knots[4] = {0, 0, 1, 1};
    const struct gd_vec3 x[2] = {{-1, 0, 0}, {1, 0, 0}}, y[2] = {{0, -1, 2}, {0, 3, 2}},
                         p = {0.5, 3, 4};
    struct gd_space_curve a = {1, 2, knots, x}, b = {1, 2, knots, y}, point = {0, 1, NULL, &p};
    struct gd_space_closest foot;
    check_ok(gd_space_distance(&a, &b, &foot, NULL), NULL);
    check_close(foot.distance, 2, 1e-15);
    check_close(foot.from_parameter, 0.5, 1e-12);
    check_close(foot.to_parameter, 0.25, 1e-12);
    check_ok(gd_space_distance(&a, &point, &foot, NULL), NULL);
    check_close(foot.distance, 5, 1e-15);
    check_ok(gd_space_distance(&point, &point, &foot, NULL), NULL);
    assert_true(foot.distance == 0);
}

static void random_curves_against_brute_force(void **state)
{
    (void)state;
    struct rng rng = {1};
    for (int i = 0; i < 12; i++) {
        struct gd_vec3 points[2][8];
        const double knots[] = {0, 0, 0, 0, 1, 2, 3, 4, 5, 5, 5, 5};
        for (int k = 0; k < 16; k++) {
            double shift = k < 8 ? 0 : 1.5;
            points[k / 8][k % 8] = (struct gd_vec3){rng_unit(&rng) + shift, rng_unit(&rng),
                                                    rng_unit(&rng) + (i % 3 ? 0 : shift)};
        }
        struct gd_space_curve a = {3, 8, knots, points[0]}, b = {3, 8, knots, points[1]};
        struct gd_space_closest there, back;
        check_ok(gd_space_distance(&a, &b, &there, NULL), NULL);
        check_ok(gd_space_distance(&b, &a, &back, NULL), NULL);
        double least = brute(&a, &b);
        if (!(there.distance <= least + 1e-14 && there.distance > least - 1e-2))
            print_error("%.17g found, %.17g by brute force\n", there.distance, least);
        assert_true(there.distance <= least + 1e-14 && there.distance > least - 1e-2);
        check_close(there.distance, back.distance, 1e-12);
        check_close(gd_vec3_distance(there.from, there.to), there.distance, 1e-15);
    }
}

static void wrong_curves_are_refused(void **state)
{
    (void)state;
    const double good[4] = {0, 0, 1, 1}, falling[4] = {0, 1, 0, 1}, empty[4] = {0, 1, 1, 2};
    const struct gd_vec3 points[2] = {{0, 0, 0}, {1, 0, 0}}, nowhere[2] = {{NAN, 0, 0}, {1, 0, 0}};
    const struct gd_space_curve line = {1, 2, good, points};
    const struct gd_space_curve wrong[] = {{1, 2, falling, points}, {1, 2, empty, points},
                                           {1, 2, good, nowhere},   {1, 1, good, points},
                                           {16, 20, good, points},  {0, 2, NULL, points}};
    struct gd_space_closest foot = {.distance = 7};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct gd_detail detail = {0};
        assert_int_equal(gd_space_distance(&line, &wrong[i], &foot, &detail), GD_INVALID_ARGUMENT);
        assert_true(detail.text[0] && foot.distance == 7);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(skew_lines_and_points),
        cmocka_unit_test(random_curves_against_brute_force),
        cmocka_unit_test(wrong_curves_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
