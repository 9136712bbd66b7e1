#include "lines.h"

#include "gd/mean.h"

static struct gd_mean mean_of(const struct gd_mesh *mesh, const struct gd_point *points,
                              const double *weights, uint32_t count, bool one_step)
{
    struct gd_mean mean;
    struct gd_detail detail = {0};
    const struct gd_mean_request request = {
        .points = points, .weights = weights, .count = count, .one_step = one_step};
    check_ok(gd_mean_find(mesh, &request, NULL, &mean, &detail), &detail);
    return mean;
}

enum { MOST = 6 };

static void arithmetic_in_the_plane(void **state)
{
    (void)state;
    struct surface grid = surface_of("grid", (double[SAMPLE_PARAMETERS]){13, 11, 1, 1});
    struct rng rng = {6};
    for (int i = 0; i < 60; i++) {
        struct gd_point points[MOST];
        double weights[MOST], sum = 0, x = 0, y = 0;
        uint32_t count = 1 + (uint32_t)i % MOST;
        for (uint32_t k = 0; k < count; k++) {
            points[k] = test_point(grid.mesh, test_random_place(&grid.polygons, &rng));
            struct gd_vec3 p = gd_point_position(grid.mesh, &points[k]);
            weights[k] = rng_between(&rng, 0, 2);
            x += weights[k] * p.x, y += weights[k] * p.y, sum += weights[k];
        }
        for (int one_step = 0; one_step < 2; one_step++) {
            struct gd_mean mean = mean_of(grid.mesh, points, weights, count, one_step);
            expect_place(gd_point_position(grid.mesh, &mean.point), x / sum, y / sum, 0, exact);
            assert_true(mean.converged && mean.residual <= exact);
        }
    }
    surface_free(&grid);
}

/* The mean depends neither on the order of the points nor on whether equal weights are given. At
 * the mean the vectors to the points cancel. */
static void does_not_depend_on_the_order(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {20, 0.6, 3}},
                    {"genus2", {5, 0.1}},
                    {"box", {1, 2, 3, 2}},
                    {"icosphere", {3, 1}}};
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s};
        for (int i = 0; i < 12; i++) {
            struct gd_point points[MOST], turned[MOST];
            double weights[MOST];
            for (int k = 0; k < MOST; k++) {
                points[k] = test_point(surface.mesh, test_random_place(&surface.polygons, &rng));
                turned[MOST - 1 - k] = points[k];
                weights[k] = 3;
            }
            struct gd_mean a = mean_of(surface.mesh, points, NULL, MOST, false),
                           b = mean_of(surface.mesh, turned, weights, MOST, false);
            struct gd_vec3 p = gd_point_position(surface.mesh, &a.point);
            assert_true(a.converged && a.residual <= 1e-11 * a.spread);
            expect_place(gd_point_position(surface.mesh, &b.point), p.x, p.y, p.z,
                         promise * a.spread);
            struct gd_mean once = mean_of(surface.mesh, points, NULL, MOST, true);
            assert_true(once.iterations == 1);
        }
        surface_free(&surface);
    }
}

/* The mean of three points of a sphere that are symmetric about an axis lies on the axis. */
static void symmetric_on_a_ball(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(3, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point points[3];
    struct gd_vec3 sum = {0, 0, 0};
    for (uint32_t k = 0; k < 3; k++) {
        points[k] = vertex(mesh, polygons.corners[k]);
        sum = gd_vec3_add(sum, gd_point_position(mesh, &points[k]));
    }
    struct gd_mean mean = mean_of(mesh, points, NULL, 3, false);
    struct gd_vec3 at = gd_point_position(mesh, &mean.point);
    expect_near(gd_vec3_length(gd_vec3_cross(at, sum)), 0, exact);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* At the apex of a saddle, whose total angle is much larger than 2 pi, the mean is stable: it stays
 * when the points move. */
static void stable_at_a_saddle(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_saddle(1, 2, 12, 5, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 5; i++) {
        struct gd_point points[3];
        for (int k = 0; k < 3; k++) {
            double around = 2 * M_PI * k / 3 + 0.3 + 0.02 * i, r = 0.5 + 0.02 * i * k;
            points[k] = nearest(mesh, r * cos(around), r * sin(around), 0);
        }
        struct gd_mean mean = mean_of(mesh, points, NULL, 3, false);
        struct gd_vec3 at = gd_point_position(mesh, &mean.point);
        expect_place(at, 0, 0, 0, 0);
        assert_true(mean.converged && mean.residual == 0);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void refusals(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point points[2] = {vertex(mesh, 0), vertex(mesh, 4)};
    static const double nothing[2] = {0, 0}, negative[2] = {1, -1}, infinite[2] = {INFINITY, 1};
    struct gd_mean mean = {.residual = 7};
    struct gd_mean_request request = {.points = points, .count = 2};
    assert_int_equal(gd_mean_find(mesh, &request, NULL, &mean, NULL), GD_NOT_ON_SURFACE);
    points[1] = vertex(mesh, 1);
    const double *const weights[] = {nothing, negative, infinite};
    for (uint32_t i = 0; i < COUNT(weights); i++) {
        request.weights = weights[i];
        assert_int_equal(gd_mean_find(mesh, &request, NULL, &mean, NULL), GD_INVALID_ARGUMENT);
    }
    request = (struct gd_mean_request){.points = points, .count = 0};
    assert_int_equal(gd_mean_find(mesh, &request, NULL, &mean, NULL), GD_INVALID_ARGUMENT);
    request.count = 2;
    struct gd_control control = {.deadline_ns = 1};
    assert_int_equal(gd_mean_find(mesh, &request, &control, &mean, NULL), GD_DEADLINE);
    assert_true(mean.residual == 7);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arithmetic_in_the_plane),
        cmocka_unit_test(does_not_depend_on_the_order),
        cmocka_unit_test(symmetric_on_a_ball),
        cmocka_unit_test(stable_at_a_saddle),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
