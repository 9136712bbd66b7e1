#include "edits.h"

static struct gd_edited simplified(const struct gd_mesh *mesh, struct gd_simplify_options options)
{
    struct gd_edited edited;
    struct gd_detail detail = {0};
    check_ok(gd_simplify(mesh, &options, NULL, &edited, &detail), &detail);
    return edited;
}

/* Checks the properties that every request must have. Returns the result as a mesh. */
static struct gd_mesh *check_simplified(const struct gd_mesh *mesh, const struct gd_edited *edited)
{
    const struct gd_mesh_summary *before = gd_mesh_summary(mesh);
    struct gd_mesh *made = test_mesh(&edited->polygons);
    const struct gd_mesh_summary *after = gd_mesh_summary(made);
    assert_int_equal(after->euler_characteristic, before->euler_characteristic);
    assert_int_equal(after->boundaries, before->boundaries);
    assert_int_equal(after->components, before->components);
    assert_int_equal(after->unreferenced_vertices, 0);
    assert_int_equal(after->flipped_faces, 0);
    assert_true(after->degenerate_faces <= before->degenerate_faces);
    assert_true(farthest_origin(mesh, edited) == 0);
    double farthest = farthest_vertex(mesh, made);
    assert_true(edited->largest_distance >= farthest * (1 - 1e-9));
    assert_true(edited->largest_distance <= 0.5 * box_diagonal(mesh));
    return made;
}

static void check_sample(const char *name, const double *values, uint32_t faces)
{
    struct gd_mesh *mesh = test_sample(name, values, NULL);
    struct gd_edited edited = simplified(mesh, (struct gd_simplify_options){.faces = faces});
    struct gd_mesh *made = check_simplified(mesh, &edited);
    assert_in_range(gd_mesh_summary(made)->faces, faces - 1, faces);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void topology_and_origins_are_kept(void **state)
{
    (void)state;
    check_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, 500);
    check_sample("torus", (double[SAMPLE_PARAMETERS]){64, 32, 1, 0.4}, 300);
    check_sample("grid", (double[SAMPLE_PARAMETERS]){40, 30, 4, 3}, 100);
    check_sample("terrain", (double[SAMPLE_PARAMETERS]){40, 0.4, 7}, 700);
}

/* Compares the distance with a closed form: with four times as many faces, a simplified sphere has
 * a quarter of the distance. A flat mesh has distance 0. */
static void the_distance_is_that_of_the_surface(void **state)
{
    (void)state;
    struct gd_mesh *sphere = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, NULL);
    double before = INFINITY;
    for (uint32_t faces = 100; faces <= 1600; faces *= 4) {
        struct gd_edited edited = simplified(sphere, (struct gd_simplify_options){.faces = faces});
        /* the limit is four times the sagitta of an equilateral triangle of that area, because the
           triangles are irregular */
        double area = 4 * acos(-1) / faces;
        assert_true(edited.largest_distance <= 4 * (4 * area / (3 * sqrt(3))) / 2);
        assert_true(edited.largest_distance < before / 2);
        before = edited.largest_distance;
        gd_edited_free(&edited);
    }
    gd_mesh_release(sphere);
    struct gd_mesh *flat = test_sample("grid", (double[SAMPLE_PARAMETERS]){30, 30, 3, 3}, NULL);
    struct gd_edited edited = simplified(flat, (struct gd_simplify_options){.faces = 60});
    assert_true(edited.largest_distance < 1e-14);
    gd_edited_free(&edited);
    gd_mesh_release(flat);
}

static void a_bound_of_the_distance_holds(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){30, 0.4, 7}, NULL);
    uint32_t before = gd_mesh_summary(mesh)->faces;
    for (double bound = 1e-3; bound < 0.1; bound *= 5) {
        struct gd_edited edited =
            simplified(mesh, (struct gd_simplify_options){.max_distance = bound});
        gd_mesh_release(check_simplified(mesh, &edited));
        assert_true(edited.largest_distance <= bound);
        assert_true(edited.polygons.polygon_count < before);
        before = edited.polygons.polygon_count;
        gd_edited_free(&edited);
    }
    gd_mesh_release(mesh);
}

/* Tests a cylinder that is pressed flat. Its faces and rims lie in one plane, so the quadrics
 * measure no error. */
static void a_bound_holds_at_folds(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    gd_mesh_release(test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 24, 6}, &polygons));
    for (uint32_t i = 0; i < polygons.position_count; i++) polygons.positions[i][1] *= 1e-9;
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_edited edited = simplified(mesh, (struct gd_simplify_options){.max_distance = 1e-3});
    assert_true(edited.largest_distance <= 1e-3);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void the_boundary_stays(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){30, 0.4, 7}, NULL);
    struct gd_edited edited =
        simplified(mesh, (struct gd_simplify_options){.faces = 400, .keep_boundary = true});
    struct gd_mesh *made = check_simplified(mesh, &edited);
    struct gd_boundary before = gd_mesh_boundary(mesh, 0), after = gd_mesh_boundary(made, 0);
    assert_int_equal(after.vertices, before.vertices);
    check_close(after.length, before.length, 1e-14);
    assert_true(edited.polygons.polygon_count < gd_mesh_summary(mesh)->faces / 2);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

