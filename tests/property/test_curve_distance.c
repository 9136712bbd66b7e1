/* Compares distances between curves with closed forms, and with the distance in the opposite
 * direction, which uses another field. Also compares the distances with sampled distances, which
 * bound them from one side. */
#include "tests/support/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/curve_distance.h"
#include "mesh/canonical.h"
#include "mesh/segment.h"
#include "tests/samples/samples.h"
#include "tests/support/shared.h"
#include "tests/support/field.h"

/* Returns a curve of shortest paths through random points of one component. */
static struct gd_curve random_curve(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                                    uint32_t count, bool closed, struct rng *rng)
{
    struct gd_point points[8];
    uint32_t used = 0;
    while (used < count) {
        points[used] = test_point(mesh, test_random_place(polygons, rng));
        if (gd_point_component(mesh, &points[used]) == gd_point_component(mesh, &points[0])) used++;
    }
    struct gd_curve_request request = {
        .kind = GD_CURVE_POINTS, .points = points, .count = count, .closed = closed};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    return curve;
}

static double sample(const struct gd_mesh *mesh, const struct gd_field *field,
                     const struct gd_curve *curve, int count, bool greatest)
{
    double best = greatest ? -1 : HUGE_VAL;
    uint32_t segments = gd_curve_seed_count(curve) - curve->count;
    check_ok(gd_field_distance(field, &curve->points[0], &best), NULL);
    for (uint32_t i = 0; i < segments; i++) {
        const struct gd_point *a = &curve->points[i], *b = &curve->points[(i + 1) % curve->count];
        struct gd__segment_location home;
        double from[3], to[3], weight[3], distance;
        assert_true(gd__segment_locate(mesh, a, b, &home));
        uint32_t side = 2 * home.edge;
        if (home.face == GD_NONE)
            home.face = mesh->side_face[gd__side_is_boundary(mesh, side) ? side + 1 : side];
        gd__point_weights(mesh, a, home.face, from);
        gd__point_weights(mesh, b, home.face, to);
        for (int n = 0; n <= count; n++) {
            for (int k = 0; k < 3; k++) weight[k] = from[k] + (to[k] - from[k]) * n / count;
            struct gd_point point = gd__point_of_face(mesh, home.face, weight);
            check_ok(gd_field_distance(field, &point, &distance), NULL);
            best = greatest ? fmax(best, distance) : fmin(best, distance);
        }
    }
    return best;
}

static struct gd_curve_distance least(const struct gd_field *field, const struct gd_curve *a,
                                      const struct gd_curve *b)
{
    struct gd_curve_distance found;
    check_ok(gd_curve_distance(field, a, b, NULL, &found), NULL);
    return found;
}

struct sums {
    /* The largest relative differences. `excess` is the amount by which the farthest distance
       exceeds the sampled distance. */
    double asymmetry, excess;
    double slant; /* largest deficit of an angle below a right angle */
    int meetings, pairs;
};

/* Records the angle between the shortest path and a curve. The angle is at least a right angle,
 * because otherwise a shorter path would exist. */
static void check_angle(const struct gd_curve *curve, double angle, struct sums *sums)
{
    assert_true(isnan(angle) == (curve->count == 1));
    if (curve->count > 1) sums->slant = fmax(sums->slant, M_PI / 2 - angle);
}

