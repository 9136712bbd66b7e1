/* Tests propagation that keeps records only near the front. It computes the same distances as a
 * field in a fraction of the field's memory. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "gd/workspace.h"
#include "tests/samples/samples.h"

/* Returns the largest relative difference between a field's distances and
 * gd_field_distances_only. */
static double difference(const struct gd_mesh *mesh, const struct gd_field_request *request,
                         const struct gd_control *control)
{
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    double *kept = malloc(sizeof *kept * count), *only = malloc(sizeof *only * count), worst = 0;
    struct gd_field *field;
    check_ok(gd_field_build(mesh, request, control, &field, NULL), NULL);
    check_ok(gd_field_distances_only(mesh, request, control, only, NULL), NULL);
    gd_field_vertex_distances(field, kept);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(isfinite(kept[i]), isfinite(only[i]));
        if (isfinite(kept[i]) && kept[i] > 0)
            worst = fmax(worst, fabs(kept[i] - only[i]) / kept[i]);
    }
    free(kept);
    free(only);
    gd_field_release(field);
    return worst;
}

/* Compares requests with one seed, with several seeds and offsets, with a radius, and with a
 * target. Some requests share a workspace. */
static void check_surface(struct gd_polygons *polygons, uint64_t seed,
                          struct gd_workspace *workspace)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    struct rng rng = {seed};
    struct gd_control control = {.workspace = workspace};
    uint32_t faces = gd_mesh_summary(mesh)->faces;
    struct gd_seed seeds[3];
    for (int i = 0; i < 3; i++)
        seeds[i] = (struct gd_seed){.point = {.kind = GD_POINT_FACE,
                                              .element = rng_below(&rng, faces),
                                              .weight = {0.3, 0.45, 0.25}},
                                    .offset = 0.01 * i};
    struct gd_point target = {
        .kind = GD_POINT_FACE, .element = rng_below(&rng, faces), .weight = {0.5, 0.25, 0.25}};
    const struct gd_field_request requests[4] = {
        {.seeds = seeds, .seed_count = 1},
        {.seeds = seeds, .seed_count = 3},
        {.seeds = seeds, .seed_count = 1, .radius = 0.4},
        {.seeds = seeds, .seed_count = 1, .target = &target}};
    for (int k = 0; k < 4; k++)
        assert_true(difference(mesh, &requests[k], k % 2 ? &control : NULL) < 1e-12);
    gd_mesh_release(mesh);
    gd_polygons_free(polygons);
}

static void distances_are_the_fields(void **state)
{
    (void)state;
    struct gd_workspace *workspace = gd_workspace_create();
    struct gd_polygons polygons;
    check_ok(sample_terrain(40, 0.3, 7, &polygons), NULL);
    check_surface(&polygons, 1, workspace);
    /* the terrain is steep, so sides are visited often, and their windows are pruned */
    check_ok(sample_terrain(24, 3, 9, &polygons), NULL);
    check_surface(&polygons, 2, workspace);
    check_ok(sample_icosphere(4, 1, &polygons), NULL);
    check_surface(&polygons, 3, workspace);
    check_ok(sample_genus2(6, 0.1, &polygons), NULL);
    check_surface(&polygons, 4, workspace);
    check_ok(sample_grid(60, 20, 3, 1, &polygons), NULL);
    check_surface(&polygons, 5, workspace);
    gd_workspace_destroy(workspace);
}

/* The budget is enough for the distances but not for a field. On failure the output is
 * untouched. */
static void little_memory_is_enough(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_terrain(220, 0.1, 3, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    size_t faces = gd_mesh_summary(mesh)->faces, count = gd_mesh_summary(mesh)->index_count;
    struct gd_seed seed = {
        .point = {.kind = GD_POINT_FACE, .element = 77, .weight = {0.2, 0.5, 0.3}}};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    struct gd_control control = {.budget_bytes = 24 * faces};
    double *out = malloc(sizeof *out * count);
    check_ok(gd_field_distances_only(mesh, &request, &control, out, NULL), NULL);
    struct gd_field *field;
    assert_int_equal(gd_field_build(mesh, &request, &control, &field, NULL), GD_BUDGET);
    for (size_t budget = 1; budget < 16; budget += 2) { /* the call fails at various stages */
        control.budget_bytes = budget * faces / 2;
        memset(out, 0, sizeof *out * count);
        enum gd_status status = gd_field_distances_only(mesh, &request, &control, out, NULL);
        assert_true(status == GD_BUDGET || status == GD_OK);
        for (size_t i = 0; status && i < count; i++) assert_true(out[i] == 0);
    }
    free(out);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_the_fields),
        cmocka_unit_test(little_memory_is_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
