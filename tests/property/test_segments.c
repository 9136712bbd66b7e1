/* Tests segments as sources. Compares distances to curves with closed forms and with fields in the
 * opposite direction. Also builds a field from a point: its minimum along a curve must equal the
 * distance of the point from the curve. */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gd/cpu.h"
#include "gd/field.h"
#include "gd/locate.h"
#include "gd/query.h"
#include "gd/trace.h"
#include "mesh/canonical.h"
#include "mesh/segment.h"
#include "tests/samples/samples.h"
#include "tests/support/shared.h"
#include "tests/support/field.h"

/* --- curves ----------------------------------------------------------------------------------- */

/* Seeds of a polyline: its points and the segments between them. */
struct curve {
    struct gd_seed seeds[20000];
    uint32_t count;
};

static struct curve curve;

static void put_segment(const struct gd_point *a, const struct gd_point *b)
{
    curve.seeds[curve.count++] = (struct gd_seed){.point = *a, .end = *b, .is_segment = true};
    curve.seeds[curve.count++] = (struct gd_seed){.point = *b};
}

/* Appends the shortest path between two points. */
static void put_geodesic(const struct gd_mesh *mesh, struct gd_point from, struct gd_point to)
{
    struct gd_pair_answer answer;
    check_ok(gd_pair_solve(
                 mesh, &(struct gd_pair_request){.from = &from, .to = &to, .output = GD_PAIR_PATH},
                 NULL, &answer, NULL),
             NULL);
    curve.seeds[curve.count++] = (struct gd_seed){.point = from};
    for (uint32_t i = 0; i + 1 < answer.path.count; i++)
        put_segment(&answer.path.points[i], &answer.path.points[i + 1]);
    gd_pair_answer_free(&answer);
}

/* --- the oracle ------------------------------------------------------------------------------- */

static struct gd_point between(const struct gd_mesh *mesh, const struct gd_seed *segment, double s)
{
    struct gd__segment_location home;
    double from[3], to[3], weight[3];
    assert_true(gd__segment_locate(mesh, &segment->point, &segment->end, &home));
    uint32_t side = 2 * home.edge;
    if (home.face == GD_NONE)
        home.face = mesh->side_face[gd__side_is_boundary(mesh, side) ? side + 1 : side];
    gd__point_weights(mesh, &segment->point, home.face, from);
    gd__point_weights(mesh, &segment->end, home.face, to);
    for (int k = 0; k < 3; k++) weight[k] = (1 - s) * from[k] + s * to[k];
    return gd__point_of_face(mesh, home.face, weight);
}

/* Returns the minimum of a field along a segment by bisection. The slope of the field is at most 1,
 * which gives a lower bound for each part. Skips parts whose bound exceeds the minimum so far. */
static double least_along(const struct gd_mesh *mesh, const struct gd_field *field,
                          const struct gd_seed *segment, double best)
{
    struct gd_vec3 a = gd_point_position(mesh, &segment->point),
                   b = gd_point_position(mesh, &segment->end);
    double length = gd_vec3_length(gd_vec3_sub(b, a)), stack[128][4];
    int depth = 0;
    double d0 = test_distance(field, &segment->point), d1 = test_distance(field, &segment->end);
    best = fmin(best, fmin(d0, d1));
    memcpy(stack[depth++], (double[4]){0, 1, d0, d1}, sizeof stack[0]);
    while (depth) {
        double s0 = stack[--depth][0], s1 = stack[depth][1], e0 = stack[depth][2],
               e1 = stack[depth][3];
        if (0.5 * (e0 + e1 - (s1 - s0) * length) >= best * (1 - 1e-10) ||
            (s1 - s0) * length < 1e-7 * best || s1 - s0 < 1e-13)
            continue;
        double middle = 0.5 * (s0 + s1);
        struct gd_point point = between(mesh, segment, middle);
        double e = test_distance(field, &point);
        best = fmin(best, e);
        memcpy(stack[depth++], (double[4]){s0, middle, e0, e}, sizeof stack[0]);
        memcpy(stack[depth++], (double[4]){middle, s1, e, e1}, sizeof stack[0]);
    }
    return best;
}

