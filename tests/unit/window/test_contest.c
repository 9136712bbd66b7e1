/* Property 6 of Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle meshes using edge-based
 * data structures": two windows give equal distances (equation 1) at zero, one, two or infinitely
 * many points of their overlap. */
#include "tests/support/test.h"

#include "window/contest.h"

static struct gd__window window(double x, double y, double sigma)
{
    return (struct gd__window){.b0 = 0, .b1 = 1, .x = x, .y = y, .sigma = sigma};
}

static double gap(const struct gd__window *a, const struct gd__window *b, double t)
{
    return fabs(gd__window_distance(a, t) - gd__window_distance(b, t));
}

static void no_solution(void **state)
{
    (void)state;
    struct gd__window near = window(0.4, 0.3, 0), far = window(0.5, 0.3, 5);
    struct gd__contest_result result = gd__contest(&near, &far, 0, 1);
    assert_true(result.challenger_first);
    assert_int_equal(result.switches, 0);
    result = gd__contest(&far, &near, 0, 1);
    assert_false(result.challenger_first);
    assert_int_equal(result.switches, 0);
}

static void one_solution(void **state)
{
    (void)state;
    struct gd__window left = window(-0.5, 0.7, 0), right = window(1.5, 0.7, 0);
    struct gd__contest_result result = gd__contest(&left, &right, 0, 1);
    assert_true(result.challenger_first);
    assert_int_equal(result.switches, 1);
    check_close(result.at[0], 0.5, 1e-15);
    right.sigma = 0.25; /* the distances are equal on a branch of a hyperbola */
    result = gd__contest(&right, &left, 0, 1);
    assert_false(result.challenger_first);
    assert_int_equal(result.switches, 1);
    assert_true(gap(&left, &right, result.at[0]) < 1e-15);
}

static void two_solutions(void **state)
{
    (void)state;
    struct gd__window wide = window(0.5, 1, 0),
                      /* the narrow window wins a middle part */
        narrow = window(0.5, 0.1, 0.8);
    struct gd__contest_result result = gd__contest(&narrow, &wide, 0, 1);
    assert_false(result.challenger_first);
    assert_int_equal(result.switches, 2);
    assert_true(result.at[0] < 0.5 && result.at[1] > 0.5);
    check_close(result.at[0] + result.at[1], 1, 1e-14);
    for (int i = 0; i < 2; i++) assert_true(gap(&wide, &narrow, result.at[i]) < 1e-15);
    result = gd__contest(&wide, &narrow, 0, 1);
    assert_true(result.challenger_first);
    assert_int_equal(result.switches, 2);
}

static void in_a_tie_everywhere_the_owner_wins(void **state)
{
    (void)state;
    /* sources that mirror each other across the edge have the same distances to its points */
    struct gd__window a = window(0.3, 0.4, 1), b = a;
    struct gd__contest_result result = gd__contest(&a, &b, 0, 1);
    assert_false(result.challenger_first);
    assert_int_equal(result.switches, 0);
    b.x += 1e-16; /* the result is the same if both differ by rounding */
    b.sigma += 1e-16;
    assert_int_equal(gd__contest(&a, &b, 0, 1).switches, 0);
    assert_false(gd__contest(&a, &b, 0, 1).challenger_first);
}

/* At a tangential double root, a Newton step would diverge. */
static void a_double_root_changes_nothing(void **state)
{
    (void)state;
    /* the distances are equal at t = 0.5 only */
    struct gd__window wide = window(0.5, 1, 0), touching = window(0.5, 0.1, 0.9);
    for (double shift = -1e-15; shift <= 1e-15; shift += 5e-16) {
        touching.sigma = 0.9 + shift;
        struct gd__contest_result result = gd__contest(&touching, &wide, 0, 1);
        assert_false(result.challenger_first);
        if (result.switches) assert_true(result.at[1] - result.at[0] < 1e-6);
    }
}

/* Two sources close to a long edge have equal distances at both ends of the edge. Between the ends,
 * close to the sources, the distance from one source is much smaller. */
static void windows_equal_at_both_ends_differ_between(void **state)
{
    (void)state;
    struct gd__window near = {.b0 = 0, .b1 = 1e4, .x = 5e3, .y = 1e-4},
                      far = {.b0 = 0, .b1 = 1e4, .x = 5e3, .y = 3e-4};
    for (double sigma = 0; sigma < 1e-4; sigma += 4e-5) {
        near.sigma = sigma * 1e-10; /* unequal sigma tests other code of the contest */
        assert_true(gd__contest(&near, &far, 0, 1e4).challenger_first);
        assert_int_equal(gd__contest(&near, &far, 0, 1e4).switches, 0);
        assert_false(gd__contest(&far, &near, 0, 1e4).challenger_first);
        assert_int_equal(gd__contest(&far, &near, 0, 1e4).switches, 0);
    }
}

/* Tests that the distance through the winner is nowhere larger than through the other window,
 * except by rounding. */
