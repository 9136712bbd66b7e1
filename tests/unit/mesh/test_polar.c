#include "mesh/polar.h"

#include <math.h>

#include "mesh/canonical.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static struct gd_mesh *open_torus(void)
{
    struct gd_polygons polygons;
    check_ok(sample_torus(7, 5, 3, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* Returns the point at this distance and angle from a vertex, in the face of a fan's entry. */
static struct gd_point place(const struct gd_mesh *mesh, uint32_t entry, double radius, double turn)
{
    uint32_t side = mesh->fan[entry].side, face = mesh->side_face[side];
    const struct gd_side *s = &mesh->side[side];
    int k = gd__place_of_side(mesh->face_side[face], side);
    double apex = radius * sin(turn) / (s->left_length * s->left_y),
           along = (radius * cos(turn) - apex * s->left_length * s->left_x) / s->length, weight[3];
    weight[k] = 1 - apex - along;
    weight[(k + 1) % 3] = along;
    weight[(k + 2) % 3] = apex;
    return (struct gd_point){GD_POINT_FACE, face, {weight[0], weight[1], weight[2]}};
}

static void radius_and_angle_keep_their_digits(void **state)
{
    (void)state;
    struct gd_mesh *mesh = open_torus();
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (uint32_t i = mesh->fan_first[v]; i < mesh->fan_first[v + 1]; i++) {
            double radius = pow(10, -3 - (int)(i % 12)),
                   turn = 0.4 * (gd__fan_end(mesh, v, i) - mesh->fan[i].angle);
            struct gd_point point = place(mesh, i, radius, turn);
            struct gd__polar polar;
            assert_true(gd__polar_about(mesh, &point, v, &polar));
            assert_int_equal(polar.entry, i);
            check_close(polar.radius, radius, 1e-14);
            assert_true(fabs(polar.angle - mesh->fan[i].angle - turn) < 1e-14);
            assert_true(gd__polar_beside(mesh, &point, &polar) && polar.vertex == v);
            assert_true(gd__polar_around(mesh, &point, radius, &polar) && polar.vertex == v);
        }
    }
    gd_mesh_release(mesh);
}

/* Tests points close to either end of each edge. */
static void a_point_of_an_edge_lies_where_its_entry_begins(void **state)
{
    (void)state;
    struct gd_mesh *mesh = open_torus();
    for (uint32_t side = 0; side < 2 * mesh->edge_count; side++) {
        struct gd_point point = gd__point_on_side(mesh, side, 1e-12, 1 - 1e-12);
        struct gd__polar polar;
        assert_true(gd__polar_beside(mesh, &point, &polar));
        assert_int_equal(polar.vertex, mesh->origin[side]);
        assert_true(polar.radius == 1e-12 * mesh->side[side].length);
        assert_true(polar.angle == mesh->fan[gd__fan_entry(mesh, side)].angle);
    }
    gd_mesh_release(mesh);
}

/* The fan of a boundary vertex ends at its last edge, which has a face on one side only. */
static void the_last_edge_of_a_boundary_ends_the_fan(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(2, 2, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    uint32_t seen = 0;
    for (uint32_t side = 0; side < 2 * mesh->edge_count; side++) {
        if (!gd__side_is_boundary(mesh, side)) continue;
        struct gd_point point = gd__point_on_side(mesh, side, 1e-9, 1 - 1e-9);
        struct gd__polar polar;
        uint32_t vertex = mesh->origin[side];
        assert_true(gd__polar_about(mesh, &point, vertex, &polar));
        assert_true(polar.angle == mesh->total_angle[vertex] &&
                    polar.entry + 1 == mesh->fan_first[vertex + 1]);
        seen++;
    }
    assert_int_equal(seen, 8);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void other_points_are_close_to_no_vertex(void **state)
{
    (void)state;
    struct gd_mesh *mesh = open_torus();
    struct gd__polar polar;
    struct gd_point middle = {GD_POINT_FACE, 0, {0.4, 0.3, 0.3}}, corner = gd__point_of_vertex(3),
                    edge = gd__point_of_edge(mesh, 5, 0.5);
    assert_false(gd__polar_beside(mesh, &middle, &polar));
    assert_false(gd__polar_beside(mesh, &edge, &polar));
    assert_false(gd__polar_beside(mesh, &corner, &polar));
    assert_false(gd__polar_about(mesh, &corner, 3, &polar));
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        bool is_corner = false;
        for (int k = 0; k < 3; k++) is_corner |= mesh->origin[mesh->face_side[0][k]] == v;
        assert_int_equal(gd__polar_about(mesh, &middle, v, &polar), is_corner);
    }
    gd_mesh_release(mesh);
}

/* The vertex 0 has two faces whose opposite side 1-2 has the length 1e-5. A point at 1e-3 of the
 * length of a face is far from the vertex, compared with the face's altitude, but not compared with
 * the distance of the opposite side. At vertex 1 both distances are small. */
static void points_near_the_tip_of_a_needle_are_around_it(void **state)
{
    (void)state;
    double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1e-5, 0}, {1, -1e-5, 0}};
    uint32_t corners[6] = {0, 1, 2, 0, 3, 1};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 4, .corners = corners, .polygon_count = 2};
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd__polar polar;
    for (uint32_t v = 0; v < 2; v++) {
        struct gd_point point;
        const struct gd_vertex ends[2] = {{v}, {!v}};
        check_ok(gd_point_on_edge(mesh, ends, 1e-3, &point, NULL), NULL);
        assert_false(gd__polar_beside(mesh, &point, &polar));
        assert_int_equal(gd__polar_around(mesh, &point, 0, &polar), v == 0);
        /* the distance of vertex 0 from the opposite sides is 1 */
        assert_int_equal(gd__polar_around(mesh, &point, 0.9989, &polar), v == 0);
        assert_false(gd__polar_around(mesh, &point, 0.9991, &polar));
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(radius_and_angle_keep_their_digits),
        cmocka_unit_test(a_point_of_an_edge_lies_where_its_entry_begins),
        cmocka_unit_test(the_last_edge_of_a_boundary_ends_the_fan),
        cmocka_unit_test(other_points_are_close_to_no_vertex),
        cmocka_unit_test(points_near_the_tip_of_a_needle_are_around_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
