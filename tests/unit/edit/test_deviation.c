#include "edits.h"
#include "tests/support/two_threads.h"

static double deviation(const struct gd_mesh *mesh, const struct gd_polygons *edited)
{
    double distance = NAN;
    struct gd_detail detail = {0};
    check_ok(gd_edit_deviation(mesh, edited, NULL, &distance, &detail), &detail);
    return distance;
}

/* Compares distances with closed forms for a shifted plane, and for a spike that only one of the
 * meshes has. */
static void known_distances(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = test_sample("grid", (double[SAMPLE_PARAMETERS]){8, 8, 8, 8}, &polygons);
    assert_true(deviation(mesh, &polygons) < 1e-14);
    for (uint32_t i = 0; i < polygons.position_count; i++) polygons.positions[i][2] += 0.25;
    check_close(deviation(mesh, &polygons), 0.25, 1e-12);
    struct gd_mesh *shifted = test_mesh(&polygons);
    for (uint32_t i = 0; i < polygons.position_count; i++) polygons.positions[i][2] -= 0.25;
    check_close(deviation(shifted, &polygons), 0.25, 1e-12);
    gd_mesh_release(shifted);
    /* the original's vertices are samples */
    polygons.positions[40][2] = 3;
    struct gd_mesh *spiky = test_mesh(&polygons);
    polygons.positions[40][2] = 0;
    check_close(deviation(spiky, &polygons), 3, 1e-12);
    gd_mesh_release(spiky);
    gd_polygons_free(&polygons);
    gd_mesh_release(mesh);
}

/* The middles of the result's faces and edges are samples. */
static void middles_are_samples(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = test_sample("grid", (double[SAMPLE_PARAMETERS]){8, 8, 8, 8}, &polygons);
    polygons.positions[40][2] = 3;
    double distance = deviation(mesh, &polygons);
    assert_true(distance >= 1.5 * (1 - 1e-12) && distance <= 3);
    gd_polygons_free(&polygons);
    gd_mesh_release(mesh);
}

/* The mesh has several slices of samples. */
static void two_threads_measure_the_same(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){6, 1}, &polygons);
    const struct gd_control control = {.executor = &two_threads};
    for (uint32_t i = 0; i < polygons.position_count; i++)
        polygons.positions[i][i % 3] *= 1 + 1e-3 * sin(i);
    double distance;
    check_ok(gd_edit_deviation(mesh, &polygons, &control, &distance, NULL), NULL);
    assert_true(distance > 1e-4 && distance == deviation(mesh, &polygons));
    gd_polygons_free(&polygons);
    gd_mesh_release(mesh);
}

static void invalid_polygons_are_refused(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("tetrahedron", (double[SAMPLE_PARAMETERS]){1, 1}, NULL);
    double positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    uint32_t corners[3] = {0, 1, 2};
    const struct gd_polygons flat = {
        .positions = positions, .position_count = 3, .corners = corners, .polygon_count = 1};
    struct gd_detail detail = {0};
    double distance;
    assert_int_equal(gd_edit_deviation(mesh, &flat, NULL, &distance, &detail), GD_DEGENERATE_FACE);
    assert_int_equal(detail.count, 1);
    gd_mesh_release(mesh);
}

static void it_can_be_cancelled(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, &polygons);
    enum gd_status status = GD_CANCELLED;
    double distance;
    for (uint32_t calls = 1; status == GD_CANCELLED; calls += 5) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        status = gd_edit_deviation(mesh, &polygons, &control, &distance, NULL);
        assert_true(status == GD_OK || (status == GD_CANCELLED && watch.calls == calls));
    }
    gd_polygons_free(&polygons);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_distances),
        cmocka_unit_test(middles_are_samples),
        cmocka_unit_test(two_threads_measure_the_same),
        cmocka_unit_test(invalid_polygons_are_refused),
        cmocka_unit_test(it_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
