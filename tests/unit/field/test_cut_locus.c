/* Compares cut loci with closed forms on a box and in the plane, and the medial axes of random
 * polygons with a brute-force search. Tests the topology of cut loci on closed surfaces. */
#include "gd/cut_locus.h"

#include <math.h>
#include <stdlib.h>

#include "field/arrivals.h"
#include "mesh/topology.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"
#include "tests/support/test.h"
#include "tests/support/watch.h"

static const double promise = 1e-9, fine = 1e-6;

static struct gd_voronoi locus_of(const struct gd_field *field, double min_angle)
{
    struct gd_voronoi locus;
    const struct gd_cut_locus_options options = {fine, min_angle};
    check_ok(gd_cut_locus_trace(field, NULL, &options, NULL, &locus), NULL);
    return locus;
}

static double length_of(const struct gd_voronoi *locus)
{
    double length = 0;
    for (uint32_t i = 0; i < locus->bisector_count; i++) length += locus->bisectors[i].length;
    return length;
}

/* --- ends ------------------------------------------------------------------------------------- */

/* Returns end k of the lines: ends 2i and 2i + 1 belong to line i. */
static struct gd_vec3 end_of(const struct gd_mesh *mesh, const struct gd_voronoi *locus, uint32_t k)
{
    const struct gd_bisector *line = &locus->bisectors[k / 2];
    return gd_point_position(mesh, &line->points[k % 2 ? line->point_count - 1 : 0]);
}

/* Counts the points at which `degree` ends of open lines meet. */
static uint32_t places_of_degree(const struct gd_mesh *mesh, const struct gd_voronoi *locus,
                                 uint32_t degree)
{
    uint32_t ends = 2 * locus->bisector_count, found = 0;
    struct gd_vec3 *end = malloc(sizeof *end * (ends + (size_t)1));
    for (uint32_t k = 0; k < ends; k++) end[k] = end_of(mesh, locus, k);
    for (uint32_t k = 0; k < ends; k++) {
        uint32_t count = 0, first = ends;
        for (uint32_t i = 0; i < ends; i++) {
            if (locus->bisectors[i / 2].closed || gd_vec3_distance(end[i], end[k]) > promise)
                continue;
            count++;
            if (first == ends) first = i;
        }
        found += count == degree && first == k;
    }
    free(end);
    return found;
}

/* --- points on a box -------------------------------------------------------------------------- */

/* The cut locus of the middle of a cube's face consists of the edges that lead from this face to
 * the opposite face, and of the diagonals of the opposite face. */
static void middle_of_a_cubes_face(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 6; cells++) {
        const double values[SAMPLE_PARAMETERS] = {1, 1, 1, cells};
        struct gd_mesh *mesh = test_sample("box", values, NULL);
        struct gd_field *field = test_field_from(mesh, test_point_near(mesh, 0.5, 0.5, 1));
        struct gd_voronoi locus = locus_of(field, 0);
        check_close(length_of(&locus), 4 + 2 * M_SQRT2, promise);
        for (uint32_t i = 0; i < locus.bisector_count; i++) {
            for (uint32_t k = 0; k < locus.bisectors[i].point_count; k++) {
                struct gd_vec3 at = gd_point_position(mesh, &locus.bisectors[i].points[k]);
                double x = fabs(at.x - 0.5), y = fabs(at.y - 0.5);
                assert_true(fabs(x - y) < promise);
                assert_true(at.z < promise || fabs(x - 0.5) < promise);
            }
        }
        gd_voronoi_free(&locus);
        gd_field_release(field);
        gd_mesh_release(mesh);
    }
}

/* On a surface like a sphere the cut locus of a point is a tree. A ridge begins at each vertex,
 * because the total angle of each vertex is below 2 pi. In general position three ridges meet at
 * each node. */
