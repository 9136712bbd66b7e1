#include "edits.h"

static struct gd_edited subdivided(const struct gd_mesh *mesh, enum gd_subdivide_scheme scheme,
                                   uint32_t levels)
{
    const struct gd_edit_step step = {.kind = GD_EDIT_SUBDIVIDE, .subdivide = {scheme, levels}};
    struct gd_edited edited;
    struct gd_detail detail = {0};
    check_ok(gd_edit_apply(mesh, &(struct gd_edit_steps){.items = &step, .count = 1}, NULL, &edited,
                           &detail),
             &detail);
    return edited;
}

static void check_topology(const struct gd_mesh *mesh, const struct gd_mesh *made, uint32_t factor)
{
    const struct gd_mesh_summary *before = gd_mesh_summary(mesh), *after = gd_mesh_summary(made);
    assert_int_equal(after->faces, factor * before->faces);
    assert_int_equal(after->euler_characteristic, before->euler_characteristic);
    assert_int_equal(after->boundaries, before->boundaries);
    assert_int_equal(after->flipped_faces, 0);
}

static void midpoints_keep_the_surface(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){8, 0.4, 7}, NULL);
    struct gd_edited edited = subdivided(mesh, GD_SUBDIVIDE_MIDPOINT, 2);
    struct gd_mesh *made = test_mesh(&edited.polygons);
    check_topology(mesh, made, 16);
    check_close(gd_mesh_summary(made)->area, gd_mesh_summary(mesh)->area, 1e-12);
    assert_true(edited.largest_distance < 1e-14);
    assert_true(farthest_origin(mesh, &edited) < 1e-14);
    gd_mesh_release(made);
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void the_schemes_keep_topology_and_planes(void **state)
{
    (void)state;
    for (int scheme = GD_SUBDIVIDE_LOOP; scheme <= GD_SUBDIVIDE_SQRT3; scheme++) {
        uint32_t factor = scheme == GD_SUBDIVIDE_SQRT3 ? 9 : 16;
        struct gd_mesh *torus =
            test_sample("torus", (double[SAMPLE_PARAMETERS]){16, 8, 1, 0.4}, NULL);
        struct gd_edited edited = subdivided(torus, (enum gd_subdivide_scheme)scheme, 2);
        struct gd_mesh *made = test_mesh(&edited.polygons);
        check_topology(torus, made, factor);
        assert_true(gd_mesh_summary(made)->area < gd_mesh_summary(torus)->area);
        assert_true(farthest_origin(torus, &edited) <= edited.largest_distance * (1 + 1e-9) + 0.1);
        gd_mesh_release(made);
        gd_edited_free(&edited);
        gd_mesh_release(torus);
        struct gd_mesh *grid = test_sample("grid", (double[SAMPLE_PARAMETERS]){5, 4, 5, 4}, NULL);
        edited = subdivided(grid, (enum gd_subdivide_scheme)scheme, 2);
        made = test_mesh(&edited.polygons);
        check_topology(grid, made, factor);
        for (uint32_t i = 0; i < edited.polygons.position_count; i++)
            assert_true(edited.polygons.positions[i][2] == 0);
        gd_mesh_release(made);
        gd_edited_free(&edited);
        gd_mesh_release(grid);
    }
}

/* Closed form: one step of Loop moves a vertex v of a regular tetrahedron about the origin to 7/16
 * v plus 3/16 of each neighbour. The neighbours sum to -v, hence the result is v/4. */
static void loop_of_a_tetrahedron(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("tetrahedron", (double[SAMPLE_PARAMETERS]){1, 0}, NULL);
    struct gd_edited edited = subdivided(mesh, GD_SUBDIVIDE_LOOP, 1);
    struct gd_vec3 sum = {0};
    for (uint32_t i = 0; i < 4; i++)
        sum = gd_vec3_add(sum, gd_mesh_position(mesh, (struct gd_vertex){i}));
    struct gd_vec3 centre = gd_vec3_scale(sum, 0.25);
    for (uint32_t i = 0; i < 4; i++) {
        double before = gd_vec3_distance(gd_mesh_position(mesh, (struct gd_vertex){i}), centre);
        check_close(gd_vec3_distance(position_at(&edited.polygons, i), centre), before / 4, 1e-12);
    }
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

static void bad_levels_and_control(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, NULL);
    struct gd_edited edited;
    for (uint32_t levels = 0; levels < 8; levels += 7) {
        const struct gd_edit_step step = {.kind = GD_EDIT_SUBDIVIDE, .subdivide.levels = levels};
        assert_int_equal(gd_edit_apply(mesh, &(struct gd_edit_steps){.items = &step, .count = 1},
                                       NULL, &edited, NULL),
                         GD_INVALID_ARGUMENT);
    }
    const struct gd_edit_step step = {.kind = GD_EDIT_SUBDIVIDE, .subdivide.levels = 2};
    enum gd_status status = GD_CANCELLED;
    for (uint32_t calls = 1; status == GD_CANCELLED; calls = 2 * calls + 1) {
        struct test_watch watch = {.most = calls};
        const struct gd_control control = {.progress = test_watch, .user = &watch};
        status = gd_edit_apply(mesh, &(struct gd_edit_steps){.items = &step, .count = 1}, &control,
                               &edited, NULL);
        assert_true(status == GD_OK || status == GD_CANCELLED);
    }
    gd_edited_free(&edited);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(midpoints_keep_the_surface),
                                       cmocka_unit_test(the_schemes_keep_topology_and_planes),
                                       cmocka_unit_test(loop_of_a_tetrahedron),
                                       cmocka_unit_test(bad_levels_and_control)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
