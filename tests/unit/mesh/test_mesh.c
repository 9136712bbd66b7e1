#include "shapes.h"

#include "mesh/topology.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static void references_are_counted(void **state)
{
    (void)state;
    struct gd_polygons polygons = tetrahedron();
    struct gd_mesh *mesh = build(&polygons);
    assert_ptr_equal(gd_mesh_retain(mesh), mesh);
    gd_mesh_release(mesh);
    assert_int_equal(gd_mesh_summary(mesh)->faces, 4);
    gd_mesh_release(mesh);
    gd_mesh_release(NULL);
}

static void positions_and_corners_are_those_of_the_input(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_terrain(9, 0.3, 2, &polygons), GD_OK);
    assert_int_equal(sample_renumber(&polygons, 4, NULL, NULL), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    for (uint32_t v = 0; v < polygons.position_count; v++) {
        struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){v});
        assert_memory_equal(&p, polygons.positions[v], sizeof p);
    }
    for (uint32_t f = 0; f < polygons.polygon_count; f++) {
        struct gd_vertex c[3];
        gd_mesh_corners(mesh, (struct gd_face){f}, c);
        for (int k = 0; k < 3; k++) assert_int_equal(c[k].index, polygons.corners[3 * f + k]);
        assert_int_equal(gd_mesh_source_face(mesh, (struct gd_face){f}), f);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* The polygons of a mesh build the same mesh. */
static void the_polygons_of_a_mesh_build_the_same_mesh(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube(), again;
    struct gd_mesh *mesh = build(&polygons), *copy;
    assert_int_equal(gd_mesh_polygons(mesh, &again), GD_OK);
    assert_null(again.first);
    assert_int_equal(again.position_count, 8);
    assert_int_equal(again.polygon_count, 12);
    assert_memory_equal(again.positions, cube_positions, sizeof cube_positions);
    copy = build(&again);
    assert_memory_equal(&copy->summary, &mesh->summary, sizeof mesh->summary);
    gd_mesh_release(copy);
    gd_polygons_free(&again);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(references_are_counted),
        cmocka_unit_test(positions_and_corners_are_those_of_the_input),
        cmocka_unit_test(the_polygons_of_a_mesh_build_the_same_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
