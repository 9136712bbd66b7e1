#include "gd/landmarks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "query/landmarks.h"
#include "wavefront/workspace.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"
#include "tests/support/test.h"
#include "tests/support/field.h"
#include "tests/support/watch.h"

#define LANDMARKS 4
#define ROUNDING  1e-14

static struct gd_mesh *terrain(uint64_t seed)
{
    struct gd_polygons polygons;
    check_ok(sample_terrain(16, 0.5, seed, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* Computes bounds of the distances to `target` with and without landmarks, and checks them at all
 * vertices. Returns the number of vertices at which landmarks give better bounds. */
static uint32_t check_bounds(const struct gd_mesh *mesh, const struct gd_landmarks *landmarks,
                             uint32_t target)
{
    struct gd_point from = test_vertex(mesh, 0), to = {.kind = GD_POINT_VERTEX, .element = target};
    struct gd_field *field = test_field_from(mesh, to);
    struct gd__guide plain = {0}, guide = {0};
    double upper;
    uint32_t better = 0;
    gd__landmarks_offer(landmarks, mesh, &guide);
    check_ok(gd__guide_aim(&plain, mesh, &from, &to, NULL, &upper), NULL);
    check_ok(gd__guide_aim(&guide, mesh, &from, &to, NULL, &upper), NULL);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        struct gd_point point = {.kind = GD_POINT_VERTEX, .element = v};
        double exact, by_line = gd__guide_lower(&plain, v),
                      by_landmarks = gd__guide_lower(&guide, v);
        check_ok(gd_field_distance(field, &point, &exact), NULL);
        exact /= mesh->unit;
        if (!isfinite(exact)) continue;
        assert_true(by_line <= exact && by_line <= by_landmarks &&
                    by_landmarks <= exact * (1 + ROUNDING));
        assert_true(guide.node[v].upper >= exact * (1 - ROUNDING));
        better += by_landmarks > by_line * 1.001;
    }
    gd__guide_destroy(&plain);
    gd__guide_destroy(&guide);
    gd_field_release(field);
    return better;
}

/* Lower bounds do not exceed the distance, and upper bounds are not below it. Lower bounds by
 * landmarks are often better than the straight line's length. Some targets are landmarks. For these
 * targets, bounds differ from the distance only by a few steps. */
static void check_all_bounds(uint64_t seed)
{
    struct gd_mesh *mesh = terrain(seed);
    struct gd_landmarks *landmarks;
    check_ok(gd_landmarks_build(mesh, LANDMARKS, NULL, &landmarks), NULL);
    assert_int_equal(gd_landmarks_count(landmarks), LANDMARKS);
    struct gd__guide guide = {0};
    gd__landmarks_offer(landmarks, mesh, &guide);
    uint64_t better = 0, asked = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        bool is_landmark = false;
        for (uint32_t i = 0; i < LANDMARKS; i++)
            is_landmark |= guide.landmark[(size_t)GD__LANDMARKS_MOST * v + i] == 0;
        if (!is_landmark && v % 2) continue;
        better += check_bounds(mesh, landmarks, v);
        asked += mesh->vertex_count;
    }
    print_message("# %llu bounds, %llu of them by landmarks\n", (unsigned long long)asked,
                  (unsigned long long)better);
    assert_true(better > 0.3 * (double)asked);
    gd_landmarks_release(landmarks);
    gd_mesh_release(mesh);
}

static void distances_lie_within_the_bounds(void **state)
{
    (void)state;
    check_all_bounds(5);
    check_all_bounds(11);
}

/* In a plane, bounds by landmarks are as large as the distance, except for the steps. So a bound
 * that is not rounded down is too large. The second component is larger than the first, so its
 * landmarks enlarge the step. */
static void bounds_are_rounded_down(void **state)
{
    (void)state;
    struct gd_polygons polygons, large;
    check_ok(sample_grid(9, 7, 1, 1.1, &polygons), NULL);
    check_ok(sample_grid(5, 5, 7, 7, &large), NULL);
    check_ok(sample_append(&polygons, &large), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_landmarks *landmarks;
    check_ok(gd_landmarks_build(mesh, 8, NULL, &landmarks), NULL);
    uint32_t component = mesh->vertex_component[test_vertex(mesh, 0).element];
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->vertex_component[v] == component) check_bounds(mesh, landmarks, v);
    gd_landmarks_release(landmarks);
    gd_mesh_release(mesh);
    gd_polygons_free(&large);
    gd_polygons_free(&polygons);
}

static void images_are_read_back(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(5), *other = terrain(6);
    struct gd_landmarks *landmarks, *back = NULL;
    check_ok(gd_landmarks_build(mesh, 3, NULL, &landmarks), NULL);
    size_t size = gd_landmarks_image_size(landmarks);
    char *bytes = malloc(size);
    gd_landmarks_write_image(landmarks, bytes);
    check_ok(gd_landmarks_open_image(mesh, bytes, size, &back), NULL);
    assert_int_equal(gd_landmarks_count(back), 3);
    char *again = malloc(size);
    assert_int_equal(gd_landmarks_image_size(back), size);
    gd_landmarks_write_image(back, again);
    assert_memory_equal(bytes, again, size);
    struct gd_landmarks *none = NULL;
    assert_int_equal(gd_landmarks_open_image(other, bytes, size, &none), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_landmarks_open_image(mesh, bytes, size - 1, &none), GD_TRUNCATED);
    assert_int_equal(gd_landmarks_open_image(mesh, bytes, 3, &none), GD_TRUNCATED);
    /* the step is before the distances */
    double bad = -1;
    size_t distances = sizeof(uint16_t) * GD__LANDMARKS_MOST * mesh->vertex_count;
    memcpy(bytes + size - distances - sizeof bad, &bad, sizeof bad);
    assert_int_equal(gd_landmarks_open_image(mesh, bytes, size, &none), GD_NON_FINITE);
    bytes[0] ^= 1;
    assert_int_equal(gd_landmarks_open_image(mesh, bytes, size, &none), GD_UNRECOGNIZED);
    assert_null(none);
    free(again);
    free(bytes);
    gd_landmarks_release(landmarks);
    gd_landmarks_release(back);
    gd_mesh_release(mesh);
    gd_mesh_release(other);
}

static void progress_increases(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(5);
    struct gd_landmarks *landmarks;
    struct test_watch watch = {0};
    struct gd_control control = {.progress = test_watch, .user = &watch};
    check_ok(gd_landmarks_build(mesh, 6, &control, &landmarks), NULL);
    assert_true(watch.last > 0.8);
    size_t held = gd_landmarks_memsize(landmarks);
    gd_landmarks_release(landmarks);
    control = (struct gd_control){.budget_bytes = held};
    assert_int_equal(gd_landmarks_build(mesh, 6, &control, &landmarks), GD_BUDGET);
    gd_mesh_release(mesh);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(5);
    struct gd_landmarks *landmarks = NULL;
    struct gd_control cancel = {.progress = test_cancel}, poor = {.budget_bytes = 1000},
                      late = {.deadline_ns = 1};
    assert_int_equal(gd_landmarks_build(mesh, 0, NULL, &landmarks), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_landmarks_build(mesh, 33, NULL, &landmarks), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_landmarks_build(mesh, 4, &cancel, &landmarks), GD_CANCELLED);
    assert_int_equal(gd_landmarks_build(mesh, 4, &poor, &landmarks), GD_BUDGET);
    assert_int_equal(gd_landmarks_build(mesh, 4, &late, &landmarks), GD_DEADLINE);
    assert_null(landmarks);
    gd_landmarks_release(NULL);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_lie_within_the_bounds),
        cmocka_unit_test(bounds_are_rounded_down), cmocka_unit_test(images_are_read_back),
        cmocka_unit_test(refusals), cmocka_unit_test(progress_increases)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
