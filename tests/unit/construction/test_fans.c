#include "tests/unit/mesh/shapes.h"

#include "mesh/topology.h"
#include "tests/samples/samples.h"

static double angle_at(const struct gd_mesh *mesh, uint32_t h)
{
    struct gd_vec3 a = mesh->position[mesh->origin[h]],
                   b = mesh->position[gd__side_destination(mesh, h)];
    struct gd_vec3 p = mesh->position[gd__side_apex(mesh, h)], u = gd_vec3_sub(b, a),
                   v = gd_vec3_sub(p, a);
    return atan2(gd_vec3_length(gd_vec3_cross(u, v)), gd_vec3_dot(u, v));
}

/* Checks mesh->beyond, which is the apex of the face across the edge opposite to `v`. */
static void expect_beyond(const struct gd_mesh *mesh, uint32_t v, uint32_t entry)
{
    uint32_t a = mesh->fan[entry].tip, b = gd__side_apex(mesh, mesh->fan[entry].side),
             side = gd__side_between(mesh, a, b);
    assert_int_equal(gd__side_apex(mesh, side), v);
    bool open = gd__side_is_boundary(mesh, side ^ 1);
    assert_int_equal(mesh->beyond[entry], open ? GD_NONE : gd__side_apex(mesh, side ^ 1));
}

/* Checks that the entries of a fan run counter-clockwise once around the vertex, and that their
 * angles add up. At a boundary vertex, the entries must begin at the boundary. */
static void expect_fan(const struct gd_mesh *mesh, uint32_t v)
{
    double angle = 0;
    uint32_t begin = mesh->fan_first[v], end = mesh->fan_first[v + 1];
    bool open = mesh->vertex_kind[v] == GD_VERTEX_BOUNDARY;
    assert_true(begin < end);
    assert_int_equal(gd__side_is_boundary(mesh, mesh->fan[begin].side ^ 1), open);
    for (uint32_t i = begin; i < end; i++) {
        uint32_t h = mesh->fan[i].side, after = mesh->side[h].left;
        assert_int_equal(mesh->origin[h], v);
        assert_int_equal(gd__fan_entry(mesh, h), i);
        expect_near(mesh->fan[i].angle, angle, 1e-13);
        angle += angle_at(mesh, h);
        if (i + 1 < end)
            assert_int_equal(mesh->fan[i + 1].side, after);
        else if (open)
            assert_true(gd__side_is_boundary(mesh, after));
        else
            assert_int_equal(mesh->fan[begin].side, after);
    }
    expect_near(mesh->total_angle[v], angle, 1e-13);
    assert_int_equal(gd__neighbours_end(mesh, v), end + open);
    for (uint32_t i = begin; i < gd__neighbours_end(mesh, v); i++)
        assert_true(gd__side_between(mesh, v, gd__neighbour(mesh, v, i)) != GD_NONE);
    for (uint32_t i = begin; i < end; i++) expect_beyond(mesh, v, i);
}

static void expect_fans(const struct gd_mesh *mesh)
{
    double sum = 0;
    uint32_t saddles = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        expect_fan(mesh, v);
        sum += mesh->total_angle[v];
        saddles += mesh->vertex_kind[v] == GD_VERTEX_SADDLE;
    }
    assert_int_equal(mesh->fan_first[mesh->vertex_count], 3 * mesh->face_count);
    assert_int_equal(mesh->summary.saddle_vertices, saddles);
    expect_near(sum, M_PI * mesh->face_count, 1e-11 * mesh->face_count);
}

static void the_fans_of_samples_are_whole(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    for (int i = 0; i < 3; i++) {
        enum gd_status status = i == 0   ? sample_terrain(12, 0.4, 3, &polygons)
                                : i == 1 ? sample_genus2(3, 0.1, &polygons)
                                         : sample_cylinder(1, 2, 9, 4, &polygons);
        assert_int_equal(status, GD_OK);
        struct gd_mesh *mesh = build(&polygons);
        expect_fans(mesh);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    for (uint64_t seed = 1; seed <= 100; seed++) {
        assert_int_equal(sample_tangle(40, seed, &polygons), GD_OK);
        struct gd_mesh *mesh = build(&polygons);
        expect_fans(mesh);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static void a_cube_corner_is_convex(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    for (uint32_t v = 0; v < 8; v++) {
        expect_near(mesh->total_angle[v], 1.5 * M_PI, 1e-14);
        assert_int_equal(mesh->vertex_kind[v], GD_VERTEX_CONVEX);
    }
    gd_mesh_release(mesh);
}

static void saddles_are_distinguished_from_flat_vertices(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_grid(7, 5, 0.7, 0.3, &polygons), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(mesh->summary.saddle_vertices, 0);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    assert_int_equal(sample_saddle(1, 0.5, 8, 1, &polygons), GD_OK);
    mesh = build(&polygons);
    assert_int_equal(mesh->summary.saddle_vertices, 1);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_fans_of_samples_are_whole),
        cmocka_unit_test(a_cube_corner_is_convex),
        cmocka_unit_test(saddles_are_distinguished_from_flat_vertices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