static void winner_is_never_worse(void **state)
{
    (void)state;
    struct rng rng = {1};
    double worst = 0;
    int counts[3] = {0, 0, 0};
    for (int i = 0; i < 200000; i++) {
        double scale = pow(10, rng_between(&rng, -3, 3));
        struct gd__window a =
            window(rng_between(&rng, -1, 2) * scale, exp(rng_between(&rng, -8, 1)) * scale, 0);
        struct gd__window b =
            window(rng_between(&rng, -1, 2) * scale, exp(rng_between(&rng, -8, 1)) * scale, 0);
        double mode = rng_between(&rng, 0, 1), hi = scale;
        /* ties at the start, in the middle and at the end are equally frequent */
        double tie = hi * (int)rng_between(&rng, 0, 3) / 2;
        if (mode > 0.2)
            b.sigma = (gd__window_distance(&a, tie) - gd__window_distance(&b, tie)) *
                      (mode > 0.6 ? 1 : mode);
        if (b.sigma < 0) {
            a.sigma = -b.sigma;
            b.sigma = 0;
        }
        struct gd__contest_result result = gd__contest(&a, &b, 0, hi);
        counts[result.switches]++;
        for (int k = 0; k <= 50; k++) {
            double t = hi * k / 50;
            bool challenger = result.challenger_first;
            for (int j = 0; j < result.switches; j++) challenger ^= t > result.at[j];
            double da = gd__window_distance(&a, t), db = gd__window_distance(&b, t),
                   excess = challenger ? da - db : db - da;
            if (excess / (da + db) > worst) worst = excess / (da + db);
        }
    }
    print_message("# contest: 200000 random pairs, switches 0/1/2: %d/%d/%d, worst relative excess "
                  "of a winner %.1e\n",
                  counts[0], counts[1], counts[2], worst);
    assert_true(counts[1] > 10000 && counts[2] > 100);
    assert_true(worst < 1e-12);
}

/* --- linear windows --------------------------------------------------------------------------- */

/* Returns the linear window of a line at this angle to the edge. `sigma` is the line's distance
 * from the edge's origin. */
static struct gd__window linear(double angle, double sigma)
{
    return (struct gd__window){.b0 = 0,
                               .b1 = 1,
                               .x = cos(angle),
                               .y = sin(angle),
                               .sigma = sigma,
                               .source = GD__SOURCE_LINEAR};
}

static void a_line_and_a_point_are_equally_near_on_a_parabola(void **state)
{
    (void)state;
    /* the point wins in the middle */
    struct gd__window line = linear(M_PI / 2, 0.5), point = window(0.5, 0.1, 0.2);
    struct gd__contest_result result = gd__contest(&point, &line, 0, 1);
    assert_false(result.challenger_first);
    assert_int_equal(result.switches, 2);
    double half = sqrt(0.3 * 0.3 - 0.1 * 0.1);
    check_close(result.at[0], 0.5 - half, 1e-14);
    check_close(result.at[1], 0.5 + half, 1e-14);
    line = linear(1.1, 0.75); /* at another angle the distances cross once */
    for (int i = 0; i < 2; i++) {
        result = i ? gd__contest(&line, &point, 0, 1) : gd__contest(&point, &line, 0, 1);
        assert_int_equal(result.switches, 1);
        assert_true(gap(&line, &point, result.at[0]) < 1e-15);
        assert_true(result.challenger_first == (i == 0));
    }
}

static void two_lines_are_equally_near_at_one_place(void **state)
{
    (void)state;
    struct gd__window a = linear(2.0, 0.3), b = linear(1.0, 0.6);
    struct gd__contest_result result = gd__contest(&a, &b, 0, 1);
    assert_true(result.challenger_first);
    assert_int_equal(result.switches, 1);
    check_close(result.at[0], 0.3 / (cos(1.0) - cos(2.0)), 1e-14);
    assert_int_equal(gd__contest(&a, &a, 0, 1).switches, 0);
    assert_false(gd__contest(&a, &a, 0, 1).challenger_first);
}

/* On the normal through a segment's end, the end is as near as the segment. This is a double
 * root. */
static void a_double_root_at_the_end_of_a_line_changes_nothing(void **state)
{
    (void)state;
    struct gd__window line = linear(M_PI / 2, 0.5), end = window(1, 0.5, 0);
    assert_false(gd__contest(&end, &line, 0, 1).challenger_first);
    assert_int_equal(gd__contest(&end, &line, 0, 1).switches, 0);
    assert_true(gd__contest(&line, &end, 0, 1).challenger_first);
}

static void random_contests_with_lines(void **state)
{
    (void)state;
    struct rng rng = {3};
    for (int i = 0; i < 20000; i++) {
        struct gd__window a = linear(rng_between(&rng, 0.01, 3.13), rng_between(&rng, 0, 2)),
                          b = rng_below(&rng, 2)
                                  ? linear(rng_between(&rng, 0.01, 3.13), rng_between(&rng, 0, 2))
                                  : window(rng_between(&rng, -1, 2), rng_between(&rng, 0.01, 1),
                                           rng_between(&rng, 0, 1));
        struct gd__contest_result result = gd__contest(&a, &b, 0, 1);
        for (int k = 0; k < 50; k++) {
            double t = rng_unit(&rng),
                   difference = gd__window_distance(&a, t) - gd__window_distance(&b, t);
            bool a_wins = result.challenger_first;
            for (int s = 0; s < result.switches; s++) a_wins ^= t > result.at[s];
            if (fabs(difference) > 1e-12) assert_true(a_wins == (difference < 0));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_solution),
        cmocka_unit_test(one_solution),
        cmocka_unit_test(two_solutions),
        cmocka_unit_test(in_a_tie_everywhere_the_owner_wins),
        cmocka_unit_test(a_double_root_changes_nothing),
        cmocka_unit_test(windows_equal_at_both_ends_differ_between),
        cmocka_unit_test(winner_is_never_worse),
        cmocka_unit_test(a_line_and_a_point_are_equally_near_on_a_parabola),
        cmocka_unit_test(two_lines_are_equally_near_at_one_place),
        cmocka_unit_test(a_double_root_at_the_end_of_a_line_changes_nothing),
        cmocka_unit_test(random_contests_with_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