static double least_along_curve(const struct gd_mesh *mesh, const struct gd_field *field)
{
    double best = HUGE_VAL;
    for (uint32_t i = 0; i < curve.count; i++)
        if (!curve.seeds[i].is_segment)
            best = fmin(best, test_distance(field, &curve.seeds[i].point));
    for (uint32_t i = 0; i < curve.count; i++)
        if (curve.seeds[i].is_segment) best = least_along(mesh, field, &curve.seeds[i], best);
    return best;
}

/* Checks that an offset of 0.7 increases all distances by 0.7. With the offset, the distance
 * through a segment and the distance through its ends differ by rounding. */
static void check_offset(const struct gd_mesh *mesh, const struct gd_field *field,
                         const struct gd_polygons *polygons, struct rng *rng)
{
    static struct curve moved;
    moved = curve;
    for (uint32_t i = 0; i < moved.count; i++) moved.seeds[i].offset = 0.7;
    struct gd_field *later = test_field(mesh, moved.seeds, moved.count, 0);
    for (int i = 0; i < 20; i++) {
        struct gd_point p = test_point(mesh, test_random_place(polygons, rng));
        check_close(test_distance(later, &p), test_distance(field, &p) + 0.7, 1e-12);
    }
    gd_field_release(later);
}

/* Computes the distances of random points from the curve. Compares them with the minima of the
 * points' own fields along the curve, and checks that paths end on the curve. Returns the largest
 * relative error. */
static double check_against_points(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                                   int count, struct rng *rng)
{
    struct gd_field *field = test_field(mesh, curve.seeds, curve.count, 0);
    double worst = 0;
    for (int i = 0; i < count; i++) {
        struct gd_point p = test_point(mesh, test_random_place(polygons, rng));
        struct gd_field *back = test_field(mesh, &(struct gd_seed){.point = p}, 1, 0);
        double distance = test_distance(field, &p);
        double least = least_along_curve(mesh, back);
        /* the point is on the curve, up to rounding */
        if (least < 1e-12 * mesh->summary.edge_length.mean) {
            assert_true(distance < 1e-12 * mesh->summary.edge_length.mean);
            gd_field_release(back);
            continue;
        }
        worst = fmax(worst, check_close(distance, least, 1e-9));
        struct gd_path path;
        check_ok(gd_field_path(field, &p, &path), NULL);
        check_close(path.length, distance, 1e-9);
        double there = test_distance(back, &path.points[path.count - 1]);
        check_close(there, distance, 1e-9);
        uint32_t seed;
        double again;
        check_ok(gd_field_nearest(field, &p, &again, &seed), NULL);
        assert_true(again == distance && seed < curve.count);
        gd_path_free(&path);
        gd_field_release(back);
    }
    check_offset(mesh, field, polygons, rng);
    gd_field_release(field);
    return worst;
}

/* --- tests ------------------------------------------------------------------------------------ */

/* Appends random segments. Each segment begins at a random point of a random face and ends at
 * another point of the same face. */
static void put_random_segments(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                                int count, struct rng *rng)
{
    for (int i = 0; i < count; i++) {
        struct test_place a = {.face = rng_below(rng, polygons->polygon_count)},
                          b = {.face = a.face};
        for (int end = 0; end < 2; end++) {
            double *weight = end ? b.weight : a.weight, sum = 0;
            /* the point lies in the face, on an edge, or at a corner */
            uint32_t zeros = rng_below(rng, 3), first = rng_below(rng, 3);
            for (uint32_t k = 0; k < 3; k++)
                weight[(first + k) % 3] = k < zeros ? 0 : 0.01 + rng_unit(rng);
            for (int k = 0; k < 3; k++) sum += weight[k];
            for (int k = 0; k < 3; k++) weight[k] /= sum;
        }
        struct gd_point from = test_point(mesh, a), to = test_point(mesh, b);
        if (gd_point_equal(&from, &to)) continue;
        curve.seeds[curve.count++] = (struct gd_seed){.point = from};
        put_segment(&from, &to);
    }
}

/* Appends a chain of shortest paths between random points. */
static void put_random_chain(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                             int count, struct rng *rng)
{
    struct gd_point from = test_point(mesh, test_random_place(polygons, rng));
    for (int i = 0; i < count; i++) {
        struct gd_point to = test_point(mesh, test_random_place(polygons, rng));
        if (curve.count) curve.count--; /* the last point is the first one of the next path */
        put_geodesic(mesh, from, to);
        from = to;
    }
}

