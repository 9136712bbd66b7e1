/* Tests angles between directions. In a plane, they are Euclidean. Around an apex, they are at most
 * half of the total angle. */
#include "tests/support/test.h"

#include <math.h>

#include "line/turn.h"
#include "tests/samples/samples.h"

static struct gd_point at(const struct gd_mesh *mesh, double x, double y, double z)
{
    struct gd_point point;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, z}, 1e-9, &point, NULL), NULL);
    return point;
}

static void in_the_plane(void **state)
{
    (void)state;
    /* the points are a vertex, a point of an edge, and a point of a face */
    static const double places[][2] = {{0.5, 0.5}, {0.4, 0.5}, {0.46, 0.53}};
    struct rng rng = {4};
    struct gd_polygons polygons;
    check_ok(sample_grid(10, 10, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        double x = places[i][0], y = places[i][1];
        struct gd_point point = at(mesh, x, y, 0);
        for (int n = 0; n < 100; n++) {
            double a = rng_between(&rng, -M_PI, M_PI), b = rng_between(&rng, -M_PI, M_PI), r = 1e-3;
            struct gd_point p = at(mesh, x + r * cos(a), y + r * sin(a), 0),
                            q = at(mesh, x + r * cos(b), y + r * sin(b), 0);
            assert_true(fabs(gd__turn_between(mesh, &point, &p, &q) -
                             fabs(remainder(a - b, 2 * M_PI))) < 1e-11);
        }
    }
    struct gd_point middle = at(mesh, 0.5, 0.5, 0), far = at(mesh, 0.9, 0.1, 0),
                    near = at(mesh, 0.51, 0.5, 0);
    assert_true(isnan(gd__turn_between(mesh, &middle, &near, &far)));
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* In a pyramid of four sectors, the directions to opposite corners differ by half of the total
 * angle. */
static void around_an_apex(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_cone(1, 1, 4, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point apex = at(mesh, 0, 0, 1), corner[3];
    for (int i = 0; i < 3; i++) corner[i] = at(mesh, cos(i * M_PI_2), sin(i * M_PI_2), 0);
    double sector = acos(0.5); /* angle of an equilateral triangle */
    check_close(gd__turn_between(mesh, &apex, &corner[0], &corner[1]), sector, 1e-14);
    check_close(gd__turn_between(mesh, &apex, &corner[0], &corner[2]), 2 * sector, 1e-14);
    /* at the boundary the angle is measured across the surface only */
    double rim = gd__turn_between(mesh, &corner[1], &corner[0], &corner[2]);
    check_close(rim, 2 * sector, 1e-14);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(in_the_plane),
                                       cmocka_unit_test(around_an_apex)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