static void trees_on_spheres(void **state)
{
    (void)state;
    for (uint32_t level = 0; level <= 3; level++) {
        const double values[SAMPLE_PARAMETERS] = {level, 1};
        struct gd_mesh *mesh = test_sample("icosphere", values, NULL);
        uint32_t vertices = gd_mesh_summary(mesh)->index_count;
        for (int trial = 0; trial < 4; trial++) {
            struct gd_point from = test_point_near(mesh, 0.1 + 0.07 * trial, 0.23 - 0.1 * trial, 1);
            struct gd_field *field = test_field_from(mesh, from);
            struct gd_voronoi locus = locus_of(field, 0);
            assert_int_equal(places_of_degree(mesh, &locus, 1), vertices);
            assert_int_equal(places_of_degree(mesh, &locus, 3), vertices - 2);
            assert_int_equal(locus.bisector_count, 2 * vertices - 3);
            gd_voronoi_free(&locus);
            gd_field_release(field);
        }
        gd_mesh_release(mesh);
    }
}

static bool is_on_boundary(const struct gd_mesh *mesh, const struct gd_point *point)
{
    const uint32_t *face = &mesh->side_face[2 * point->element];
    return point->kind == GD_POINT_EDGE && (face[0] == GD_NONE || face[1] == GD_NONE);
}

/* Counts the ends at which no other line ends. Omits ends at vertices and on the boundary. */
static uint32_t loose_ends(const struct gd_mesh *mesh, const struct gd_voronoi *locus)
{
    uint32_t ends = 2 * locus->bisector_count, found = 0;
    for (uint32_t k = 0; k < ends; k++) {
        const struct gd_bisector *line = &locus->bisectors[k / 2];
        const struct gd_point *point = &line->points[k % 2 ? line->point_count - 1 : 0];
        if (line->closed || point->kind == GD_POINT_VERTEX || is_on_boundary(mesh, point)) continue;
        bool is_loose = true;
        for (uint32_t i = 0; i < ends && is_loose; i++)
            is_loose = i == k || locus->bisectors[i / 2].closed ||
                       gd_vec3_distance(end_of(mesh, locus, i), end_of(mesh, locus, k)) > promise;
        found += is_loose;
    }
    return found;
}

/* On this torus, the angle of a ridge at a face's border differs much from its angle in the middle
 * of the face. The rounding error of the ridge's end depends on the angle at the end. */
static void no_loose_ends(void **state)
{
    (void)state;
    double sides = TEST_IS_SANITIZED ? 32 : 96;
    struct gd_mesh *mesh =
        test_sample("torus", (const double[SAMPLE_PARAMETERS]){sides, sides / 2, 1, 0.4}, NULL);
    struct gd_field *field = test_field_from(mesh, test_point_near(mesh, 0.11, 0.27, 0.9));
    struct gd_voronoi locus = locus_of(field, 0);
    assert_int_equal(loose_ends(mesh, &locus), 0);
    gd_voronoi_free(&locus);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Two paths to each point of the cut locus have equal lengths, on any surface. */
static void points_have_two_paths(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } cases[] = {{"torus", {24, 12, 1, 0.4}},
                 {"terrain", {20, 0.5, 3}},
                 {"obstacles", {5, 1, 3}},
                 {"scan", {2000, 0, 0.4, 0, 1, 1}},
                 {"box", {1, 2, 3, 2}}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct gd_mesh *mesh = test_sample(cases[c].name, cases[c].values, NULL);
        struct gd_field *field = test_field_from(mesh, test_point_near(mesh, 0.11, 0.27, 0.9));
        struct gd_voronoi locus = locus_of(field, 0.05);
        uint32_t points = 0, others = 0;
        assert_true(locus.bisector_count > 0);
        for (uint32_t i = 0; i < locus.bisector_count; i++) {
            for (uint32_t k = 1; k + 1 < locus.bisectors[i].point_count; k++) {
                bool is_cut;
                check_ok(gd__field_is_cut(field, &locus.bisectors[i].points[k], &is_cut), NULL);
                points++;
                others += !is_cut;
            }
        }
        assert_true(points > 10 && others <= points / 1000);
        gd_voronoi_free(&locus);
        gd_field_release(field);
        gd_mesh_release(mesh);
    }
}

