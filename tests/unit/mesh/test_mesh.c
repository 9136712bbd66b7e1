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

static void expect_positions(const struct gd_mesh *mesh, const struct gd_polygons *polygons)
{
    for (uint32_t v = 0; v < polygons->position_count; v++) {
        struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){v});
        assert_memory_equal(&p, polygons->positions[v], sizeof p);
    }
}

static void positions_and_corners_are_those_of_the_input(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_terrain(9, 0.3, 2, &polygons), GD_OK);
    assert_int_equal(sample_renumber(&polygons, 4, NULL, NULL), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    expect_positions(mesh, &polygons);
    assert_null(mesh->input_position);
    for (uint32_t f = 0; f < polygons.polygon_count; f++) {
        struct gd_vertex c[3];
        gd_mesh_corners(mesh, (struct gd_face){f}, c);
        for (int k = 0; k < 3; k++) assert_int_equal(c[k].index, polygons.corners[3 * f + k]);
        assert_int_equal(gd_mesh_source_face(mesh, (struct gd_face){f}), f);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* The mesh stores the input's positions if it can't compute them: if a coordinate underflows in the
 * normalised unit, and if an index has no vertex of its own. */
static void positions_that_cannot_be_computed_are_stored(void **state)
{
    (void)state;
    double tiny[][3] = {{0x1p-1073, -0.0, 0}, {1e9, 0, 0}, {0, 1e9, -0x3p-1074}};
    double repeated[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.0625, 0, 0}, {-1, 0, 0}};
    uint32_t corners[] = {0, 1, 2}, welded[] = {0, 1, 2, 3, 2, 4};
    struct gd_polygons first = TRIANGLES(tiny, corners), second = TRIANGLES(repeated, welded);
    struct gd_mesh *mesh = build(&first);
    expect_positions(mesh, &first);
    gd_mesh_release(mesh);
    const struct gd_mesh_options options = {.weld = true, .weld_tolerance = 0.125};
    assert_int_equal(gd_mesh_build(&second, &options, NULL, &mesh, NULL), GD_OK);
    assert_int_equal(gd_mesh_summary(mesh)->vertices, 4);
    expect_positions(mesh, &second);
    gd_mesh_release(mesh);
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
        cmocka_unit_test(positions_that_cannot_be_computed_are_stored),
        cmocka_unit_test(the_polygons_of_a_mesh_build_the_same_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
