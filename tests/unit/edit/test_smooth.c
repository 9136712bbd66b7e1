#include "edits.h"
#include "tests/support/two_threads.h"

static struct gd_edited smoothed(const struct gd_mesh *mesh, enum gd_smooth_direction direction)
{
    const struct gd_smooth_options options = {10, direction, 1};
    struct gd_edited edited;
    struct gd_detail detail = {0};
    check_ok(gd_smooth_mesh(mesh, &options, NULL, &edited, &detail), &detail);
    return edited;
}

/* Returns a sphere with noise along its normals. */
static struct gd_mesh *noisy_sphere(void)
{
    struct gd_polygons polygons;
    gd_mesh_release(test_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, &polygons));
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        for (int k = 0; k < 3; k++) polygons.positions[i][k] *= 1 + 0.005 * sin(12345.0 * i);
    }
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static double roughness(const struct gd_polygons *polygons)
{
    double sum = 0, squares = 0;
    for (uint32_t i = 0; i < polygons->position_count; i++) {
        double radius = gd_vec3_length(position_at(polygons, i));
        sum += radius;
        squares += radius * radius;
    }
    double mean = sum / polygons->position_count;
    return sqrt(squares / polygons->position_count - mean * mean);
}

static void noise_is_reduced(void **state)
{
    (void)state;
    struct gd_mesh *mesh = noisy_sphere();
    struct gd_polygons before;
    check_ok(gd_mesh_polygons(mesh, &before), NULL);
    struct gd_edited edited = smoothed(mesh, GD_SMOOTH_BOTH);
    assert_true(roughness(&edited.polygons) < roughness(&before) / 3);
    assert_int_equal(edited.polygons.position_count, before.position_count);
    assert_memory_equal(edited.polygons.corners, before.corners,
                        3 * before.polygon_count * sizeof *before.corners);
    gd_mesh_release(test_mesh(&edited.polygons));
    gd_edited_free(&edited);
    gd_polygons_free(&before);
    gd_mesh_release(mesh);
}

/* Tangential smoothing keeps a plane flat and its boundary fixed. Normal smoothing leaves a plane
 * unchanged. */
static void planes_stay_planes(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    gd_mesh_release(test_sample("grid", (double[SAMPLE_PARAMETERS]){8, 8, 8, 8}, &polygons));
    polygons.positions[40][0] += 0.3; /* an inner vertex */
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_edited along = smoothed(mesh, GD_SMOOTH_TANGENTIAL);
    struct gd_edited across = smoothed(mesh, GD_SMOOTH_NORMAL);
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        assert_true(along.polygons.positions[i][2] == 0);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(across.polygons.positions[i][k] - polygons.positions[i][k]) < 1e-14);
    }
    for (uint32_t i = 0; i < 9; i++)
        assert_memory_equal(along.polygons.positions[i], polygons.positions[i], sizeof(double[3]));
    assert_true(along.polygons.positions[40][0] != polygons.positions[40][0]);
    gd_edited_free(&along);
    gd_edited_free(&across);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void features_stay(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("box", (double[SAMPLE_PARAMETERS]){1, 1, 1, 4}, NULL);
    struct gd_edited edited = smoothed(mesh, GD_SMOOTH_BOTH);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    check_close(gd_mesh_summary(made)->area, 6, 1e-12);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void bad_options_and_control(void **state)
{
    (void)state;
    struct gd_mesh *mesh = noisy_sphere();
    const struct gd_smooth_options bad[] = {
        {0, GD_SMOOTH_BOTH, 1}, {1001, GD_SMOOTH_BOTH, 1}, {1, GD_SMOOTH_BOTH, NAN}};
    const struct gd_control late = {.deadline_ns = 1};
    struct gd_edited edited;
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(gd_smooth_mesh(mesh, &bad[i], NULL, &edited, NULL), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_smooth_mesh(mesh, &(struct gd_smooth_options){1000, GD_SMOOTH_BOTH, 1},
                                    &late, &edited, NULL),
                     GD_DEADLINE);
    gd_mesh_release(mesh);
}

/* The mesh has more vertices than a slice. */
static void two_threads_move_vertices_to_the_same_places(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){120, 1}, NULL);
    const struct gd_smooth_options options = {3, GD_SMOOTH_TANGENTIAL, 0.5};
    const struct gd_control both = {.executor = &two_threads};
    struct gd_edited one, two;
    check_ok(gd_smooth_mesh(mesh, &options, NULL, &one, NULL), NULL);
    check_ok(gd_smooth_mesh(mesh, &options, &both, &two, NULL), NULL);
    uint32_t count = one.polygons.position_count;
    assert_int_equal(count, two.polygons.position_count);
    assert_memory_equal(one.polygons.positions, two.polygons.positions,
                        count * sizeof *one.polygons.positions);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(one.origins[i].face, two.origins[i].face);
        assert_memory_equal(one.origins[i].barycentric, two.origins[i].barycentric,
                            sizeof one.origins[i].barycentric);
    }
    gd_edited_free(&one);
    gd_edited_free(&two);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_reduced), cmocka_unit_test(planes_stay_planes),
        cmocka_unit_test(features_stay), cmocka_unit_test(bad_options_and_control),
        cmocka_unit_test(two_threads_move_vertices_to_the_same_places)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