/* Tests a few segments on small random surfaces with boundaries, saddles and slivers. */
static void random_segments(void **state)
{
    (void)state;
    struct rng rng = {5};
    double worst = 0;
    for (uint32_t i = 0; i < 60; i++) {
        struct gd_polygons polygons;
        check_ok(sample_tangle(40 + 4 * i, i, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        curve.count = 0;
        if (i % 3 == 2)
            put_random_chain(mesh, &polygons, 1 + (int)i % 5, &rng);
        else
            put_random_segments(mesh, &polygons, 1 + (int)i % 4, &rng);
        if (curve.count) worst = fmax(worst, check_against_points(mesh, &polygons, 5, &rng));
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# worst relative error %.1e\n", worst);
}

/* Tests that all kernels compute the same distances bit for bit. They do the same operations in the
 * same order. */
static void kernels_agree(void **state)
{
    (void)state;
    static const char *const kernels[] = {"baseline", "avx2", "avx512"};
    struct rng rng = {9};
    struct gd_polygons polygons;
    check_ok(sample_terrain(40, 0.3, 3, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    curve.count = 0;
    put_random_segments(mesh, &polygons, 12, &rng);
    struct gd_point points[500];
    for (int i = 0; i < 500; i++) points[i] = test_point(mesh, test_random_place(&polygons, &rng));
    double first[500];
    int compared = 0;
    for (int k = 0; k < 3; k++) {
        if (gd_cpu_select(kernels[k])) continue;
        struct gd_field *field = test_field(mesh, curve.seeds, curve.count, 0);
        for (int i = 0; i < 500; i++) {
            double distance = test_distance(field, &points[i]);
            if (k == 0) first[i] = distance;
            assert_true(distance == first[i]);
        }
        gd_field_release(field);
        compared++;
    }
    print_message("# %d kernels compared\n", compared);
    check_ok(gd_cpu_select("auto"), NULL);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests distances to segments in a plane at several scales. */
static void planes(void **state)
{
    (void)state;
    static const double scales[] = {1e-6, 1, 1e6};
    struct rng rng = {11};
    for (size_t n = 0; n < sizeof scales / sizeof *scales; n++) {
        struct gd_polygons polygons;
        check_ok(sample_grid(17, 13, 3 * scales[n], 2 * scales[n], &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_point ends[2];
        for (int i = 0; i < 2; i++) ends[i] = test_point(mesh, test_random_place(&polygons, &rng));
        curve.count = 0;
        put_geodesic(mesh, ends[0], ends[1]);
        struct gd_field *field = test_field(mesh, curve.seeds, curve.count, 0);
        struct gd_vec3 a = gd_point_position(mesh, &ends[0]),
                       span = gd_vec3_sub(gd_point_position(mesh, &ends[1]), a);
        for (int i = 0; i < 300; i++) {
            struct gd_point p = test_point(mesh, test_random_place(&polygons, &rng));
            struct gd_vec3 from = gd_vec3_sub(gd_point_position(mesh, &p), a);
            double part = gd_vec3_dot(from, span) / gd_vec3_dot(span, span);
            part = part < 0 ? 0 : part > 1 ? 1 : part;
            double expected = gd_vec3_length(gd_vec3_along(from, -part, span)),
                   distance = test_distance(field, &p);
            assert_true(fabs(distance - expected) <= 1e-12 * scales[n]);
        }
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static struct gd_point point_near(const struct gd_mesh *mesh, struct gd_vec3 place)
{
    struct gd_point point;
    check_ok(gd_locate_nearest(mesh, place, -1, &point, NULL), NULL);
    return point;
}

/* A curve of two segments has a corner at `joint`. Checks distances along the line that leaves the
 * corner at a right angle. The wedges whose sources are the two segments end at this line. `bend`
 * has the ends and the corner of the curve. Returns the largest relative error. */
static double check_opposite(const struct gd_mesh *mesh, const struct gd_field *field,
                             const struct gd_point *joint, struct gd_vec3 across,
                             const struct gd_vec3 bend[3])
{
    struct gd_direction ahead;
    struct gd_trace trace;
    check_ok(gd_direction_along(mesh, joint, across, &ahead, NULL), NULL);
    check_ok(gd_trace_follow(
                 mesh, &(struct gd_trace_request){.start = joint, .ahead = &ahead, .length = 0.4},
                 NULL, &trace, NULL),
             NULL);
    double worst = 0;
    for (uint32_t i = 1; i < trace.path.count; i++) {
        struct gd_vec3 place = gd_point_position(mesh, &trace.path.points[i]);
        double expected = fmin(test_distance_to_segment(place, bend[0], bend[1]),
                               test_distance_to_segment(place, bend[1], bend[2]));
        double error = fabs(test_distance(field, &trace.path.points[i]) - expected) / expected;
        worst = fmax(worst, error);
    }
    gd_trace_free(&trace);
    assert_true(worst <= 1e-11);
    return worst;
}

/* Tests straight lines across edges of a plane, and lines with a corner of 3e-4 to 3e-12
 * radians. */
static void joints(void **state)
{
    (void)state;
    static const double corners[] = {0, 3e-4, 3e-8, 3e-12};
    struct rng rng = {12};
    double worst = 0;
    struct gd_polygons polygons;
    check_ok(sample_grid(19, 17, 3, 2, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 80; i++) {
        double angle = 6 * rng_unit(&rng), turned = angle + corners[i % 4];
        struct gd_vec3 middle = {1 + rng_unit(&rng), 0.7 + 0.6 * rng_unit(&rng), 0},
                       along = {cos(angle), sin(angle), 0};
        struct gd_point bend[3] = {
            point_near(mesh, gd_vec3_along(middle, -0.5, along)), point_near(mesh, middle),
            point_near(mesh,
                       gd_vec3_along(middle, 0.5, (struct gd_vec3){cos(turned), sin(turned), 0}))};
        struct gd_vec3 place[3];
        for (int k = 0; k < 3; k++) place[k] = gd_point_position(mesh, &bend[k]);
        curve.count = 0;
        put_geodesic(mesh, bend[0], bend[1]);
        curve.count--;
        put_geodesic(mesh, bend[1], bend[2]);
        struct gd_field *field = test_field(mesh, curve.seeds, curve.count, 0);
        for (uint32_t k = 2; k + 2 < curve.count; k += 2)
            for (int side = -1; side <= 1; side += 2)
                worst =
                    fmax(worst, check_opposite(mesh, field, &curve.seeds[k].point,
                                               (struct gd_vec3){-side * along.y, side * along.x, 0},
                                               place));
        gd_field_release(field);
    }
    print_message("# worst relative error %.1e\n", worst);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Tests that the engine rejects a segment whose ends have no common face or are equal. */
static void invalid_segments_are_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(4, 4, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point a = test_point(mesh, (struct test_place){.face = 0, .weight = {1, 0, 0}}),
                    b = test_point(mesh,
                                   (struct test_place){.face = 31, .weight = {0.2, 0.3, 0.5}});
    struct gd_point ends[2] = {b, a};
    for (int i = 0; i < 2; i++) {
        struct gd_seed seed = {.point = a, .end = ends[i], .is_segment = true};
        struct gd_field *field;
        struct gd_detail detail = {0};
        assert_int_equal(gd_field_build(mesh,
                                        &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                        NULL, &field, &detail),
                         GD_INVALID_ARGUMENT);
        assert_non_null(strstr(detail.text, "segment"));
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void geodesics_on_shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"spot", "fandisk", "rocker-arm", "stanford-bunny"};
    struct rng rng = {7};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        struct gd_polygons polygons = test_shared_polygons(names[n]);
        struct gd_mesh *mesh = test_mesh(&polygons);
        curve.count = 0;
        for (int i = 0; i < 2; i++)
            put_geodesic(mesh, test_point(mesh, test_random_place(&polygons, &rng)),
                         test_point(mesh, test_random_place(&polygons, &rng)));
        double worst = check_against_points(mesh, &polygons, 5, &rng);
        print_message("# %s: %u seeds, worst relative error %.1e\n", names[n], curve.count, worst);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(planes),
                                       cmocka_unit_test(joints),
                                       cmocka_unit_test(random_segments),
                                       cmocka_unit_test(kernels_agree),
                                       cmocka_unit_test(invalid_segments_are_refused),
                                       cmocka_unit_test(geodesics_on_shared_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
