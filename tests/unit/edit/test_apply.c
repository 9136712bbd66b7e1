#include "edits.h"

static struct gd_edited applied(const struct gd_mesh *mesh, const struct gd_edit_step *items,
                                uint32_t count)
{
    struct gd_detail detail = {0};
    struct gd_edited edited;
    check_ok(gd_edit_apply(mesh, &(struct gd_edit_steps){.items = items, .count = count}, NULL,
                           &edited, &detail),
             &detail);
    return edited;
}

/* A single step gives the same result as a call of the edit itself. */
static void one_step(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){20, 0.4, 7}, NULL);
    const struct gd_edit_step step = {.kind = GD_EDIT_SIMPLIFY, .simplify = {.faces = 200}};
    struct gd_edited edited = applied(mesh, &step, 1), alone;
    check_ok(gd_simplify(mesh, &step.simplify, NULL, &alone, NULL), NULL);
    assert_true(edited_equal(&edited, &alone));
    gd_edited_free(&edited);
    gd_edited_free(&alone);
    gd_mesh_release(mesh);
}

/* Origins refer to the mesh before the first step. */
static void origins_go_back_to_the_first_mesh(void **state)
{
    (void)state;
    struct gd_mesh *mesh = separate_spheres((const double[]){1, 3}, 2);
    const struct gd_edit_step steps[] = {
        {.kind = GD_EDIT_COMPONENTS, .components = {.keep = 1}},
        {.kind = GD_EDIT_SUBDIVIDE, .subdivide = {GD_SUBDIVIDE_MIDPOINT, 2}},
        {.kind = GD_EDIT_SIMPLIFY, .simplify = {.faces = 300}}};
    struct gd_edited edited = applied(mesh, steps, 3);
    assert_int_equal(edited.polygons.polygon_count, 300);
    assert_true(farthest_origin(mesh, &edited) < 1e-12);
    for (uint32_t i = 0; i < edited.polygons.position_count; i++)
        assert_in_range(edited.origins[i].face, 80, 159);
    /* the first sphere is removed; the largest distance is the distance from its farthest point to
     * the other sphere */
    assert_true(edited.largest_distance > 6 && edited.largest_distance < 9);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

/* The distance is the same as that of gd_edit_deviation, which measures all faces. */
static void kept_faces_are_not_measured(void **state)
{
    (void)state;
    struct gd_mesh *tube = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 20, 4}, NULL),
                   *spheres = separate_spheres((const double[]){1, 3}, 2);
    const struct gd_edit_step fill = {.kind = GD_EDIT_FILL, .fill = {GD_FILL_EDGES}},
                              smooth = {.kind = GD_EDIT_SMOOTH, .smooth = {2, GD_SMOOTH_BOTH, 1}},
                              one = {.kind = GD_EDIT_COMPONENTS, .components = {.keep = 1}},
                              all = {.kind = GD_EDIT_COMPONENTS, .components = {.keep = 2}};
    const struct {
        const struct gd_mesh *mesh;
        struct gd_edit_step steps[2];
        uint32_t count;
        bool is_measured;
    } cases[] = {{tube, {fill}, 1, true},           {tube, {smooth, fill}, 2, true},
                 {tube, {fill, all}, 2, true},      {tube, {all, all}, 2, false},
                 {spheres, {one}, 1, true},         {spheres, {one, fill}, 2, true},
                 {spheres, {one, smooth}, 2, true}, {spheres, {all, fill}, 2, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct gd_edited edited = applied(cases[i].mesh, cases[i].steps, cases[i].count);
        double distance;
        check_ok(gd_edit_deviation(cases[i].mesh, &edited.polygons, NULL, &distance, NULL), NULL);
        assert_int_equal(edited.mesh != NULL, cases[i].is_measured);
        assert_true(edited.largest_distance == (cases[i].is_measured ? distance : 0));
        assert_true(distance < 1e-14 || cases[i].is_measured);
        if (edited.mesh)
            assert_int_equal(gd_mesh_summary(edited.mesh)->faces, edited.polygons.polygon_count);
        gd_edited_free(&edited);
    }
    gd_mesh_release(tube);
    gd_mesh_release(spheres);
}

static void steps_are_checked(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("tetrahedron", (double[SAMPLE_PARAMETERS]){1, 1}, NULL);
    struct gd_edit_step many[GD_EDIT_STEPS_MOST + 1] = {
        {.kind = GD_EDIT_SUBDIVIDE, .subdivide = {GD_SUBDIVIDE_LOOP, 0}}};
    const struct gd_edit_step unknown = {.kind = (enum gd_edit_kind)99};
    const struct gd_edit_steps bad[] = {{.items = many, .count = 0},
                                        {.items = many, .count = GD_EDIT_STEPS_MOST + 1},
                                        {.items = many, .count = 1},
                                        {.items = &unknown, .count = 1}};
    struct gd_edited edited = {.bytes = 7};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct gd_detail detail = {0};
        assert_int_equal(gd_edit_apply(mesh, &bad[i], NULL, &edited, &detail), GD_INVALID_ARGUMENT);
        assert_true(detail.text[0]);
        assert_int_equal(edited.bytes, 7);
    }
    gd_mesh_release(mesh);
}

static void budget_deadline_and_cancel(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 20, 4}, NULL);
    const struct gd_edit_step items[] = {{.kind = GD_EDIT_FILL, .fill = {GD_FILL_EDGES}},
                                         {.kind = GD_EDIT_SMOOTH, .smooth = {2, GD_SMOOTH_BOTH, 1}},
                                         {.kind = GD_EDIT_SIMPLIFY, .simplify = {.faces = 100}}};
    const struct gd_edit_steps steps = {.items = items, .count = 3};
    const struct gd_control small = {.budget_bytes = 1000}, late = {.deadline_ns = 1};
    struct gd_edited edited;
    assert_int_equal(gd_edit_apply(mesh, &steps, &small, &edited, NULL), GD_BUDGET);
    assert_int_equal(gd_edit_apply(mesh, &steps, &late, &edited, NULL), GD_DEADLINE);
    enum gd_status status = GD_CANCELLED;
    for (uint32_t calls = 1; status == GD_CANCELLED; calls += 3) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        status = gd_edit_apply(mesh, &steps, &control, &edited, NULL);
        assert_true(status == GD_OK || (status == GD_CANCELLED && watch.calls == calls));
    }
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_step),
        cmocka_unit_test(origins_go_back_to_the_first_mesh),
        cmocka_unit_test(kept_faces_are_not_measured),
        cmocka_unit_test(steps_are_checked),
        cmocka_unit_test(budget_deadline_and_cancel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