/* A larger `min_angle` only removes branches. */
static void angles_thin_out(void **state)
{
    (void)state;
    struct gd_mesh *mesh =
        test_sample("torus", (const double[SAMPLE_PARAMETERS]){48, 24, 1, 0.4}, NULL);
    struct gd_field *field = test_field_from(mesh, test_point_near(mesh, 0.1, 0.9, 0.2));
    double before = INFINITY;
    for (double angle = 0; angle <= M_PI; angle += TEST_IS_SANITIZED ? 0.4 : 0.1) {
        struct gd_voronoi locus = locus_of(field, angle);
        double length = length_of(&locus);
        assert_true(length <= before);
        /* Only the ridges around the torus are left: two circles, and the ridges that join them. */
        if (angle > 0.35 && angle < 0.75) assert_true(length > 7 && length < 14);
        before = length;
        gd_voronoi_free(&locus);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* --- polygons in the plane -------------------------------------------------------------------- */

enum { CORNERS_MOST = 64 };

struct polygon {
    double at[CORNERS_MOST][2];
    uint32_t count;
};

static struct gd_mesh *square(uint32_t cells)
{
    struct gd_polygons polygons;
    check_ok(sample_grid(cells, cells, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static struct gd_field *field_of(const struct gd_mesh *mesh, const struct polygon *polygon)
{
    struct gd_point points[CORNERS_MOST];
    for (uint32_t i = 0; i < polygon->count; i++)
        points[i] = test_point_near(mesh, polygon->at[i][0], polygon->at[i][1], 0);
    const struct gd_curve_request request = {
        .kind = GD_CURVE_POINTS, .closed = true, .count = polygon->count, .points = points};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    struct gd_field *field = test_field_of_curve(mesh, &curve, 0);
    gd_curve_free(&curve);
    return field;
}

/* Returns the vector from (x, y) to the nearest place of side i. */
static void foot_on_side(const struct polygon *polygon, uint32_t i, double x, double y,
                         double out[2])
{
    const double *a = polygon->at[i], *b = polygon->at[(i + 1) % polygon->count];
    double dx = b[0] - a[0], dy = b[1] - a[1],
           t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy);
    t = fmin(fmax(t, 0), 1);
    out[0] = a[0] + t * dx - x;
    out[1] = a[1] + t * dy - y;
}

/* Finds the nearest place of the polygon, and the nearest place in a direction that differs from
 * the first direction by at least `least_angle`. Returns the difference of their distances. The
 * result is 0 on the medial axis and on the polygon. */
static double second_way(const struct polygon *polygon, double x, double y, double least_angle)
{
    double foot[CORNERS_MOST][2], best = INFINITY, second = INFINITY;
    uint32_t nearest = 0;
    for (uint32_t i = 0; i < polygon->count; i++) {
        foot_on_side(polygon, i, x, y, foot[i]);
        double away = hypot(foot[i][0], foot[i][1]);
        if (away < best) {
            best = away;
            nearest = i;
        }
    }
    for (uint32_t i = 0; i < polygon->count; i++) {
        const double *u = foot[nearest], *v = foot[i];
        double angle = atan2(fabs(u[0] * v[1] - u[1] * v[0]), u[0] * v[0] + u[1] * v[1]);
        if (angle >= least_angle) second = fmin(second, hypot(v[0], v[1]));
    }
    return best < fine ? 0 : second - best;
}

static double distance_to_locus(const struct gd_mesh *mesh, const struct gd_voronoi *locus,
                                double x, double y)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < locus->bisector_count; i++) {
        const struct gd_bisector *line = &locus->bisectors[i];
        for (uint32_t k = 1; k < line->point_count; k++)
            least =
                fmin(least, test_distance_to_segment((struct gd_vec3){x, y, 0},
                                                     gd_point_position(mesh, &line->points[k - 1]),
                                                     gd_point_position(mesh, &line->points[k])));
    }
    return least;
}

/* Bisects the segment from a to b. Moves both points to the place at which the nearest place of the
 * polygon jumps. Returns false if it does not jump between a and b. */
static bool find_jump(const struct polygon *polygon, double a[2], double b[2], double least_angle)
{
    for (int i = 0; i < 60; i++) {
        double m[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])}, foot[3][2];
        const double *at[3] = {a, m, b};
        for (int k = 0; k < 3; k++) {
            double best = INFINITY;
            for (uint32_t s = 0; s < polygon->count; s++) {
                double way[2];
                foot_on_side(polygon, s, at[k][0], at[k][1], way);
                if (hypot(way[0], way[1]) >= best) continue;
                best = hypot(way[0], way[1]);
                foot[k][0] = at[k][0] + way[0];
                foot[k][1] = at[k][1] + way[1];
            }
        }
        bool is_first = hypot(foot[0][0] - foot[1][0], foot[0][1] - foot[1][1]) >
                        hypot(foot[1][0] - foot[2][0], foot[1][1] - foot[2][1]);
        for (int e = 0; e < 2; e++) (is_first ? b : a)[e] = m[e];
    }
    return second_way(polygon, a[0], a[1], least_angle) < promise;
}

