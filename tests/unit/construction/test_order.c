#include "tests/unit/mesh/shapes.h"

#include "mesh/topology.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static struct gd_mesh *shuffled(uint64_t seed)
{
    struct gd_polygons polygons;
    assert_int_equal(sample_icosphere(3, 1, &polygons), GD_OK);
    if (seed) assert_int_equal(sample_renumber(&polygons, seed, NULL, NULL), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* The internal order of vertices does not depend on the order of the input. In the internal order,
 * neighbours are close to each other. */
static void internal_order_follows_space(void **state)
{
    (void)state;
    struct gd_mesh *a = shuffled(0), *b = shuffled(17);
    assert_memory_equal(a->position, b->position, a->vertex_count * sizeof *a->position);
    double apart = 0;
    for (uint32_t e = 0; e < a->edge_count; e++)
        apart += fabs((double)a->origin[2 * e] - a->origin[2 * e + 1]);
    /* in a random order the mean would be 1/3 */
    assert_true(apart / a->edge_count < 0.15 * a->vertex_count);
    gd_mesh_release(a);
    gd_mesh_release(b);
}

static void the_maps_are_inverse(void **state)
{
    (void)state;
    struct gd_mesh *mesh = shuffled(3);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        assert_int_equal(mesh->vertex_of_index[mesh->index_of_vertex[v]], v);
    for (uint32_t f = 0; f < mesh->face_count; f++)
        assert_int_equal(mesh->face_of_index[mesh->index_of_face[f]], f);
    gd_mesh_release(mesh);
}

static void edges_come_in_order_of_first_use(void **state)
{
    (void)state;
    struct gd_mesh *mesh = shuffled(5);
    uint32_t next = 0;
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (int k = 0; k < 3; k++) {
            uint32_t e = mesh->face_side[f][k] / 2;
            assert_true(e <= next);
            next += e == next;
        }
    }
    assert_int_equal(next, mesh->edge_count);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(internal_order_follows_space),
        cmocka_unit_test(the_maps_are_inverse),
        cmocka_unit_test(edges_come_in_order_of_first_use),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
