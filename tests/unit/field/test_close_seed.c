/* Tests distances in a plane between points that are close to each other and to a vertex or an
 * edge. The distances equal Euclidean distances to more digits than barycentric weights have. */
#include <math.h>

#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"
#include "tests/support/test.h"

enum { ROUNDS = 400 };

/* Builds six triangles around vertex 0 at the origin. Sets *corner to the other vertices, at
 * multiples of 60 degrees. */
static struct gd_mesh *open_hexagon(double (*corner)[2])
{
    double positions[7][3] = {{0, 0, 0}};
    uint32_t corners[18];
    for (uint32_t i = 0; i < 6; i++) {
        corner[i][0] = positions[i + 1][0] = cos(M_PI / 3 * i);
        corner[i][1] = positions[i + 1][1] = sin(M_PI / 3 * i);
        corners[3 * i] = 0;
        corners[3 * i + 1] = i + 1;
        corners[3 * i + 2] = 1 + (i + 1) % 6;
    }
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 7, .corners = corners, .polygon_count = 6};
    return test_mesh(&polygons);
}

struct place {
    struct gd_point point;
    double x, y;
};

/* Returns the point of sector i that has the weights a and b at the sector's two outer corners. */
static struct place place_at(const struct gd_mesh *mesh, double (*corner)[2], uint32_t i, double a,
                             double b)
{
    struct place place;
    uint32_t next = (i + 1) % 6;
    check_ok(gd_point_in_face(mesh, (struct gd_face){i}, (double[3]){1 - a - b, a, b}, &place.point,
                              NULL),
             NULL);
    place.x = a * corner[i][0] + b * corner[next][0];
    place.y = a * corner[i][1] + b * corner[next][1];
    return place;
}

static void check(const struct gd_mesh *mesh, const struct place *from, const struct place *to)
{
    struct gd_field *field = test_field_from(mesh, from->point);
    struct gd_path path;
    double expected = hypot(to->x - from->x, to->y - from->y);
    check_close(test_distance(field, &to->point), expected, 1e-12);
    check_ok(gd_field_path(field, &to->point, &path), NULL);
    check_close(path.length, expected, 1e-12);
    gd_path_free(&path);
    gd_field_release(field);
}

static void round_a_vertex(void **state)
{
    (void)state;
    double corner[6][2];
    struct gd_mesh *mesh = open_hexagon(corner);
    struct rng rng = {3};
    for (int round = 0; round < ROUNDS; round++) {
        double near = pow(10, -4 - round % 9);
        struct place place[2];
        for (int k = 0; k < 2; k++)
            place[k] = place_at(mesh, corner, rng_below(&rng, 6), near * rng_between(&rng, 0.1, 1),
                                near * rng_between(&rng, 0.1, 1));
        if (hypot(place[0].x - place[1].x, place[0].y - place[1].y) > 1e-3 * near)
            check(mesh, &place[0], &place[1]);
    }
    gd_mesh_release(mesh);
}

/* Measures distances from sector 0 to sector 1 across the middle of their common edge, far from any
 * vertex. */
static void across_an_edge(void **state)
{
    (void)state;
    double corner[6][2];
    struct gd_mesh *mesh = open_hexagon(corner);
    struct rng rng = {4};
    for (int round = 0; round < ROUNDS; round++) {
        double near = pow(10, -4 - round % 9), a = near * rng_between(&rng, 0.1, 1),
               b = near * rng_between(&rng, 0.1, 1);
        struct place from = place_at(mesh, corner, 0, a, 0.375),
                     to = place_at(mesh, corner, 1, 0.375, b);
        double x = a * corner[0][0] - b * corner[2][0], y = a * corner[0][1] - b * corner[2][1];
        /* the distance is computed from differences, not from positions */
        from.x = x, from.y = y, to.x = to.y = 0;
        check(mesh, &from, &to);
    }
    gd_mesh_release(mesh);
}

static void along_an_edge_and_to_its_vertex(void **state)
{
    (void)state;
    double corner[6][2];
    struct gd_mesh *mesh = open_hexagon(corner);
    for (int digits = 4; digits < 14; digits++) {
        struct place from = place_at(mesh, corner, 2, pow(10, -digits), 0),
                     to = place_at(mesh, corner, 2, 3 * pow(10, -digits), 0),
                     centre = {.point = test_vertex(mesh, 0)};
        check(mesh, &from, &to);
        check(mesh, &from, &centre);
        check(mesh, &centre, &to);
    }
    gd_mesh_release(mesh);
}

/* The faces around vertex 0 are some 1e5 times as long as wide. The side 2-3 is nearest to the
 * vertex; its distance is about 1. The shortest path between the two points passes through the
 * vertex. One point is farther from the vertex than half of the distance of the side, but the whole
 * path is shorter than this distance. */
static void through_a_vertex_of_needles(void **state)
{
    (void)state;
    double positions[9][3] = {
        {4e5, 0.99, -0.25}, {1.1e6, 1.83, -0.58}, {5e5, 1.96, 0.45},
        {0, 1.89, -0.7},    {-2e5, 1.04, -0.98},  {-1e5, -0.05, 0.61},
        {4e5, 0.07, 0.04},  {1e6, -0.26, 0.6},    {1.2e6, 0.8, -0.6},
    };
    uint32_t corners[24] = {0, 7, 8, 5, 6, 0, 3, 0, 2, 0, 4, 5, 3, 4, 0, 8, 1, 0, 1, 2, 0, 6, 7, 0};
    struct gd_polygons polygons = {
        .positions = positions, .position_count = 9, .corners = corners, .polygon_count = 8};
    struct gd_mesh *mesh = test_mesh(&polygons);
    double expected = 0;
    struct gd_point point[2];
    for (int k = 0; k < 2; k++) {
        const struct gd_vertex ends[2] = {{0}, {k ? 4 : 1}};
        double part = k ? 2.2e-8 : 1.21e-6, *a = positions[0], *b = positions[ends[1].index];
        check_ok(gd_point_on_edge(mesh, ends, part, &point[k], NULL), NULL);
        expected += part * sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                                (b[2] - a[2]) * (b[2] - a[2]));
    }
    for (int k = 0; k < 2; k++) {
        struct gd_field *field = test_field_from(mesh, point[k]);
        check_close(test_distance(field, &point[!k]), expected, 1e-14);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(round_a_vertex),
                                       cmocka_unit_test(across_an_edge),
                                       cmocka_unit_test(along_an_edge_and_to_its_vertex),
                                       cmocka_unit_test(through_a_vertex_of_needles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