/* Each point of the cut locus has two nearest places of the polygon. Conversely, if the nearest
 * place jumps between two random points of the plane, the cut locus has a point at the jump. */
static void check_medial_axis(const struct gd_mesh *mesh, const struct polygon *polygon)
{
    static const double least_angle = 0.01;
    struct gd_field *field = field_of(mesh, polygon);
    struct gd_voronoi locus = locus_of(field, 0);
    for (uint32_t i = 0; i < locus.bisector_count; i++) {
        for (uint32_t k = 0; k < locus.bisectors[i].point_count; k++) {
            struct gd_vec3 at = gd_point_position(mesh, &locus.bisectors[i].points[k]);
            double off = second_way(polygon, at.x, at.y, 0.5e-3);
            if (off >= promise) fail_msg("(%.12g, %.12g) is off by %g", at.x, at.y, off);
        }
    }
    struct rng rng = {polygon->count};
    for (int trial = 0; trial < 300; trial++) {
        double a[2] = {rng_unit(&rng), rng_unit(&rng)}, b[2] = {rng_unit(&rng), rng_unit(&rng)};
        if (!find_jump(polygon, a, b, least_angle)) continue;
        double off = distance_to_locus(mesh, &locus, a[0], a[1]);
        if (off > 4 * fine) fail_msg("(%.12g, %.12g) is missed by %g", a[0], a[1], off);
    }
    gd_voronoi_free(&locus);
    gd_field_release(field);
}

/* The medial axis of a rectangle consists of a middle line, and of a line to each corner. */
static void rectangle(void **state)
{
    (void)state;
    const struct polygon polygon = {{{0.1, 0.2}, {0.9, 0.2}, {0.9, 0.7}, {0.1, 0.7}}, 4};
    for (uint32_t cells = 1; cells <= 9; cells++) {
        struct gd_mesh *mesh = square(cells);
        struct gd_field *field = field_of(mesh, &polygon);
        struct gd_voronoi locus = locus_of(field, 0);
        check_close(length_of(&locus), 0.3 + 4 * 0.25 * M_SQRT2, 1e-8);
        gd_voronoi_free(&locus);
        gd_field_release(field);
        check_medial_axis(mesh, &polygon);
        gd_mesh_release(mesh);
    }
}

