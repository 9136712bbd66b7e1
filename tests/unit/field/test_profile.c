#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "field/profile.h"
#include "gd/curve.h"
#include "mesh/canonical.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

static struct gd_curve shortest(const struct gd_mesh *mesh, struct gd_point from,
                                struct gd_point to)
{
    struct gd_point points[] = {from, to};
    struct gd_curve curve;
    struct gd_curve_request request = {.kind = GD_CURVE_POINTS, .points = points, .count = 2};
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    return curve;
}

/* Returns the field's distance at the fraction s of the segment from a to b. */
static double distance_along(const struct gd_field *field, const struct gd_point *a,
                             const struct gd_point *b, double s)
{
    struct gd__segment_location home;
    double from[3], to[3], distance;
    assert_true(gd__segment_locate(field->mesh, a, b, &home));
    uint32_t side = 2 * home.edge;
    if (home.face == GD_NONE)
        home.face =
            field->mesh->side_face[gd__side_is_boundary(field->mesh, side) ? side + 1 : side];
    gd__point_weights(field->mesh, a, home.face, from);
    gd__point_weights(field->mesh, b, home.face, to);
    for (int k = 0; k < 3; k++) from[k] += s * (to[k] - from[k]);
    struct gd_point point = gd__point_of_face(field->mesh, home.face, from);
    check_ok(gd_field_distance(field, &point, &distance), NULL);
    return distance;
}

static void check_place(double told, double field, double length)
{
    /* where the curve crosses the segment, the distance is 0, so it has no relative error */
    if (fabs(told - field) > 1e-14 * length) check_close(told, field, 1e-9);
}

/* Checks that the profile's extremes equal the field's distances at the same points. Checks that no
 * sample is smaller or larger than the extremes. */
static void check_segment(const struct gd_field *field, const struct gd_point *a,
                          const struct gd_point *b)
{
    struct gd__profile profile = {0};
    check_ok(gd__profile_of(field, a, b, &profile), NULL);
    struct gd__profile_place least = gd__profile_least(&profile),
                             greatest = gd__profile_greatest(&profile);
    double length = profile.length * field->mesh->unit, low = least.distance * field->mesh->unit,
           high = greatest.distance * field->mesh->unit;
    check_place(low, distance_along(field, a, b, least.t / profile.length), length);
    check_place(high, distance_along(field, a, b, greatest.t / profile.length), length);
    for (int i = 0; i <= 10; i++) {
        double distance = distance_along(field, a, b, i / 10.), slack = 1e-12 * (high + length);
        assert_true(distance <= high + slack && distance >= low - slack);
    }
    gd__profile_destroy(&profile);
}

/* The source is a long curve, so paths from many of its parts reach the segment, side by side. */
static void along_curves(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct rng rng = {3};
    check_ok(sample_icosphere(3, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int n = 0; n < 60; n++) {
        struct gd_point end[4];
        for (int i = 0; i < 4; i++) end[i] = test_point(mesh, test_random_place(&polygons, &rng));
        struct gd_curve a = shortest(mesh, end[0], end[1]), b = shortest(mesh, end[2], end[3]);
        struct gd_field *field = test_field_of_curve(mesh, &a, 0);
        for (uint32_t i = 0; i + 1 < b.count; i++)
            check_segment(field, &b.points[i], &b.points[i + 1]);
        gd_field_release(field);
        gd_curve_free(&a);
        gd_curve_free(&b);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(along_curves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
