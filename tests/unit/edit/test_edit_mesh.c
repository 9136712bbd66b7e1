/* Tests the boundary between the engine and OpenMesh: copies, results, checks and exceptions. */
#include "edits.h"

#include "edit_mesh_laws.h"

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} meshes[] = {
    {"tetrahedron", {1, 1}},   {"icosphere", {3, 1}},    {"torus", {24, 12, 1, 0.4}},
    {"genus2", {4, 0.02}},     {"grid", {20, 15, 4, 3}}, {"cylinder", {1, 2, 24, 6}},
    {"obstacles", {20, 1, 7}}, {"cone", {1, 1, 300, 1}},
};

typedef const char *law(const struct gd_mesh *mesh, const struct gd_polygons *polygons);

static void check_all(law *check)
{
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        struct gd_polygons polygons;
        struct gd_mesh *mesh = test_sample(meshes[i].name, meshes[i].values, &polygons);
        const char *broken = check(mesh, &polygons);
        if (broken) fail_msg("%s: %s", meshes[i].name, broken);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static void a_copy_is_the_mesh(void **state)
{
    (void)state;
    check_all(edit_mesh_check_copy);
}

static void remaining_faces_keep_order_and_positions(void **state)
{
    (void)state;
    check_all(edit_mesh_check_rest);
}

static void a_copy_can_be_stopped_at_each_check(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){4, 1}, NULL);
    const char *broken = edit_mesh_check_stop(mesh);
    if (broken) fail_msg("%s", broken);
    gd_mesh_release(mesh);
}

static void exceptions_become_statuses(void **state)
{
    (void)state;
    const char *broken = edit_mesh_check_guard();
    if (broken) fail_msg("%s", broken);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_copy_is_the_mesh),
        cmocka_unit_test(remaining_faces_keep_order_and_positions),
        cmocka_unit_test(a_copy_can_be_stopped_at_each_check),
        cmocka_unit_test(exceptions_become_statuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
