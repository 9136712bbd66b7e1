#include "edits.h"

static struct gd_edited whole(const struct gd_mesh *mesh, const struct gd_edit_step *step)
{
    struct gd_detail detail = {0};
    struct gd_edited edited;
    check_ok(gd_edit_apply(mesh, &(struct gd_edit_steps){.items = step, .count = 1}, NULL, &edited,
                           &detail),
             &detail);
    return edited;
}

/* Each part equals the result of gd_components for this part. Each part reports the distance of the
 * whole edit. */
static void parts_are_components(void **state)
{
    (void)state;
    struct gd_mesh *mesh = separate_spheres((const double[]){1, 3, 2, 3}, 4);
    struct gd_edited edited =
        whole(mesh, &(struct gd_edit_step){.kind = GD_EDIT_SIMPLIFY, .simplify = {.faces = 200}});
    struct gd_mesh *made = test_mesh(&edited.polygons);
    struct gd_edited_parts parts;
    check_ok(gd_edited_split(&edited, 4, NULL, &parts, NULL), NULL);
    assert_int_equal(parts.count, 4);
    size_t bytes = 0;
    for (uint32_t i = 0; i < parts.count; i++) {
        struct gd_edited *part = &parts.items[i], alone;
        const struct gd_components_options options = {1, i};
        check_ok(gd_components(made, &options, NULL, &alone, NULL), NULL);
        assert_true(part->largest_distance == edited.largest_distance);
        alone.largest_distance = part->largest_distance;
        assert_true(edited_equal(part, &alone));
        assert_true(farthest_origin(mesh, part) == 0);
        bytes += part->bytes;
        gd_edited_free(&alone);
    }
    assert_int_equal(parts.bytes, bytes);
    gd_edited_parts_free(&parts);
    gd_edited_free(&edited);
    gd_mesh_release(made);
    gd_mesh_release(mesh);
}

static void the_number_is_bounded(void **state)
{
    (void)state;
    struct gd_mesh *mesh = separate_spheres((const double[]){1, 2, 3}, 3);
    struct gd_edited edited =
        whole(mesh, &(struct gd_edit_step){.kind = GD_EDIT_COMPONENTS, .components = {.keep = 3}});
    struct gd_edited_parts parts = {.bytes = 7};
    struct gd_detail detail = {0};
    const struct gd_control late = {.deadline_ns = 1};
    assert_int_equal(gd_edited_split(&edited, 2, NULL, &parts, &detail), GD_TOO_LARGE);
    assert_string_equal(detail.text,
                        "there are 3 components, and at most 2 become meshes at a time");
    assert_int_equal(parts.bytes, 7);
    /* the call ends before a check */
    check_ok(gd_edited_split(&edited, 3, &late, &parts, NULL), NULL);
    gd_edited_parts_free(&parts);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void it_can_be_cancelled(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){6, 1}, NULL);
    struct gd_edited edited =
        whole(mesh, &(struct gd_edit_step){.kind = GD_EDIT_COMPONENTS, .components = {.keep = 1}});
    struct gd_edited_parts parts;
    enum gd_status status = GD_CANCELLED;
    for (uint32_t calls = 1; status == GD_CANCELLED; calls++) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        status = gd_edited_split(&edited, 1, &control, &parts, NULL);
        assert_true(status == GD_OK || (status == GD_CANCELLED && watch.calls == calls));
    }
    assert_int_equal(parts.count, 1);
    gd_edited_parts_free(&parts);
    gd_edited_parts_free(NULL);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_components),
        cmocka_unit_test(the_number_is_bounded),
        cmocka_unit_test(it_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
