/* Scenes: the nodes of the file, and the control. The positions are compared by
 * tests/api/test_figures.py. */
#include <stdlib.h>
#include <string.h>

#include "gd/picture.h"
#include "tests/support/test.h"
#include "tests/support/watch.h"

struct flat {
    struct gd_mesh *mesh;
    struct gd_field *field;
};

/* A square with the distances from its first corner. */
static struct flat open_flat(void)
{
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 0, 2, 3};
    struct flat flat = {.mesh = test_mesh(&(struct gd_polygons){positions, 4, 2, corners, NULL})};
    struct gd_seed seed = {.point = test_vertex(flat.mesh, 0)};
    check_ok(gd_field_build(flat.mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                            NULL, &flat.field, NULL),
             NULL);
    return flat;
}

static void close_flat(struct flat *flat)
{
    gd_field_release(flat->field);
    gd_mesh_release(flat->mesh);
}

static enum gd_status status_of(const struct gd_picture *picture, const struct gd_control *control)
{
    void *bytes = NULL;
    size_t size;
    enum gd_status status = gd_picture_glb(picture, control, &bytes, &size);
    free(bytes);
    return status;
}

static bool has(const char *bytes, size_t size, const char *text)
{
    return memmem(bytes, size, text, strlen(text)) != NULL;
}

static void layers_are_nodes(void **state)
{
    (void)state;
    struct flat flat = open_flat();
    const struct gd_vec3 points[] = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}};
    const struct gd_picture_layer layers[] = {
        {.points = points, .first = (const uint32_t[]){0, 2, 3}, .count = 2, .id = 7, .name = "l"},
        {.points = points, .first = (const uint32_t[]){0, 1}, .count = 1, .id = 8},
        {.points = points, .count = 2, .labels = (const char *const[]){NULL, "a\"b"}, .id = 9}};
    const struct gd_picture picture = {
        .mesh = flat.mesh, .field = flat.field, .isolines = 4, .layers = layers, .layer_count = 3};
    void *file;
    size_t size;
    check_ok(gd_picture_glb(&picture, NULL, &file, &size), NULL);
    assert_memory_equal(file, "glTF\2\0\0", 8);
    assert_true(has(file, size, "\"name\":\"isolines\"") && has(file, size, "_DISTANCE"));
    assert_true(has(file, size, "\"name\":\"layer-7\"") && has(file, size, "{\"label\":\"l\"}"));
    assert_false(has(file, size, "layer-8")); /* its only line is a point */
    assert_true(has(file, size, "\"name\":\"layer-9\""));
    assert_true(has(file, size, "\"labels\":[null,\"a\\\"b\"]"));
    free(file);
    close_flat(&flat);
}

static void the_control_is_checked(void **state)
{
    (void)state;
    struct flat flat = open_flat();
    struct test_watch watch = {0};
    const struct gd_picture picture = {.mesh = flat.mesh, .field = flat.field, .isolines = 10};
    assert_int_equal(
        status_of(&picture, &(struct gd_control){.progress = test_watch, .user = &watch}), GD_OK);
    assert_true(watch.calls > 10);
    for (uint32_t most = 1; most < watch.calls; most++) {
        struct test_watch again = {.most = most};
        assert_int_equal(
            status_of(&picture, &(struct gd_control){.progress = test_watch, .user = &again}),
            GD_CANCELLED);
    }
    assert_int_equal(status_of(&picture, &(struct gd_control){.deadline_ns = 1}), GD_DEADLINE);
    assert_int_equal(status_of(&picture, &(struct gd_control){.budget_bytes = 1 << 10}), GD_BUDGET);
    assert_int_equal(status_of(&picture, &(struct gd_control){.budget_bytes = 64 << 20}), GD_OK);
    close_flat(&flat);
}

static void invalid_scenes_are_refused(void **state)
{
    (void)state;
    struct flat flat = open_flat(), other = open_flat();
    assert_int_equal(status_of(&(struct gd_picture){.mesh = flat.mesh, .field = other.field}, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(status_of(&(struct gd_picture){.mesh = flat.mesh, .zoom = 0.5}, NULL),
                     GD_INVALID_ARGUMENT);
    close_flat(&flat);
    close_flat(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(layers_are_nodes),
                                       cmocka_unit_test(the_control_is_checked),
                                       cmocka_unit_test(invalid_scenes_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
