#include "tests/unit/mesh/shapes.h"

static double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

static void a_face_given_twice_is_a_duplicate(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 0, 1, 3, 2, 0, 1};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_DUPLICATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(2, 0),
                    "face 2 has the same vertices as face 0");
}

static void a_face_and_its_back_are_duplicates(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 0, 2, 1};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_DUPLICATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 1, ONE_ELEMENT(1, 0), "remove one of them");
}

static void a_face_given_three_times_counts_twice(void **state)
{
    (void)state;
    uint32_t corners[] = {0, 1, 2, 0, 2, 1, 1, 0, 2};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_DUPLICATE_FACE);
    expect_elements(&detail, GD_ELEMENT_FACE, 2, 2, (const uint64_t[][2]){{1, 0}, {2, 0}},
                    "face 1");
}

static void three_faces_at_an_edge_are_refused(void **state)
{
    (void)state;
    uint32_t corners[] = {1, 0, 2, 0, 1, 3, 0, 1, 4};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_EDGE);
    expect_elements(&detail, GD_ELEMENT_EDGE, 1, ONE_ELEMENT(0, 1),
                    "edge 0-1 belongs to 3 faces (0, 1, 2)");
}

static void many_faces_at_an_edge_are_counted(void **state)
{
    (void)state;
    enum { SHEETS = 50 };
    double book[SHEETS + 2][3] = {{0, 0, 0}, {0, 0, 1}};
    uint32_t corners[3 * SHEETS];
    for (uint32_t i = 0; i < SHEETS; i++) {
        memcpy(book[i + 2], (double[3]){cos(i * 0.1), sin(i * 0.1), 0.5}, sizeof *book);
        memcpy(corners + 3 * i, (uint32_t[3]){0, 1, i + 2}, 3 * sizeof *corners);
    }
    struct gd_polygons polygons = TRIANGLES(book, corners);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_EDGE);
    expect_elements(&detail, GD_ELEMENT_EDGE, 1, ONE_ELEMENT(0, 1), "50 faces (0, 1, 2, ...)");
}

static void faces_of_polygons_are_named_by_the_polygon(void **state)
{
    (void)state;
    double corners_of_quads[][3] = {{0, 0, 0},  {1, 0, 0},  {1, 1, 0}, {0, 1, 0},
                                    {1, -1, 0}, {0, -1, 0}, {1, 0, 1}, {0, 0, 1}};
    uint32_t corners[] = {0, 1, 2, 3, 1, 0, 5, 4, 0, 1, 6, 7}, first[] = {0, 4, 8, 12};
    struct gd_polygons polygons = POLYGONS(corners_of_quads, corners, first);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_EDGE);
    expect_elements(&detail, GD_ELEMENT_EDGE, 1, ONE_ELEMENT(0, 1), "(0, 1, 2)");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_face_given_twice_is_a_duplicate),
        cmocka_unit_test(a_face_and_its_back_are_duplicates),
        cmocka_unit_test(a_face_given_three_times_counts_twice),
        cmocka_unit_test(three_faces_at_an_edge_are_refused),
        cmocka_unit_test(many_faces_at_an_edge_are_counted),
        cmocka_unit_test(faces_of_polygons_are_named_by_the_polygon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
