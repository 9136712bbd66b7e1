/* Tests guarantees of the propagation loop: its work is bounded, and a run that fails leaves no
 * data in the workspace. */
#include "tests/support/test.h"

#include "tests/samples/samples.h"
#include "wavefront/wavefront.h"

static struct gd_polygons polygons;
static struct gd_mesh *mesh;
static struct gd__seed seed;

static int open_mesh(void **state)
{
    (void)state;
    check_ok(sample_terrain(40, 0.3, 7, &polygons), NULL);
    mesh = test_mesh(&polygons);
    seed.point = test_point(mesh, (struct test_place){0, {1, 0, 0}});
    return 0;
}

static int close_mesh(void **state)
{
    (void)state;
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    return 0;
}

/* A receiver of windows that stores only their number. */
static enum gd_status count_work(void *user, struct gd__wavefront *front)
{
    *(uint64_t *)user = front->counts.windows_propagated;
    return GD_OK;
}

static enum gd_status run(uint64_t work_limit, struct gd_workspace *workspace, uint64_t *work)
{
    struct gd__propagation propagation = {
        .seeds = &seed, .seed_count = 1, .radius = GD__FAR, .work_limit = work_limit};
    struct gd__sink sink = {.take = count_work, .user = work};
    struct gd_control control = {.workspace = workspace};
    return gd__wavefront_run(mesh, &propagation, &sink, &control);
}

/* A run beyond its work limit fails with GD_RUNAWAY and does not call its sink. The next run in the
 * same workspace is not affected. */
static void a_runaway_is_stopped(void **state)
{
    (void)state;
    struct gd_workspace *workspace = gd_workspace_create();
    assert_non_null(workspace);
    uint64_t needed = 0, again = 0, none = 0;
    check_ok(run(0, workspace, &needed), NULL);
    assert_true(needed > 10000);
    static const double parts[] = {1e-4, 0.1, 0.5, 0.9};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(run((uint64_t)(parts[i] * (double)needed), workspace, &none), GD_RUNAWAY);
        assert_int_equal(run((uint64_t)(parts[i] * (double)needed), NULL, &none), GD_RUNAWAY);
        assert_int_equal(none, 0);
        check_ok(run(2 * needed, workspace, &again), NULL);
        assert_int_equal(again, needed);
    }
    gd_workspace_destroy(workspace);
}

/* Returns the number of windows on a cylinder with this number of narrow sides. */
static double windows_of_needles(uint32_t sides)
{
    struct gd_polygons needles;
    check_ok(sample_cylinder(1, 2, sides, 2, &needles), NULL);
    struct gd_mesh *open = mesh;
    struct gd__seed before = seed;
    uint64_t work = 0;
    mesh = test_mesh(&needles);
    seed.point = test_point(mesh, (struct test_place){0, {1, 0, 0}});
    check_ok(run(0, NULL, &work), NULL);
    gd_mesh_release(mesh);
    gd_polygons_free(&needles);
    mesh = open;
    seed = before;
    return (double)work;
}

/* Each of many narrow faces propagates a window without dividing it. So the number of windows is
 * linear in the number of faces. */
static void needles_are_not_quadratic(void **state)
{
    (void)state;
    double few = windows_of_needles(1000), many = windows_of_needles(4000);
    print_message("# needles: %.0f windows for 4,000 faces, %.0f for 16,000\n", few, many);
    assert_true(many < 6 * few);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_runaway_is_stopped),
        cmocka_unit_test(needles_are_not_quadratic),
    };
    return cmocka_run_group_tests(tests, open_mesh, close_mesh);
}
