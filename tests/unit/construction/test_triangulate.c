#include <stdlib.h>

#include "tests/unit/mesh/shapes.h"

/* Checks the mesh's area, which equals the flat polygon's area if the triangles do not overlap. */
static void expect_area(const struct gd_polygons *polygons, uint32_t faces, double area)
{
    struct gd_mesh *mesh = build(polygons);
    assert_int_equal(gd_mesh_summary(mesh)->faces, faces);
    expect_near(gd_mesh_summary(mesh)->area, area, 1e-12 * area);
    gd_mesh_release(mesh);
}

/* Tests polygons in each coordinate plane and in both orientations. */
static void concave_polygons_are_cut_along_the_inside(void **state)
{
    (void)state;
    const double outline[][2] = {{0, 0}, {4, 0}, {4, 3}, {2, 0.5}, {0, 3}},
                 arrow[][2] = {{0, 0}, {4, -3}, {1, 0}, {4, 3}};
    uint32_t corners[] = {0, 1, 2, 3, 4}, clockwise[] = {4, 3, 2, 1, 0}, quad[] = {0, 1, 2, 3},
             first[] = {0, 5}, one[] = {0, 4};
    for (int axis = 0; axis < 3; axis++) {
        double positions[5][3] = {{0}}, head[4][3] = {{0}};
        for (int i = 0; i < 10; i++) positions[i / 2][(axis + i % 2) % 3] = outline[i / 2][i % 2];
        for (int i = 0; i < 8; i++) head[i / 2][(axis + i % 2) % 3] = arrow[i / 2][i % 2];
        struct gd_polygons polygons = POLYGONS(positions, corners, first);
        expect_area(&polygons, 3, 7);
        polygons = POLYGONS(positions, clockwise, first);
        expect_area(&polygons, 3, 7);
        polygons = POLYGONS(head, quad, one);
        expect_area(&polygons, 2, 3);
    }
}

static void corners_on_a_straight_edge_do_no_harm(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 4, 5}, first[] = {0, 6};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    expect_area(&polygons, 4, 9);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(gd_mesh_summary(mesh)->degenerate_faces, 0);
    gd_mesh_release(mesh);
}

/* Two quads have the same four corners. The second must take the other diagonal. */
static void diagonals_of_other_polygons_are_avoided(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {2, 0.5, 0}, {2, 2, 0}, {0, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 3, 2, 1, 0}, first[] = {0, 4, 8};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(gd_mesh_summary(mesh)->edges, 6);
    assert_int_equal(gd_mesh_summary(mesh)->euler_characteristic, 2);
    gd_mesh_release(mesh);
}

/* The quad's first diagonal, which a fan would use, is an edge of other triangles. */
static void edges_of_other_faces_are_avoided(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1.2, 1.2, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
    uint32_t corners[] = {0, 1, 2, 3, 0, 4, 1, 1, 4, 2, 2, 4, 0, 0, 2, 3, 0, 2, 3},
             first[] = {0, 4, 7, 10, 13};
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = 5,
                                   .corners = corners,
                                   .first = first,
                                   .polygon_count = 4};
    struct gd_mesh *mesh = build(&polygons);
    struct gd_vertex c[3];
    for (uint32_t f = 0; f < 2; f++) {
        gd_mesh_corners(mesh, (struct gd_face){f}, c);
        uint32_t has = 0;
        for (int k = 0; k < 3; k++) has |= 1u << c[k].index;
        assert_true((has & 10) == 10); /* contains both ends of the diagonal 1-3 */
        assert_int_equal(gd_mesh_source_face(mesh, (struct gd_face){f}), 0);
    }
    assert_int_equal(gd_mesh_source_face(mesh, (struct gd_face){4}), 3);
    gd_mesh_release(mesh);
}

static void a_polygon_without_a_free_diagonal_is_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}};
    uint32_t corners[] = {0, 2, 4, 1, 3, 5, 0, 1, 2, 3}, first[] = {0, 3, 6, 10};
    struct gd_polygons polygons = POLYGONS(positions, corners, first);
    struct gd_detail detail = refuse(&polygons, GD_NOT_TRIANGULABLE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(2, 0), "face 2 with 4 corners");
}

/* Cutting off the best-shaped ear first leaves a quad whose two diagonals are edges of other faces.
 * Another order of cutting succeeds. */
