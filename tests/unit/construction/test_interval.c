#include "tests/unit/mesh/shapes.h"

#include "construction/interval.h"

enum { MOST = 12 };

static struct gd__interval_table table;

/* Triangulates the polygon with these corners in the plane z = 0. Returns the sum of the triangles'
 * unsigned areas, or -1 if no triangulation exists. Diagonals in `taken` are forbidden. */
static double cut(double (*positions)[3], uint32_t count, const uint32_t (*taken)[2],
                  uint32_t taken_count)
{
    uint32_t vertex[MOST], triangle[MOST][3];
    struct gd__ring_corner corner[MOST];
    struct gd__edge_set edges;
    assert_int_equal(gd__edge_set_create(MOST, &(struct gd__pace){0}, &edges), GD_OK);
    for (uint32_t i = 0; i < taken_count; i++)
        gd__edge_set_insert(&edges, taken[i][0], taken[i][1]);
    for (uint32_t i = 0; i < count; i++) vertex[i] = i;
    gd__ring_make((const double(*)[3])positions, vertex, count, corner);
    bool done = gd__interval_cut(&table, corner, 0, count, &edges, triangle);
    gd__edge_set_free(&edges);
    if (!done) return -1;
    double area = 0;
    for (uint32_t i = 0; i + 2 < count; i++) {
        const double *a = positions[triangle[i][0]], *b = positions[triangle[i][1]],
                     *c = positions[triangle[i][2]];
        area += fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    return area;
}

static void triangles_are_not_turned_over(void **state)
{
    (void)state;
    double arrow[][3] = {{0, 0, 0}, {4, -3, 0}, {1, 0, 0}, {4, 3, 0}};
    double comb[][3] = {{0, 0, 0},   {6, 0, 0}, {6, 4, 0},   {5, 0.5, 0}, {4, 4, 0},
                        {3, 0.5, 0}, {2, 4, 0}, {1, 0.5, 0}, {0, 4, 0}};
    expect_near(cut(arrow, 4, NULL, 0), 3, 1e-15);
    expect_near(cut(comb, 9, NULL, 0), 13.5, 1e-14);
}

static void well_shaped_triangles_are_preferred(void **state)
{
    (void)state;
    double kite[][3] = {{-1, 0, 0}, {0, -9, 0}, {1, 0, 0}, {0, 9, 0}};
    uint32_t vertex[] = {0, 1, 2, 3}, triangle[2][3];
    struct gd__ring_corner corner[4];
    struct gd__edge_set edges;
    assert_int_equal(gd__edge_set_create(MOST, &(struct gd__pace){0}, &edges), GD_OK);
    gd__ring_make((const double(*)[3])kite, vertex, 4, corner);
    assert_true(gd__interval_cut(&table, corner, 0, 4, &edges, triangle));
    gd__edge_set_free(&edges);
    for (int i = 0; i < 2; i++) { /* both triangulations contain the shorter diagonal 0-2 */
        bool has[4] = {false};
        for (int k = 0; k < 3; k++) has[triangle[i][k]] = true;
        assert_true(has[0] && has[2]);
    }
}

static void forbidden_diagonals_are_avoided_if_possible(void **state)
{
    (void)state;
    double pentagon[5][3] = {{0}};
    for (int i = 0; i < 5; i++)
        pentagon[i][0] = cos(i * 0.4 * M_PI), pentagon[i][1] = sin(i * 0.4 * M_PI);
    double area = 2.5 * sin(0.4 * M_PI);
    const uint32_t taken[][2] = {{1, 3}, {2, 4}, {0, 3}, {0, 2}};
    expect_near(cut(pentagon, 5, taken, 2), area, 1e-14);
    expect_near(cut(pentagon, 5, taken, 3), -1, 0);
    expect_near(cut(pentagon, 5, taken, 4), -1, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_are_not_turned_over),
        cmocka_unit_test(well_shaped_triangles_are_preferred),
        cmocka_unit_test(forbidden_diagonals_are_avoided_if_possible),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
