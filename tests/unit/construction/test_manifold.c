#include "tests/unit/mesh/shapes.h"

static void two_open_fans_at_a_vertex_are_refused(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {-1, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 0, 4, 3};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_VERTEX);
    expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(0, 0),
                    "the faces around vertex 0 form 2 separate fans");
}

/* Uses tetrahedra that share only their last vertex. */
static void closed_fans_at_a_vertex_are_refused(void **state)
{
    (void)state;
    double positions[][3] = {{1, 0, 1},   {-1, 1, 1},   {-1, -1, 1}, {1, 0, -1},
                             {-1, 1, -1}, {-1, -1, -1}, {0, 0, 0}};
    uint32_t corners[] = {0, 1, 2, 1, 0, 6, 2, 1, 6, 0, 2, 6, 3, 5, 4, 4, 6, 3, 5, 6, 4, 3, 6, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_VERTEX);
    expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(6, 0),
                    "vertex 6 form 2 separate fans");
}

static void a_closed_and_an_open_fan_at_a_vertex_are_refused(void **state)
{
    (void)state;
    double positions[][3] = {{1, 0, 1}, {-1, 1, 1}, {-1, -1, 1},
                             {0, 0, 0}, {1, 1, -1}, {-1, 1, -1}};
    uint32_t corners[] = {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3, 3, 4, 5};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_VERTEX);
    expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(3, 0), "vertex 3");
}

static void three_fans_are_counted(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0},  {1, 0, 0},  {1, 1, 0}, {-1, 1, 0},
                             {-1, 2, 0}, {0, -1, 0}, {0, -1, 1}};
    uint32_t corners[] = {1, 2, 0, 3, 4, 0, 5, 6, 0};
    struct gd_polygons polygons = TRIANGLES(positions, corners);
    struct gd_detail detail = refuse(&polygons, GD_NON_MANIFOLD_VERTEX);
    expect_elements(&detail, GD_ELEMENT_VERTEX, 1, ONE_ELEMENT(0, 0), "3 separate fans");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_open_fans_at_a_vertex_are_refused),
        cmocka_unit_test(closed_fans_at_a_vertex_are_refused),
        cmocka_unit_test(a_closed_and_an_open_fan_at_a_vertex_are_refused),
        cmocka_unit_test(three_fans_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