static void check_pair(const struct gd_mesh *mesh, const struct gd_curve *a,
                       const struct gd_curve *b, struct sums *sums)
{
    struct gd_field *of_a = test_field_of_curve(mesh, a, 0),
                    *of_b = test_field_of_curve(mesh, b, 0);
    struct gd_curve_distance ab = least(of_a, a, b), ba = least(of_b, b, a);
    double scale = mesh->summary.edge_length.mean;
    sums->pairs++;
    if (ab.distance == 0 || ba.distance == 0) {
        assert_true(ab.distance <= 1e-13 * scale && ba.distance <= 1e-13 * scale);
        assert_int_equal(ab.path.count, 1);
        assert_true(isnan(ab.a.angle) && isnan(ab.b.angle));
        sums->meetings++;
    } else {
        sums->asymmetry = fmax(sums->asymmetry, check_close(ab.distance, ba.distance, 1e-9));
        check_close(ab.path.length, ab.distance, 1e-9);
        assert_true(gd_point_equal(&ab.path.points[0], &ab.a.point));
        assert_true(gd_point_equal(&ab.path.points[ab.path.count - 1], &ab.b.point));
        check_angle(a, ab.a.angle, sums);
        check_angle(b, ab.b.angle, sums);
    }
    assert_true(ab.a.parameter >= 0 && ab.a.parameter <= 1 && ab.b.parameter >= 0 &&
                ab.b.parameter <= 1);
    double coarse = sample(mesh, of_a, b, 10, false);
    assert_true(coarse >= ab.distance - 1e-13 * scale);
    struct gd_curve_distance far;
    check_ok(gd_curve_farthest(of_a, a, b, NULL, &far), NULL);
    double sampled = sample(mesh, of_a, b, 50, true);
    assert_true(sampled <= far.distance * (1 + 1e-12));
    sums->excess = fmax(sums->excess, (far.distance - sampled) / far.distance);
    double there;
    check_ok(gd_field_distance(of_a, &far.b.point, &there), NULL);
    check_close(there, far.distance, 1e-12);
    gd_curve_distance_free(&ab);
    gd_curve_distance_free(&ba);
    gd_curve_distance_free(&far);
    gd_field_release(of_a);
    gd_field_release(of_b);
}

static void check_mesh(const struct gd_polygons *polygons, int pairs, struct rng *rng,
                       struct sums *sums)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    for (int i = 0; i < pairs; i++) {
        struct gd_curve a = random_curve(mesh, polygons, 1 + rng_below(rng, 3), rng_below(rng, 2),
                                         rng),
                        b;
        do {
            b = random_curve(mesh, polygons, 1 + rng_below(rng, 3), rng_below(rng, 2), rng);
        } while (gd_point_component(mesh, &a.points[0]) != gd_point_component(mesh, &b.points[0]) &&
                 (gd_curve_free(&b), true));
        check_pair(mesh, &a, &b, sums);
        gd_curve_free(&a);
        gd_curve_free(&b);
    }
    gd_mesh_release(mesh);
}

static void tell(const struct sums *sums)
{
    print_message("# %d pairs, %d meet; asymmetry %.1e; slant %.1e; samples miss the greatest by "
                  "up to %.1e\n",
                  sums->pairs, sums->meetings, sums->asymmetry, sums->slant, sums->excess);
    assert_true(sums->slant < 1e-6);
}

static void random_curves(void **state)
{
    (void)state;
    struct rng rng = {21};
    struct sums sums = {0};
    for (uint32_t i = 0; i < 60; i++) {
        struct gd_polygons polygons;
        check_ok(sample_tangle(40 + 3 * i, 100 + i, &polygons), NULL);
        check_mesh(&polygons, 4, &rng, &sums);
        gd_polygons_free(&polygons);
    }
    tell(&sums);
    assert_true(sums.meetings > 10 && sums.pairs > 2 * sums.meetings);
}

static void shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"spot", "fandisk", "rocker-arm"};
    struct rng rng = {22};
    struct sums sums = {0};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        struct gd_polygons polygons = test_shared_polygons(names[n]);
        check_mesh(&polygons, 4, &rng, &sums);
        gd_polygons_free(&polygons);
    }
    tell(&sums);
}

/* --- closed forms ----------------------------------------------------------------------------- */

static struct gd_curve line(const struct gd_mesh *mesh, double x0, double y0, double x1, double y1)
{
    struct gd_point points[2] = {test_point_near(mesh, x0, y0, 0),
                                 test_point_near(mesh, x1, y1, 0)};
    struct gd_curve_request request = {.kind = GD_CURVE_POINTS, .points = points, .count = 2};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    return curve;
}

