#include "gd/landmarks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "query/landmarks.h"
#include "wedge/workspace.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_mesh *terrain(uint64_t seed)
{
    struct gd_polygons polygons;
    check_ok(sample_terrain(16, 0.5, seed, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static struct gd_point vertex(const struct gd_mesh *mesh, uint32_t index)
{
    struct gd_point point;
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){index}, &point, NULL), NULL);
    return point;
}

/* Lower bounds are no longer, upper bounds no shorter than the distance, and most landmarks' bounds beat the straight line's. */
static void bounds_hold(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(5);
    struct gd_landmarks *landmarks;
    check_ok(gd_landmarks_build(mesh, 8, NULL, &landmarks), NULL);
    assert_int_equal(gd_landmarks_count(landmarks), 8);
    struct gd_point from = vertex(mesh, 0), to = vertex(mesh, 200);
    struct gd_seed seed = {.point = to};
    struct gd_field *field;
    check_ok(
        gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL, NULL, &field, NULL),
        NULL);
    struct gd__guide plain = {0}, guide = {0};
    double upper, better = 0;
    gd__landmarks_offer(landmarks, mesh, &guide);
    check_ok(gd__guide_aim(&plain, mesh, &from, &to, &upper), NULL);
    check_ok(gd__guide_aim(&guide, mesh, &from, &to, &upper), NULL);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        struct gd_point point = {.kind = GD_POINT_VERTEX, .element = v};
        double exact;
        check_ok(gd_field_distance(field, &point, &exact), NULL);
        exact /= mesh->unit;
        assert_true(gd__guide_lower(&plain, v) <= exact && gd__guide_lower(&guide, v) <= exact);
        assert_true(gd__guide_lower(&guide, v) >= gd__guide_lower(&plain, v));
        assert_true(guide.node[v].upper >= exact * (1 - 1e-14));
        better += gd__guide_lower(&guide, v) > gd__guide_lower(&plain, v) * 1.001;
    }
    assert_true(better > 0.3 * mesh->vertex_count);
    gd__guide_clean(&guide);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        assert_true(guide.node[v].upper >= GD__FAR && guide.node[v].lower < 0 && !guide.node[v].in_corridor &&
                    !guide.node[v].touched);
    gd__guide_destroy(&plain);
    gd__guide_destroy(&guide);
    gd_field_release(field);
    gd_landmarks_release(landmarks);
    gd_mesh_release(mesh);
}

static void survive_being_stored(void **state)
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
    float bad = -1;
    memcpy(bytes + size - sizeof bad, &bad, sizeof bad);
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

static bool never(void *user, double fraction)
{
    (void)user;
    (void)fraction;
    return false;
}

/* Reports go up, from landmark to landmark. */
static bool watch(void *user, double fraction)
{
    double *last = user;
    assert_true(fraction >= *last && fraction <= 1);
    *last = fraction;
    return true;
}

static void progress_goes_up(void **state)
{
    (void)state;
    struct gd_mesh *mesh = terrain(5);
    struct gd_landmarks *landmarks;
    double last = 0;
    struct gd_control control = {.progress = watch, .user = &last};
    check_ok(gd_landmarks_build(mesh, 6, &control, &landmarks), NULL);
    assert_true(last > 0.8);
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
    struct gd_control cancel = {.progress = never}, poor = {.budget_bytes = 1000}, late = {.deadline_ns = 1};
    assert_int_equal(gd_landmarks_build(mesh, 0, NULL, &landmarks), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_landmarks_build(mesh, 17, NULL, &landmarks), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_landmarks_build(mesh, 4, &cancel, &landmarks), GD_CANCELLED);
    assert_int_equal(gd_landmarks_build(mesh, 4, &poor, &landmarks), GD_BUDGET);
    assert_int_equal(gd_landmarks_build(mesh, 4, &late, &landmarks), GD_DEADLINE);
    assert_null(landmarks);
    gd_landmarks_release(NULL);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_hold), cmocka_unit_test(survive_being_stored),
                                       cmocka_unit_test(refusals), cmocka_unit_test(progress_goes_up)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
