#include "shapes.h"

#include <stdlib.h>

#include "tests/samples/samples.h"

static void a_budget_below_the_cost_is_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_icosphere(3, 1, &polygons), GD_OK);
    size_t cost = gd_mesh_build_cost(polygons.polygon_count, polygons.position_count);
    struct gd_control control = {.budget_bytes = cost - 1};
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, &detail), GD_BUDGET);
    assert_true(strlen(detail.text) > 0);
    assert_null(mesh);
    control.budget_bytes = cost;
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_OK);
    assert_true(gd_mesh_memsize(mesh) < cost);
    assert_true(gd_mesh_memsize(mesh) > 200 * (size_t)polygons.polygon_count);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* `pairs` of triangles, each of which shares one vertex. */
static struct gd_polygons new_bow_ties(uint32_t pairs)
{
    struct gd_polygons ties = {.positions = calloc(5 * pairs, sizeof *ties.positions),
                               .corners = calloc(6 * pairs, sizeof *ties.corners),
                               .position_count = 5 * pairs,
                               .polygon_count = 2 * pairs};
    for (uint32_t i = 0; i < pairs; i++) {
        const double shape[5][3] = {{0, 0, i}, {1, 0, i}, {1, 1, i}, {-1, 0, i}, {-1, 1, i}};
        const uint32_t corners[6] = {5 * i, 5 * i + 1, 5 * i + 2, 5 * i, 5 * i + 3, 5 * i + 4};
        memcpy(ties.positions[5 * i], shape, sizeof shape);
        memcpy(ties.corners + 6 * (size_t)i, corners, sizeof corners);
    }
    return ties;
}

static void a_budget_that_many_copies_exceed_is_refused(void **state)
{
    (void)state;
    struct gd_polygons ties = new_bow_ties(5000);
    size_t cost = gd_mesh_build_cost(ties.polygon_count, ties.position_count);
    struct gd_control control = {.budget_bytes = cost};
    struct gd_mesh_options options = {.repair_split = true};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&ties, &options, &control, &mesh, NULL), GD_BUDGET);
    assert_null(mesh);
    control.budget_bytes = gd_mesh_build_cost(ties.polygon_count, 6 * 5000);
    assert_int_equal(gd_mesh_build(&ties, &options, &control, &mesh, NULL), GD_OK);
    assert_int_equal(gd_mesh_repair(mesh)->copies, 5000);
    assert_true(gd_mesh_memsize(mesh) < control.budget_bytes);
    gd_mesh_release(mesh);
    gd_polygons_free(&ties);
}

struct stopwatch {
    uint32_t calls, stop_at;
    double last;
};

static bool count_calls(void *user, double fraction)
{
    struct stopwatch *watch = user;
    assert_true(fraction >= watch->last && fraction <= 1);
    watch->last = fraction;
    return ++watch->calls != watch->stop_at;
}

/* Whenever it is cancelled it stops and leaves nothing behind (the sanitizer looks). */
static void it_can_be_cancelled_at_every_report(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct stopwatch watch = {0};
    struct gd_control control = {.progress = count_calls, .user = &watch};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_OK);
    assert_true(watch.last == 1);
    gd_mesh_release(mesh);
    mesh = NULL;
    uint32_t reports = watch.calls;
    assert_true(reports > 10);
    for (uint32_t i = 1; i <= reports; i++) {
        watch = (struct stopwatch){.stop_at = i};
        assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_CANCELLED);
        assert_null(mesh);
    }
}

static void a_deadline_in_the_past_stops_it(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_control control = {.deadline_ns = gd_now_ns()};
    struct gd_mesh *mesh = NULL;
    assert_int_equal(gd_mesh_build(&polygons, NULL, &control, &mesh, NULL), GD_DEADLINE);
    assert_null(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_budget_below_the_cost_is_refused),
        cmocka_unit_test(a_budget_that_many_copies_exceed_is_refused),
        cmocka_unit_test(it_can_be_cancelled_at_every_report),
        cmocka_unit_test(a_deadline_in_the_past_stops_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