/* Simplification keeps the fan of a vertex with very many faces. Each collapse at this vertex would
 * visit the whole fan once for each neighbour. */
static void a_large_fan_is_kept(void **state)
{
    (void)state;
    double sides = 20000.0 / TEST_STRIDE;
    struct gd_mesh *mesh = test_sample("cone", (double[SAMPLE_PARAMETERS]){1, 1, sides, 1}, NULL);
    struct gd_edited edited = simplified(mesh, (struct gd_simplify_options){.faces = 100});
    assert_int_equal(edited.polygons.polygon_count, gd_mesh_summary(mesh)->faces);
    assert_true(edited.largest_distance < 1e-14);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void the_same_input_gives_the_same_result(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("torus", (double[SAMPLE_PARAMETERS]){48, 24, 1, 0.4}, NULL);
    const struct gd_simplify_options options = {.faces = 500};
    struct gd_edited a = simplified(mesh, options), b = simplified(mesh, options);
    assert_true(edited_equal(&a, &b));
    gd_edited_free(&a);
    gd_edited_free(&b);
    gd_mesh_release(mesh);
}

static void scale_and_place_do_not_matter(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh =
        test_sample("torus", (double[SAMPLE_PARAMETERS]){32, 16, 1, 0.4}, &polygons);
    const struct gd_simplify_options options = {.faces = 300};
    struct gd_edited near = simplified(mesh, options);
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        for (int k = 0; k < 3; k++) polygons.positions[i][k] *= 0x1p100;
    }
    struct gd_mesh *large = test_mesh(&polygons);
    struct gd_edited far = simplified(large, options);
    assert_memory_equal(near.polygons.corners, far.polygons.corners,
                        3 * near.polygons.polygon_count * sizeof *near.polygons.corners);
    check_close(far.largest_distance, near.largest_distance * 0x1p100, 1e-12);
    gd_edited_free(&near);
    gd_edited_free(&far);
    gd_mesh_release(large);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("tetrahedron", (double[SAMPLE_PARAMETERS]){1, 1}, NULL);
    const struct gd_simplify_options bad[] = {
        {0}, {.max_distance = -1}, {.max_distance = NAN}, {.faces = 4, .max_distance = INFINITY}};
    struct gd_edited edited = {.bytes = 7};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct gd_detail detail = {0};
        assert_int_equal(gd_simplify(mesh, &bad[i], NULL, &edited, &detail), GD_INVALID_ARGUMENT);
        assert_true(detail.text[0]);
        assert_int_equal(edited.bytes, 7);
    }
    gd_mesh_release(mesh);
}

static void budget_deadline_and_cancel(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){3, 1}, NULL);
    const struct gd_simplify_options options = {.faces = 300};
    struct gd_edited edited;
    const struct gd_control small = {.budget_bytes = 1000}, late = {.deadline_ns = 1};
    assert_int_equal(gd_simplify(mesh, &options, &small, &edited, NULL), GD_BUDGET);
    assert_int_equal(gd_simplify(mesh, &options, &late, &edited, NULL), GD_DEADLINE);
    enum gd_status status = GD_CANCELLED;
    for (uint32_t calls = 1; status == GD_CANCELLED; calls += 7 * TEST_STRIDE) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        status = gd_simplify(mesh, &options, &control, &edited, NULL);
        assert_true(status == GD_OK || status == GD_CANCELLED);
        if (status) assert_int_equal(watch.calls, calls);
    }
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void the_control_is_checked_often(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){5, 1}, NULL);
    const struct gd_simplify_options options = {.faces = 5000};
    struct looks looks = {0};
    const struct gd_control control = {.progress = look, .user = &looks};
    struct gd_edited edited;
    check_ok(gd_simplify(mesh, &options, &control, &edited, NULL), NULL);
    assert_true(looks.longest < 50000000);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(topology_and_origins_are_kept),
        cmocka_unit_test(the_distance_is_that_of_the_surface),
        cmocka_unit_test(a_bound_of_the_distance_holds),
        cmocka_unit_test(a_bound_holds_at_folds),
        cmocka_unit_test(the_boundary_stays),
        cmocka_unit_test(a_large_fan_is_kept),
        cmocka_unit_test(the_same_input_gives_the_same_result),
        cmocka_unit_test(scale_and_place_do_not_matter),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(budget_deadline_and_cancel),
        cmocka_unit_test(the_control_is_checked_often),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