/* Tests segments in a plane that are separate, touch or cross. */
static void lines_in_the_plane(void **state)
{
    (void)state;
    static const struct {
        double a[4], b[4], distance, at_a, at_b, angle_a, angle_b, farthest;
    } cases[] = {
        /* b is perpendicular to a, above it */
        {{0.1, 0.2, 1.9, 0.2}, {0.7, 0.5, 0.7, 0.9}, 0.3, 1. / 3, 0, M_PI / 2, M_PI, 0.7},
        /* the segments cross at right angles */
        {{0.1, 0.4, 1.9, 0.4}, {0.5, 0.1, 0.5, 0.9}, 0, 2. / 9, 3. / 8, NAN, NAN, 0.5},
        /* the nearest points are ends of the segments */
        {{0.1, 0.1, 0.4, 0.1},
         {0.7, 0.5, 1.3, 1.3},
         0.5,
         1,
         0,
         M_PI - 0.927295218001612,
         M_PI,
         1.5},
        /* b begins on a */
        {{0.1, 0.4, 1.9, 0.4}, {1, 0.4, 1, 0.9}, 0, 0.5, 0, NAN, NAN, 0.5},
    };
    struct gd_polygons polygons;
    check_ok(sample_grid(19, 13, 2, 1.5, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct gd_curve a = line(mesh, cases[i].a[0], cases[i].a[1], cases[i].a[2], cases[i].a[3]),
                        b = line(mesh, cases[i].b[0], cases[i].b[1], cases[i].b[2], cases[i].b[3]);
        struct gd_field *field = test_field_of_curve(mesh, &a, 0);
        struct gd_curve_distance found = least(field, &a, &b), far;
        assert_true(fabs(found.distance - cases[i].distance) < 1e-14);
        assert_true(fabs(found.a.parameter - cases[i].at_a) < 1e-12);
        assert_true(fabs(found.b.parameter - cases[i].at_b) < 1e-12);
        assert_true(isnan(cases[i].angle_a) ? isnan(found.a.angle)
                                            : fabs(found.a.angle - cases[i].angle_a) < 1e-9);
        assert_true(isnan(cases[i].angle_b) ? isnan(found.b.angle)
                                            : fabs(found.b.angle - cases[i].angle_b) < 1e-9);
        check_ok(gd_curve_farthest(field, &a, &b, NULL, &far), NULL);
        check_close(far.distance, cases[i].farthest, 1e-12);
        gd_curve_distance_free(&found);
        gd_curve_distance_free(&far);
        gd_curve_free(&a);
        gd_curve_free(&b);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests the two boundaries of a cylinder. Also tests a request for one curve with the field of
 * another curve. */
static void boundaries(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_cylinder(1, 3, 24, 7, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_curve loop[2];
    for (uint32_t i = 0; i < 2; i++)
        check_ok(gd_curve_resolve(
                     mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY, .boundary = i},
                     NULL, &loop[i], NULL),
                 NULL);
    struct gd_field *field = test_field_of_curve(mesh, &loop[0], 0);
    struct gd_curve_distance found = least(field, &loop[0], &loop[1]);
    check_close(found.distance, 3, 1e-14);
    assert_true(fabs(found.a.angle - M_PI / 2) < 1e-9 && fabs(found.b.angle - M_PI / 2) < 1e-9);
    gd_curve_distance_free(&found);
    check_ok(gd_curve_farthest(field, &loop[0], &loop[1], NULL, &found), NULL);
    check_close(found.distance, 3, 1e-14);
    gd_curve_distance_free(&found);
    assert_int_equal(gd_curve_distance(field,
                                       &(struct gd_curve){.points = loop[0].points, .count = 2},
                                       &loop[1], NULL, &found),
                     GD_INVALID_ARGUMENT);
    for (int i = 0; i < 2; i++) gd_curve_free(&loop[i]);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_in_the_plane), cmocka_unit_test(boundaries),
        cmocka_unit_test(random_curves), cmocka_unit_test(shared_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
