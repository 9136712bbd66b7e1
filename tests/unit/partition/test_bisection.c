#include "partition/bisection.h"
#include "tests/support/test.h"

#include <stdlib.h>

#include "tests/samples/samples.h"

/* Each face belongs to one half, and so do its sides and corners. At any distance from the source
 * the halves have similar numbers of faces. */

#define SHELLS 8

struct bisection {
    const struct gd_mesh *mesh;
    struct gd_vec3 source;
    uint8_t *side, *vertex;
};

static void check_records(const struct bisection *halves)
{
    const struct gd_mesh *mesh = halves->mesh;
    uint8_t *vertex = calloc(mesh->vertex_count, 1);
    for (uint32_t face = 0; face < mesh->face_count; face++) {
        uint8_t half = halves->side[mesh->face_side[face][0]];
        assert_true(half < 2);
        for (int k = 0; k < 3; k++) {
            uint32_t side = mesh->face_side[face][k];
            assert_int_equal(halves->side[side], half);
            if (gd__side_is_boundary(mesh, side ^ 1))
                assert_int_equal(halves->side[side ^ 1], half);
            vertex[mesh->origin[side]] |= (uint8_t)(1 << half);
        }
    }
    assert_memory_equal(vertex, halves->vertex, mesh->vertex_count);
    free(vertex);
}

static double distance_of(const struct bisection *halves, uint32_t face)
{
    const struct gd_mesh *mesh = halves->mesh;
    const struct gd_vec3 *p = &mesh->position[mesh->origin[mesh->face_side[face][0]]],
                         *q = &halves->source;
    return sqrt((p->x - q->x) * (p->x - q->x) + (p->y - q->y) * (p->y - q->y) +
                (p->z - q->z) * (p->z - q->z));
}

/* Returns the speed-up by two workers. This is 2 if both workers are always equally busy, and 1 if
 * one worker waits for the other. */
static double gain_of(const struct bisection *halves)
{
    uint32_t faces = halves->mesh->face_count, count[SHELLS][2] = {{0}}, longest = 0;
    double farthest = 0;
    for (uint32_t face = 0; face < faces; face++)
        farthest = fmax(farthest, distance_of(halves, face));
    for (uint32_t face = 0; face < faces; face++) {
        int shell = (int)(distance_of(halves, face) / farthest * (SHELLS - 1e-9));
        count[shell][halves->side[halves->mesh->face_side[face][0]]]++;
    }
    for (int shell = 0; shell < SHELLS; shell++)
        longest += count[shell][0] > count[shell][1] ? count[shell][0] : count[shell][1];
    return (double)faces / longest;
}

static void check_surface(const char *name, double least, struct gd_polygons *polygons)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    struct bisection halves = {
        .mesh = mesh, .side = malloc(2 * mesh->edge_count), .vertex = malloc(mesh->vertex_count)};
    double worst = 2;
    for (uint32_t i = 0; i < 10; i++) {
        halves.source = mesh->position[i * (mesh->vertex_count - 1) / 9];
        gd__bisection_divide(mesh, halves.source, halves.side, halves.vertex);
        check_records(&halves);
        worst = fmin(worst, gain_of(&halves));
    }
    print_message("# %s: gain %.2f at the worst\n", name, worst);
    assert_true(worst > least);
    free(halves.side);
    free(halves.vertex);
    gd_mesh_release(mesh);
    gd_polygons_free(polygons);
}

static void halves_are_balanced(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_torus(160, 80, 2, 1, &polygons), NULL);
    check_surface("torus", 1.8, &polygons);
    check_ok(sample_terrain(60, 0.3, 7, &polygons), NULL);
    check_surface("terrain", 1.6, &polygons);
    check_ok(sample_box((double[3]){1, 2, 3}, (uint32_t[3]){20, 20, 20}, &polygons), NULL);
    check_surface("box", 1.5, &polygons);
}

/* Tests a mesh with fewer faces than the bisection has samples. */
static void few_faces(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_box((double[3]){1, 1, 1}, (uint32_t[3]){1, 1, 1}, &polygons), NULL);
    check_surface("cube", 0.99, &polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(halves_are_balanced),
                                       cmocka_unit_test(few_faces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
