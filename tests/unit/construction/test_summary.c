#include "tests/unit/mesh/shapes.h"

#include "mesh/topology.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static void expect_counts(const struct gd_polygons *polygons, uint32_t components,
                          uint32_t boundaries, int64_t euler, int64_t genus)
{
    struct gd_mesh *mesh = build(polygons);
    const struct gd_mesh_summary *s = gd_mesh_summary(mesh);
    assert_int_equal(s->components, components);
    assert_int_equal(s->boundaries, boundaries);
    assert_int_equal(s->euler_characteristic, euler);
    assert_int_equal(s->genus, genus);
    gd_mesh_release(mesh);
}

static void euler_characteristic_and_genus(void **state)
{
    (void)state;
    struct gd_polygons polygons = tetrahedron();
    expect_counts(&polygons, 1, 0, 2, 0);
    polygons = cube();
    expect_counts(&polygons, 1, 0, 2, 0);
    assert_int_equal(sample_torus(8, 6, 3, 1, &polygons), GD_OK);
    expect_counts(&polygons, 1, 0, 0, 1);
    gd_polygons_free(&polygons);
    assert_int_equal(sample_genus2(2, 0, &polygons), GD_OK);
    expect_counts(&polygons, 1, 0, -2, 2);
    gd_polygons_free(&polygons);
    assert_int_equal(sample_grid(3, 4, 1, 1, &polygons), GD_OK);
    expect_counts(&polygons, 1, 1, 1, 0);
    gd_polygons_free(&polygons);
    assert_int_equal(sample_cylinder(1, 1, 5, 2, &polygons), GD_OK);
    expect_counts(&polygons, 1, 2, 0, 0);
    gd_polygons_free(&polygons);
}

/* Two quads are joined along all four edges. This surface without thickness has the topology of a
 * sphere. */
static void a_pillow_is_a_sphere(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 0, 2, 3, 1, 0, 3, 1, 3, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    expect_counts(&polygons, 1, 0, 2, 0);
}

static void components_are_counted_one_by_one(void **state)
{
    (void)state;
    struct gd_polygons polygons, other;
    assert_int_equal(sample_grid(2, 3, 1, 1, &polygons), GD_OK);
    assert_int_equal(sample_torus(6, 5, 3, 1, &other), GD_OK);
    assert_int_equal(sample_append(&polygons, &other), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(mesh->summary.components, 2);
    assert_int_equal(mesh->summary.genus, 1);
    /* components are in the order of their lowest faces */
    const struct gd_component *c = mesh->component;
    assert_int_equal(c[0].faces, 12);
    assert_int_equal(c[0].vertices, 12);
    assert_int_equal(c[0].edges, 23);
    assert_int_equal(c[0].boundaries, 1);
    assert_int_equal(c[1].faces, 60);
    assert_int_equal(c[1].edges, 90);
    assert_int_equal(c[1].boundaries, 0);
    expect_near(c[0].grain * mesh->unit, 1.0 / 3, 1e-14); /* each face is 1/2 by 1/3 */
    assert_true(c[1].grain * mesh->unit > mesh->summary.edge_length.min);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        assert_int_equal(mesh->vertex_component[v], mesh->index_of_vertex[v] >= 12);
    gd_mesh_release(mesh);
    gd_polygons_free(&other);
    gd_polygons_free(&polygons);
}

static void unreferenced_vertices_keep_their_index(void **state)
{
    (void)state;
    double positions[][3] = {{9, 9, 9}, {0, 0, 0}, {-50, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 70}};
    uint32_t corners[] = {1, 3, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_mesh *mesh = build(&polygons);
    const struct gd_mesh_summary *s = gd_mesh_summary(mesh);
    assert_int_equal(s->index_count, 6);
    assert_int_equal(s->vertices, 3);
    assert_int_equal(s->unreferenced_vertices, 3);
    assert_true(s->min.x == 0 && s->min.y == 0 && s->min.z == 0);
    assert_true(s->max.x == 1 && s->max.y == 1 && s->max.z == 0);
    assert_true(gd_mesh_position(mesh, (struct gd_vertex){5}).z == 70);
    expect_near(s->area, 0.5, 1e-16);
    expect_near(s->edge_length.min, 1, 0);
    expect_near(s->edge_length.max, sqrt(2), 1e-15);
    expect_near(s->edge_length.mean, (2 + sqrt(2)) / 3, 1e-15);
    gd_mesh_release(mesh);
}

static void boundary_loops_come_in_order_of_their_lowest_vertex(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_cylinder(2, 3, 6, 1, &polygons), GD_OK);
    sample_scale(&polygons, 0.5, 0.5, 1);
    assert_int_equal(sample_renumber(&polygons, 11, NULL, NULL), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(mesh->summary.boundaries, 2);
    uint32_t lowest[2];
    for (uint32_t b = 0; b < 2; b++) {
        assert_int_equal(gd_mesh_boundary(mesh, b).vertices, 6);
        expect_near(gd_mesh_boundary(mesh, b).length, 6, 1e-14); /* a hexagon of radius 1 */
        uint32_t side = mesh->boundary_side[b];
        assert_true(gd__side_is_boundary(mesh, side));
        lowest[b] = mesh->index_of_vertex[mesh->origin[side]];
    }
    assert_int_equal(lowest[0], 0);
    double z = gd_mesh_position(mesh, (struct gd_vertex){0}).z;
    uint32_t expected = 0; /* finds the first vertex of the other boundary */
    while (polygons.positions[expected][2] == z) expected++;
    assert_int_equal(lowest[1], expected);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(euler_characteristic_and_genus),
        cmocka_unit_test(a_pillow_is_a_sphere),
        cmocka_unit_test(components_are_counted_one_by_one),
        cmocka_unit_test(unreferenced_vertices_keep_their_index),
        cmocka_unit_test(boundary_loops_come_in_order_of_their_lowest_vertex),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
