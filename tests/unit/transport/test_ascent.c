#include "lines.h"

#include "transport/ascent.h"

enum { MOST = 7, STEPS = 20000 };

/* Computes by definition the sum that gd__ascent maximises. */
static double sum_at(const struct gd__pull *pulls, uint32_t count, double turn, double circle)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        double apart =
            circle > 0 ? fabs(remainder(pulls[i].turn - turn, circle)) : fabs(pulls[i].turn - turn);
        sum += pulls[i].strength * cos(fmin(apart, M_PI));
    }
    return sum;
}

/* Checks that no direction on the surface has a larger sum than the found one, and that the found
 * direction has the returned sum. */
static void check_point(const struct gd_mesh *mesh, struct gd_point point, struct rng *rng)
{
    bool is_closed = gd__turn_is_closed(mesh, &point);
    double total = gd__turn_total(mesh, &point), first = 0, extent = total, best = -INFINITY,
           turn = NAN;
    struct gd__pull pulls[MOST];
    if (!is_closed && point.kind == GD_POINT_EDGE) {
        struct gd_direction inward = gd_trace_fan(mesh, &point, 3, 1);
        extent = M_PI;
        first = gd__turn_of_angle(mesh, &point, inward.angle) - M_PI_2;
    }
    for (int i = 0; i < MOST; i++)
        pulls[i] = (struct gd__pull){.turn = first + rng_between(rng, 0, extent),
                                     .strength = rng_between(rng, 0, 2),
                                     .weight = 1,
                                     .bend = 1};
    double found = gd__ascent(mesh, &point, pulls, MOST, &turn), circle = is_closed ? total : 0;
    for (int i = 0; i <= STEPS; i++)
        best = fmax(best, sum_at(pulls, MOST, first + extent * i / STEPS, circle));
    expect_near(found, best, 1e-5);
    assert_true(found >= best - 1e-12);
    double apart = is_closed ? 0 : fmax(first - turn, turn - first - extent);
    if (!is_closed && point.kind == GD_POINT_EDGE && apart > 0) apart = fabs(apart - 2 * M_PI);
    assert_true(apart <= 1e-9);
    expect_near(
        sum_at(pulls, MOST, is_closed ? turn : fmin(fmax(turn, first), first + extent), circle),
        found, 1e-9);
}

static void greatest_of_all(void **state)
{
    (void)state;
    struct surface saddle = surface_of("saddle", (double[SAMPLE_PARAMETERS]){1, 1.5, 12, 3}),
                   cone = surface_of("cone", (double[SAMPLE_PARAMETERS]){1, 1.5, 7, 3}),
                   grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){3, 3, 1, 1});
    struct rng rng = {1};
    for (int i = 0; i < 20; i++) {
        check_point(saddle.mesh, nearest(saddle.mesh, 0, 0, 0), &rng);
        check_point(cone.mesh, nearest(cone.mesh, 0, 0, 1.5), &rng);
        check_point(grid.mesh, nearest(grid.mesh, 0, 0, 0), &rng);
        check_point(grid.mesh, nearest(grid.mesh, 0.4, 0.45, 0), &rng);
        check_point(grid.mesh, nearest(grid.mesh, 1, 0.2, 0), &rng);
    }
    surface_free(&saddle);
    surface_free(&cone);
    surface_free(&grid);
}

/* In a plane, Newton's step leads to the mean of the vectors' ends. If a vector bends, the second
 * derivative across it is larger by the factor `bend`. */
static void steps_to_the_mean(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){3, 3, 1, 1});
    struct gd_point point = nearest(grid.mesh, 0.41, 0.45, 0);
    const struct gd__pull pulls[2] = {{0, 3, 1, 1}, {M_PI_2, 2, 2, 1}};
    double turn = NAN, length = gd__ascent_step(grid.mesh, &point, pulls, 2, 0, &turn);
    expect_near(length * cos(turn), 1, exact);
    expect_near(length * sin(turn), 2.0 / 3, exact);
    const struct gd__pull bent[2] = {{0, 3, 1, 4}, {M_PI_2, 2, 2, 1}};
    length = gd__ascent_step(grid.mesh, &point, bent, 2, 0, &turn);
    expect_near(length * cos(turn), 1, exact);
    expect_near(length * sin(turn), 2.0 / 6, exact);
    surface_free(&grid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(greatest_of_all),
                                       cmocka_unit_test(steps_to_the_mean)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