/* An L has a reflex corner. The bisectors between this corner and sides are parabolas. */
static void other_polygons(void **state)
{
    (void)state;
    static const struct polygon polygons[] = {
        {{{0.1, 0.1}, {0.9, 0.1}, {0.9, 0.5}, {0.5, 0.5}, {0.5, 0.9}, {0.1, 0.9}}, 6},
        {{{0.12, 0.17}, {0.83, 0.11}, {0.47, 0.42}, {0.91, 0.88}, {0.33, 0.71}}, 5},
        {{{0.2, 0.2}, {0.8, 0.2}, {0.5, 0.8}}, 3}};
    for (size_t i = 0; i < sizeof polygons / sizeof *polygons; i++) {
        for (uint32_t cells = 1; cells <= 8; cells++) {
            struct gd_mesh *mesh = square(cells);
            check_medial_axis(mesh, &polygons[i]);
            gd_mesh_release(mesh);
        }
    }
}

/* Tests a regular polygon: a line leads from each corner to the middle. Tests an ellipse of 64
 * sides: the ridges that begin at its corners have small angles, and `min_angle` removes them. Only
 * a part of the long axis is left. */
static void regular_polygons_and_ellipses(void **state)
{
    (void)state;
    struct gd_mesh *mesh = square(7);
    struct polygon round = {.count = CORNERS_MOST}, oval = {.count = CORNERS_MOST};
    for (uint32_t i = 0; i < CORNERS_MOST; i++) {
        double c = cos(2 * M_PI * i / CORNERS_MOST), s = sin(2 * M_PI * i / CORNERS_MOST);
        round.at[i][0] = 0.5 + 0.3 * c;
        round.at[i][1] = 0.5 + 0.3 * s;
        oval.at[i][0] = 0.5 + 0.4 * c;
        oval.at[i][1] = 0.5 + 0.2 * s;
    }
    check_medial_axis(mesh, &round);
    check_medial_axis(mesh, &oval);
    struct gd_field *field = field_of(mesh, &round);
    struct gd_voronoi locus = locus_of(field, 0);
    check_close(length_of(&locus), 0.3 * CORNERS_MOST, 1e-8);
    gd_voronoi_free(&locus);
    locus = locus_of(field, 0.2);
    assert_int_equal(locus.bisector_count, 0);
    gd_voronoi_free(&locus);
    gd_field_release(field);
    field = field_of(mesh, &oval);
    locus = locus_of(field, 0.2);
    assert_true(locus.bisector_count > 0);
    for (uint32_t k = 0; k < 2 * locus.bisector_count; k++) {
        struct gd_vec3 at = end_of(mesh, &locus, k);
        /* the centres of curvature at the ends of the long axis are 0.1 from these ends */
        assert_true(fabs(at.y - 0.5) < fine && fabs(at.x - 0.5) < 0.31);
    }
    gd_voronoi_free(&locus);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* --- memory and checks ------------------------------------------------------------------------ */

/* The memory of a trace is limited by a number of bytes for each wedge of the field. On this
 * sphere, ridges cross most faces many times. */
static void memory_is_bounded(void **state)
{
    (void)state;
    double level = TEST_IS_SANITIZED ? 3 : 4;
    struct gd_mesh *mesh =
        test_sample("icosphere", (const double[SAMPLE_PARAMETERS]){level, 1}, NULL);
    struct gd_field *field = test_field_from(mesh, test_point_near(mesh, 0.1, 0.23, 1));
    const struct gd_cut_locus_options options = {1e-3, 0};
    size_t wedges = gd_field_statistics(field)->wedges;
    const struct gd_control wide = {.budget_bytes = ((size_t)1 << 20) + 300 * wedges},
                            narrow = {.budget_bytes = 50 * wedges};
    struct gd_voronoi whole, locus;
    check_ok(gd_cut_locus_trace(field, NULL, &options, NULL, &whole), NULL);
    check_ok(gd_cut_locus_trace(field, NULL, &options, &wide, &locus), NULL);
    assert_int_equal(locus.bisector_count, whole.bisector_count);
    gd_voronoi_free(&locus);
    assert_int_equal(gd_cut_locus_trace(field, NULL, &options, &narrow, &locus), GD_BUDGET);
    gd_voronoi_free(&whole);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Counts the callbacks after the last face. */
struct late {
    double from;
    uint32_t calls, most; /* cancels at callback number `most`; 0 never cancels */
};

static bool count_late(void *user, double fraction)
{
    struct late *late = user;
    late->calls += fraction >= late->from;
    return !late->most || late->calls < late->most;
}

/* The control is checked while ends are matched and branches are dropped. */
static void checks_behind_the_last_face(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (const double[SAMPLE_PARAMETERS]){4, 1}, NULL);
    struct gd_field *field = test_field_from(mesh, test_point_near(mesh, 0.1, 0.23, 1));
    const struct gd_cut_locus_options none = {1e-3, M_PI};
    double faces = gd_mesh_summary(mesh)->faces;
    struct late late = {.from = 0.9 * (faces - 1) / faces};
    const struct gd_control control = {.progress = count_late, .user = &late};
    struct gd_voronoi locus;
    check_ok(gd_cut_locus_trace(field, NULL, &none, &control, &locus), NULL);
    assert_int_equal(locus.bisector_count, 0);
    gd_voronoi_free(&locus);
    uint32_t calls = late.calls;
    assert_true(calls > 20);
    for (uint32_t most = 1; most < calls; most += TEST_IS_SANITIZED ? calls : calls / 3) {
        late.calls = 0;
        late.most = most;
        assert_int_equal(gd_cut_locus_trace(field, NULL, &none, &control, &locus), GD_CANCELLED);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* --- what is refused -------------------------------------------------------------------------- */

static void refusals(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (const double[SAMPLE_PARAMETERS]){3, 1}, NULL);
    struct gd_seed seed = {.point = test_point_near(mesh, 0, 0.1, 1)};
    struct gd_field *field = test_field(mesh, &seed, 1, 0), *part = test_field(mesh, &seed, 1, 0.5);
    struct gd_voronoi locus = {.bisector_count = 77};
    static const struct gd_cut_locus_options bad[] = {{0, 0}, {NAN, 0}, {1, -1}, {1, NAN}, {1, 4}};
    const struct gd_cut_locus_options good = {1e-3, 0}, exact = {1e-15, 0};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(gd_cut_locus_trace(field, NULL, &bad[i], NULL, &locus),
                         GD_INVALID_ARGUMENT);
    uint32_t other = 1;
    assert_int_equal(gd_cut_locus_trace(field, &other, &good, NULL, &locus), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_cut_locus_trace(part, NULL, &good, NULL, &locus), GD_BEYOND_REACH);
    struct test_watch watch = {.most = 3};
    const struct gd_control control = {.progress = test_watch, .user = &watch},
                            poor = {.budget_bytes = 64}, tight = {.budget_bytes = 2 << 20};
    assert_int_equal(gd_cut_locus_trace(field, NULL, &good, &control, &locus), GD_CANCELLED);
    assert_int_equal(gd_cut_locus_trace(field, NULL, &good, &poor, &locus), GD_BUDGET);
    assert_int_equal(gd_cut_locus_trace(field, NULL, &exact, &tight, &locus), GD_BUDGET);
    assert_int_equal(locus.bisector_count, 77);
    gd_field_release(field);
    gd_field_release(part);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(middle_of_a_cubes_face),
        cmocka_unit_test(trees_on_spheres),
        cmocka_unit_test(no_loose_ends),
        cmocka_unit_test(points_have_two_paths),
        cmocka_unit_test(angles_thin_out),
        cmocka_unit_test(rectangle),
        cmocka_unit_test(other_polygons),
        cmocka_unit_test(regular_polygons_and_ellipses),
        cmocka_unit_test(memory_is_bounded),
        cmocka_unit_test(checks_behind_the_last_face),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
