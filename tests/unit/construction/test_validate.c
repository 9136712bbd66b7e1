#include "tests/unit/mesh/shapes.h"

static double square[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

static void a_list_without_polygons_is_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons = {0};
    struct gd_detail detail = refuse(&polygons, GD_EMPTY);
    assert_int_equal(detail.count, 0);
    assert_true(strlen(detail.text) > 0);
    polygons = (struct gd_polygons){.positions = square, .position_count = 4};
    refuse(&polygons, GD_EMPTY);
}

static void an_index_beyond_the_vertices_is_refused(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 0, 2, 4};
    struct gd_polygons polygons = TRIANGLES(square, corners);
    struct gd_detail detail = refuse(&polygons, GD_INDEX);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(1, 0), "face 1 names vertex 4");
}

static void a_face_of_two_corners_is_refused(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 3, 0}, first[] = {0, 3, 5};
    struct gd_polygons polygons = POLYGONS(square, corners, first);
    struct gd_detail detail = refuse(&polygons, GD_DEGENERATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(1, 0), "face 1 has 2 corners");
}

static void coordinates_must_be_finite(void **state)
{
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
            uint32_t corners[] = {0, 1, 2};
            positions[2][k] = bad[i];
            struct gd_polygons polygons = TRIANGLES(positions, corners);
            struct gd_detail detail = refuse(&polygons, GD_NON_FINITE);
            expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(2, 0), "vertex 2");
        }
    }
}

static void a_coordinate_beyond_the_extent_is_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, -2e150, 0}};
    uint32_t corners[] = {0, 1, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_EXTENT);
    expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(2, 0), "vertex 2");
}

static void a_repeated_corner_is_refused(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 1, 3, 1};
    struct gd_polygons polygons = TRIANGLES(square, corners);
    struct gd_detail detail = refuse(&polygons, GD_DEGENERATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(1, 0),
                    "face 1 has vertex 1 as two of its corners");

    uint32_t bow_tie[] = {0, 1, 2, 0, 3}, first[] = {0, 5};
    polygons = POLYGONS(square, bow_tie, first);
    detail = refuse(&polygons, GD_DEGENERATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(0, 0), "vertex 0");
}

static void an_edge_of_length_zero_is_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 0}, {-0.0, 0, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 3, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_DEGENERATE_FACE);
    expect_elements(&detail, GD_ELEMENT_EDGE, 1, ONE_ELEMENT(1, 3),
                    "edge 1-3 of face 1 has length zero");

    uint32_t signed_zero[] = {0, 2, 4};
    polygons = TRIANGLES(positions, signed_zero);
    refuse(&polygons, GD_DEGENERATE_FACE);
}

static void the_first_offenders_are_listed_and_all_are_counted(void **state)
{
    (void)state;
    uint32_t corners[3 * 20];
    for (uint32_t i = 0; i < 20; i++)
        memcpy(corners + 3 * i, (uint32_t[3]){0, 1, 100 + i}, 3 * sizeof *corners);
    struct gd_polygons polygons = TRIANGLES(square, corners);
    struct gd_detail detail = refuse(&polygons, GD_INDEX);
    const uint64_t first[][2] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {7, 0}};
    expect_elements(&detail, GD_ELEMENT_FACE, 20, 8, first, "face 0 names vertex 100");
}

static void polygons_can_be_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = NULL;
    struct gd_detail detail = {0};
    struct gd_mesh_options options = {.refuse_polygons = true};
    assert_int_equal(gd_mesh_build(&polygons, &options, NULL, &mesh, &detail), GD_NOT_TRIANGLES);
    assert_int_equal(detail.total, 6);
    polygons = tetrahedron();
    assert_int_equal(gd_mesh_build(&polygons, &options, NULL, &mesh, &detail), GD_OK);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_without_polygons_is_refused),
        cmocka_unit_test(an_index_beyond_the_vertices_is_refused),
        cmocka_unit_test(a_face_of_two_corners_is_refused),
        cmocka_unit_test(coordinates_must_be_finite),
        cmocka_unit_test(a_coordinate_beyond_the_extent_is_refused),
        cmocka_unit_test(a_repeated_corner_is_refused),
        cmocka_unit_test(an_edge_of_length_zero_is_refused),
        cmocka_unit_test(the_first_offenders_are_listed_and_all_are_counted),
        cmocka_unit_test(polygons_can_be_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