static void the_order_of_cutting_does_not_decide_whether_it_succeeds(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},      {2, 0, 0}, {2.5, 1.5, 0}, {1, 2.5, 0},
                             {-0.5, 1.5, 0}, {0, 0, 3}, {1, 0, 4},     {1, 1, 5}};
    for (uint32_t turn = 0; turn < 5; turn++) {
        uint32_t v[5];
        for (uint32_t i = 0; i < 5; i++) v[i] = (i + turn) % 5;
        /* Edges 2-4 and 0-3 exist. Cutting off corner 1 (diagonal 0-2) would leave the quad 0 2 3 4
         * without a free diagonal. */
        uint32_t corners[] = {v[2], v[4], 5, v[0], v[3], 6, 0, 1, 2, 3, 4}, first[] = {0, 3, 6, 11};
        struct gd_polygons polygons = POLYGONS(positions, corners, first);
        struct gd_mesh *mesh = NULL;
        enum gd_status status = gd_mesh_build(&polygons, NULL, NULL, &mesh, NULL);
        assert_int_not_equal(status, GD_NOT_TRIANGULABLE);
        gd_mesh_release(mesh);
    }
}

static void polygons_that_are_not_flat_are_cut_up(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    cube_positions[6][2] += 0.3;
    struct gd_mesh *mesh = build(&polygons);
    assert_int_equal(gd_mesh_summary(mesh)->faces, 12);
    assert_int_equal(gd_mesh_summary(mesh)->euler_characteristic, 2);
    gd_mesh_release(mesh);
    cube_positions[6][2] -= 0.3;
}

/* Every second corner is reflex, and the ears at all other corners are blocked or thin. This is the
 * worst case for ear clipping. */
static void a_star_of_thousands_of_corners_is_cut_up(void **state)
{
    (void)state;
    enum { POINTS = 4000 };
    double(*positions)[3] = calloc(POINTS, sizeof *positions);
    uint32_t *corners = calloc(POINTS, sizeof *corners), first[] = {0, POINTS};
    double area = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        double r = i % 2 ? 1 : 2, a = 2 * M_PI * i / POINTS;
        memcpy(positions[i], (double[3]){r * cos(a), 3, r * sin(a)}, sizeof *positions);
        corners[i] = i;
        area += 0.5 * 2 * sin(2 * M_PI / POINTS);
    }
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = POINTS,
                                   .corners = corners,
                                   .first = first,
                                   .polygon_count = 1};
    struct gd_mesh *mesh = build(&polygons);
    expect_near(gd_mesh_summary(mesh)->area, area, 1e-9);
    gd_mesh_release(mesh);
    free(positions);
    free(corners);
}

static void too_many_corners_are_refused_with_an_error(void **state)
{
    (void)state;
    enum { POINTS = 100000 };
    double(*positions)[3] = calloc(POINTS, sizeof *positions);
    uint32_t *corners = calloc(POINTS, sizeof *corners), first[] = {0, POINTS};
    for (uint32_t i = 0; i < POINTS; i++) {
        memcpy(positions[i], (double[3]){cos(i * 6e-5), sin(i * 6e-5), 0}, sizeof *positions);
        corners[i] = i;
    }
    struct gd_polygons polygons = {.positions = positions,
                                   .position_count = POINTS,
                                   .corners = corners,
                                   .first = first,
                                   .polygon_count = 1};
    struct gd_detail detail = refuse(&polygons, GD_UNSUPPORTED);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(0, 0), "face 0 has 100000 corners");
    free(positions);
    free(corners);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(concave_polygons_are_cut_along_the_inside),
        cmocka_unit_test(corners_on_a_straight_edge_do_no_harm),
        cmocka_unit_test(diagonals_of_other_polygons_are_avoided),
        cmocka_unit_test(edges_of_other_faces_are_avoided),
        cmocka_unit_test(a_polygon_without_a_free_diagonal_is_refused),
        cmocka_unit_test(the_order_of_cutting_does_not_decide_whether_it_succeeds),
        cmocka_unit_test(polygons_that_are_not_flat_are_cut_up),
        cmocka_unit_test(a_star_of_thousands_of_corners_is_cut_up),
        cmocka_unit_test(too_many_corners_are_refused_with_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
