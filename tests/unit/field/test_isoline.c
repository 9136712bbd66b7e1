#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "gd/isoline.h"
#include "gd/locate.h"
#include "tests/samples/samples.h"
#include "tests/samples/zoo.h"

static const double promise = 1e-9;

static struct gd_field *field_of(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count, double radius)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    struct gd_field_request request = {.seeds = seeds, .seed_count = count, .radius = radius};
    check_ok(gd_field_build(mesh, &request, NULL, NULL, &field, &detail), &detail);
    return field;
}

static double total_length(const struct gd_isoline *isoline)
{
    double length = 0;
    for (uint32_t i = 0; i < isoline->line_count; i++) length += isoline->lines[i].length;
    return length;
}

static struct gd_vec3 arc_place(const struct gd_mesh *mesh, const struct gd_isoline_arc *arc, double angle)
{
    struct gd_vec3 x, y;
    gd_isoline_arc_axes(mesh, arc, &x, &y);
    return gd_vec3_along(gd_vec3_along(arc->centre, arc->radius * cos(angle), x), arc->radius * sin(angle), y);
}

/* Relative difference of a point's distance and the level. */
static double misfit(const struct gd_field *field, const struct gd_point *point, double level)
{
    double distance;
    check_ok(gd_field_distance(field, point, &distance), NULL);
    return fabs(distance - level) / level;
}

/* Points have the level's distance, and so have those that lie on the arcs between; arcs begin and end in them. Returns the worst misfit. */
static double check_line(const struct gd_field *field, const struct gd_isoline_line *line, double level)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    double worst = 0, length = 0;
    assert_int_equal(line->point_count, line->arc_count + !line->closed);
    for (uint32_t i = 0; i < line->point_count; i++) worst = fmax(worst, misfit(field, &line->points[i], level));
    for (uint32_t i = 0; i < line->arc_count; i++) {
        const struct gd_isoline_arc *arc = &line->arcs[i];
        uint32_t next = i + 1 < line->point_count ? i + 1 : 0;
        struct gd_vec3 start = gd_point_position(mesh, &line->points[i]),
                       stop = gd_point_position(mesh, &line->points[next]);
        double scale = arc->radius + gd_vec3_length(start);
        assert_true(gd_vec3_distance(arc_place(mesh, arc, arc->from), start) < promise * scale);
        assert_true(gd_vec3_distance(arc_place(mesh, arc, arc->to), stop) < promise * scale);
        length += arc->radius * fabs(arc->to - arc->from);
    }
    check_close(line->length, length, 1e-12);
    struct gd_path path;
    check_ok(gd_isoline_flatten(mesh, line, 1e-3 * level, NULL, &path), NULL);
    assert_true(path.count >= line->arc_count + 1);
    assert_int_equal(path.count, gd_isoline_flat_points(line, 1e-3 * level));
    assert_true(path.length <= line->length * (1 + promise));
    assert_true(gd_point_equal(&path.points[0], &line->points[0]));
    for (uint32_t i = 0; i < path.count; i++) worst = fmax(worst, misfit(field, &path.points[i], level));
    gd_path_free(&path);
    return worst;
}

static double check_isoline(const struct gd_field *field, const struct gd_isoline *isoline)
{
    double worst = 0;
    for (uint32_t i = 0; i < isoline->line_count; i++)
        worst = fmax(worst, check_line(field, &isoline->lines[i], isoline->level));
    if (!(worst <= promise)) print_error("level %.17g: off by %.3g\n", isoline->level, worst);
    assert_true(worst <= promise);
    return worst;
}

static struct gd_isoline trace(const struct gd_field *field, double level)
{
    struct gd_isoline isoline;
    check_ok(gd_isoline_trace(field, level, NULL, &isoline), NULL);
    check_isoline(field, &isoline);
    return isoline;
}

/* --- closed forms -------------------------------------------------------------------------------------------------------- */

/* Length of the circle about (x, y) inside the rectangle [0, width] x [0, height]. */
static double circle_in_rectangle(double x, double y, double radius, double width, double height)
{
    double cuts[10] = {0, 2 * M_PI}, lines[4] = {-x, width - x, -y, height - y}, length = 0;
    int count = 2;
    for (int i = 0; i < 4; i++) {
        double q = lines[i] / radius;
        if (fabs(q) >= 1) continue;
        double half = i < 2 ? acos(q) : asin(q), other = i < 2 ? -half : M_PI - half;
        cuts[count++] = half < 0 ? half + 2 * M_PI : half;
        cuts[count++] = other < 0 ? other + 2 * M_PI : other;
    }
    for (int i = 0; i < count; i++)
        for (int k = i + 1; k < count; k++)
            if (cuts[k] < cuts[i]) {
                double swap = cuts[i];
                cuts[i] = cuts[k];
                cuts[k] = swap;
            }
    for (int i = 0; i + 1 < count; i++) {
        double middle = 0.5 * (cuts[i] + cuts[i + 1]), px = x + radius * cos(middle), py = y + radius * sin(middle);
        if (px > 0 && px < width && py > 0 && py < height) length += radius * (cuts[i + 1] - cuts[i]);
    }
    return length;
}

static void circles_in_the_plane(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(9, 7, 3, 2, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {1};
    double worst = 0;
    for (int s = 0; s < 30; s++) {
        struct gd_seed seed = {.point = test_point(mesh, test_random_place(&polygons, &rng))};
        struct gd_vec3 at = gd_point_position(mesh, &seed.point);
        struct gd_field *field = field_of(mesh, &seed, 1, 0);
        for (int k = 0; k < 12; k++) {
            double level = k ? rng_between(&rng, 0.001, 2.5) : 1e-5;
            struct gd_isoline isoline = trace(field, level);
            double expected = circle_in_rectangle(at.x, at.y, level, 3, 2);
            if (expected > 1e-9 || total_length(&isoline) > 1e-9)
                worst = fmax(worst, check_close(total_length(&isoline), expected, promise));
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
    }
    print_message("# circles in the plane: lengths off by %.1e at most\n", worst);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Levels that pass exactly through vertices, touch edges in vertices, and end in corners. */
static void levels_through_vertices(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(8, 8, 8, 8, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {0};
    check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){4 * 9 + 4}, &seed.point, NULL), NULL);
    struct gd_field *field = field_of(mesh, &seed, 1, 0);
    const double levels[] = {1, sqrt(2), 2, sqrt(5), sqrt(8), 3, sqrt(10), sqrt(13), nextafter(3, 0), nextafter(3, 4)};
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        struct gd_isoline isoline = trace(field, levels[i]);
        assert_int_equal(isoline.line_count, 1);
        assert_true(isoline.lines[0].closed);
        check_close(isoline.lines[0].length, 2 * M_PI * levels[i], promise);
        gd_isoline_free(&isoline);
    }
    struct gd_isoline corner = trace(field, sqrt(32)), inner = trace(field, 5), none = trace(field, 6);
    assert_true(total_length(&corner) < 1e-6);
    assert_int_equal(inner.line_count, 4);
    check_close(total_length(&inner), circle_in_rectangle(4, 4, 5, 8, 8), promise);
    for (uint32_t i = 0; i < 4; i++) assert_false(inner.lines[i].closed);
    assert_int_equal(none.line_count, 0);
    gd_isoline_free(&corner);
    gd_isoline_free(&inner);
    gd_isoline_free(&none);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* About the apex of a cone the isoline is as long as the total angle tells; the mantle's rim is a polygon. */
static void circles_about_an_apex(void **state)
{
    (void)state;
    const char *names[] = {"cone", "saddle"};
    const double values[][SAMPLE_PARAMETERS] = {{1, 0.7, 7, 6}, {1, 0.9, 6, 5}};
    for (int i = 0; i < 2; i++) {
        struct gd_polygons polygons;
        check_ok(sample_find(names[i])->generate(values[i], &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        uint32_t apex = polygons.position_count - 1;
        if (i) {
            apex = 0;
            while (polygons.positions[apex][0] != 0 || polygons.positions[apex][1] != 0) apex++;
        }
        struct gd_seed seed = {.offset = 0.25};
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){apex}, &seed.point, NULL), NULL);
        struct gd_field *field = field_of(mesh, &seed, 1, 0);
        double total = 0; /* angle, from the faces round the apex */
        for (uint32_t f = 0; f < polygons.polygon_count; f++) {
            const uint32_t *corner = &polygons.corners[3 * f];
            for (uint32_t k = 0; k < 3; k++) {
                if (corner[k] != apex) continue;
                struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){apex}),
                               a = gd_vec3_sub(gd_mesh_position(mesh, (struct gd_vertex){corner[(k + 1) % 3]}), p),
                               b = gd_vec3_sub(gd_mesh_position(mesh, (struct gd_vertex){corner[(k + 2) % 3]}), p);
                total += atan2(gd_vec3_length(gd_vec3_cross(a, b)), gd_vec3_dot(a, b));
            }
        }
        for (double radius = 0.01; radius < 0.8; radius += 0.0637) {
            struct gd_isoline isoline = trace(field, 0.25 + radius);
            assert_int_equal(isoline.line_count, 1);
            assert_true(isoline.lines[0].closed);
            check_close(isoline.lines[0].length, total * radius, promise);
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Two seeds: before their circles meet there are two lines, then one, whose arcs meet on the bisector. */
static void two_seeds_in_the_plane(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(5, 4, 10, 8, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    const struct gd_vec3 at[2] = {{4, 4, 0}, {6.1, 4.3, 0}};
    struct gd_seed seeds[2] = {{.offset = 0}, {.offset = 0.2}};
    for (int i = 0; i < 2; i++) {
        double moved;
        check_ok(gd_locate_nearest(mesh, at[i], 1, &seeds[i].point, &moved, NULL), NULL);
    }
    struct gd_field *field = field_of(mesh, seeds, 2, 0);
    double apart = gd_vec3_distance(at[0], at[1]);
    for (double level = 0.25; level < 3; level += 0.131) {
        double r = level, s = level - 0.2, length = 2 * M_PI * (r + s);
        uint32_t lines = 2;
        if (r + s > apart) {
            lines = 1;
            length -= 2 * r * acos((apart * apart + r * r - s * s) / (2 * apart * r));
            length -= 2 * s * acos((apart * apart + s * s - r * r) / (2 * apart * s));
        }
        struct gd_isoline isoline = trace(field, level);
        assert_int_equal(isoline.line_count, lines);
        check_close(total_length(&isoline), length, promise);
        uint32_t joints = 0;
        for (uint32_t i = 0; i < isoline.line_count; i++)
            for (uint32_t k = 0; k < isoline.lines[i].point_count; k++) {
                struct gd_vec3 p = gd_point_position(mesh, &isoline.lines[i].points[k]);
                double d = gd_vec3_distance(p, at[0]), e = gd_vec3_distance(p, at[1]) + 0.2;
                joints += fabs(d - e) < 1e-9;
            }
        assert_int_equal(joints, lines == 1 ? 2 : 0);
        gd_isoline_free(&isoline);
    }
    struct gd_isoline touching = trace(field, 0.5 * (apart + 0.2)); /* the circles touch in one point */
    check_close(total_length(&touching), 2 * M_PI * apart, 1e-6);
    gd_isoline_free(&touching);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Circles and holes that no edge knows of. */
static void loops_within_one_face(void **state)
{
    (void)state;
    double positions[3][3] = {{0, 0, 0}, {4, 0, 0}, {2, 3, 0}};
    uint32_t corners[3] = {0, 1, 2};
    struct gd_polygons one = {.positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&one);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.5, 0.25, 0.25}})};
    struct gd_field *field = field_of(mesh, &seed, 1, 0);
    struct gd_isoline isoline = trace(field, 0.3);
    assert_int_equal(isoline.line_count, 1);
    assert_true(isoline.lines[0].closed && isoline.lines[0].arc_count == 1);
    check_close(isoline.lines[0].length, 0.6 * M_PI, 1e-14);
    gd_isoline_free(&isoline);
    gd_field_release(field);
    /* the middles of the edges as seeds: the distance has a maximum in the middle of the circle through them */
    struct gd_seed round[3] = {{.point = test_point(mesh, (struct test_place){0, {0.5, 0.5, 0}})},
                               {.point = test_point(mesh, (struct test_place){0, {0, 0.5, 0.5}})},
                               {.point = test_point(mesh, (struct test_place){0, {0.5, 0, 0.5}})}};
    field = field_of(mesh, round, 3, 0); /* (2, 0), (3, 1.5), (1, 1.5): 13/12 from (2, 13/12) */
    isoline = trace(field, 1.05);
    uint32_t holes = 0;
    for (uint32_t i = 0; i < isoline.line_count; i++) {
        if (!isoline.lines[i].closed) continue;
        holes++;
        assert_int_equal(isoline.lines[i].arc_count, 3);
        for (uint32_t k = 0; k < isoline.lines[i].point_count; k++)
            assert_int_equal(isoline.lines[i].points[k].kind, GD_POINT_FACE);
    }
    assert_int_equal(holes, 1);
    gd_isoline_free(&isoline);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* On a cube about a face's middle: four arcs a face at most, and what the box's own closed form says by symmetry of the net. */
static void on_a_cube(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    const double size[3] = {1, 1, 1};
    const uint32_t cells[3] = {3, 3, 3};
    check_ok(sample_box(size, cells, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed;
    double moved;
    seed.offset = 0;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){0.5, 0.5, 1}, 1, &seed.point, &moved, NULL), NULL);
    struct gd_field *field = field_of(mesh, &seed, 1, 0);
    struct gd_isoline on_top = trace(field, 0.4), over = trace(field, 0.6), holes = trace(field, 1.9);
    assert_true(on_top.line_count == 1 && over.line_count == 1 && holes.line_count == 1);
    check_close(on_top.lines[0].length, 0.8 * M_PI, promise);
    check_close(over.lines[0].length, 1.2 * M_PI, promise); /* no corner is within reach: all of it is flat */
    /* round the opposite face's middle: four arcs about the images of the seed, 2 from the middle */
    double t = 1 - sqrt(1.9 * 1.9 / 2 - 1), quarter = 2 * 1.9 * asin(t / 1.9);
    check_close(holes.lines[0].length, 4 * quarter, promise);
    gd_isoline_free(&on_top);
    gd_isoline_free(&over);
    gd_isoline_free(&holes);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- any surface --------------------------------------------------------------------------------------------------------- */

/* How often the segment a-b crosses an arc, all in the plane of its face. */
static uint32_t times_crossed(const struct gd_isoline_arc *arc, const double a[2], const double b[2])
{
    double ax = a[0] - arc->u, ay = a[1] - arc->v, dx = b[0] - a[0], dy = b[1] - a[1];
    double qa = dx * dx + dy * dy, qb = ax * dx + ay * dy, qc = ax * ax + ay * ay - arc->radius * arc->radius;
    double discriminant = qb * qb - qa * qc;
    uint32_t times = 0;
    if (discriminant <= 0) return 0;
    for (int sign = -1; sign <= 1; sign += 2) {
        double s = (-qb + sign * sqrt(discriminant)) / qa;
        if (s <= 0 || s >= 1) continue;
        double angle = atan2(ay + s * dy, ax + s * dx), middle = 0.5 * (arc->from + arc->to);
        times += fabs(remainder(angle - middle, 2 * M_PI)) < 0.5 * (arc->to - arc->from);
    }
    return times;
}

/* A random point of a face, and its place in the arcs' frame. */
static struct gd_point random_in_face(const struct gd_mesh *mesh, uint32_t face, struct rng *rng, double at[2])
{
    double weight[3] = {rng_between(rng, 0.01, 1), rng_between(rng, 0.01, 1), rng_between(rng, 0.01, 1)};
    double sum = weight[0] + weight[1] + weight[2];
    for (int k = 0; k < 3; k++) weight[k] /= sum;
    struct gd_point point = test_point(mesh, (struct test_place){face, {weight[0], weight[1], weight[2]}});
    struct gd_vec3 x, y, p = gd_point_position(mesh, &point);
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, corners);
    gd_isoline_arc_axes(mesh, &(struct gd_isoline_arc){.face = {face}}, &x, &y);
    struct gd_vec3 from = gd_vec3_sub(p, gd_mesh_position(mesh, corners[0]));
    at[0] = gd_vec3_dot(from, x);
    at[1] = gd_vec3_dot(from, y);
    return point;
}

/* The arcs of all lines by face. */
struct by_face {
    uint32_t *first;
    const struct gd_isoline_arc **arc;
};

static struct by_face sort_arcs(const struct gd_isoline *isoline, uint32_t faces)
{
    uint32_t total = 0;
    struct by_face sorted = {.first = calloc((size_t)faces + 2, sizeof *sorted.first)};
    for (uint32_t i = 0; i < isoline->line_count; i++)
        for (uint32_t k = 0; k < isoline->lines[i].arc_count; k++, total++)
            sorted.first[isoline->lines[i].arcs[k].face.index + 2]++;
    sorted.arc = malloc(sizeof *sorted.arc * (total + 1));
    for (uint32_t f = 0; f <= faces; f++) sorted.first[f + 1] += sorted.first[f];
    for (uint32_t i = 0; i < isoline->line_count; i++)
        for (uint32_t k = 0; k < isoline->lines[i].arc_count; k++) {
            const struct gd_isoline_arc *arc = &isoline->lines[i].arcs[k];
            sorted.arc[sorted.first[arc->face.index + 1]++] = arc;
        }
    return sorted;
}

/* Between two points of a face the segment crosses the isoline an odd number of times if and only if one of them is below the level. */
static void check_sides(const struct gd_field *field, const struct gd_isoline *isoline, struct rng *rng)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    uint32_t faces = gd_mesh_summary(mesh)->face_index_count;
    struct by_face sorted = sort_arcs(isoline, faces);
    for (uint32_t f = 0; f < faces; f++) {
        for (int k = 0; k < 12; k++) {
            double a[2], b[2], da, db;
            struct gd_point p = random_in_face(mesh, f, rng, a), q = random_in_face(mesh, f, rng, b);
            uint32_t times = 0;
            check_ok(gd_field_distance(field, &p, &da), NULL);
            check_ok(gd_field_distance(field, &q, &db), NULL);
            for (uint32_t i = sorted.first[f]; i < sorted.first[f + 1]; i++)
                times += times_crossed(sorted.arc[i], a, b);
            if (times % 2 != ((da < isoline->level) != (db < isoline->level))) {
                print_error("level %.17g, face %u: from %.17g to %.17g crosses %u of %u arcs\n", isoline->level, f, da,
                            db, times, sorted.first[f + 1] - sorted.first[f]);
                fail();
            }
        }
    }
    free(sorted.first);
    free(sorted.arc);
}

/* Open lines end on the boundary. */
static void check_ends(const struct gd_mesh *mesh, const struct gd_isoline *isoline)
{
    for (uint32_t i = 0; i < isoline->line_count; i++) {
        const struct gd_isoline_line *line = &isoline->lines[i];
        if (line->closed) continue;
        assert_true(gd_mesh_summary(mesh)->boundaries > 0);
        assert_true(line->points[0].kind != GD_POINT_FACE && line->points[line->point_count - 1].kind != GD_POINT_FACE);
    }
}

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"icosphere", {3, 1}},    {"torus", {24, 12, 1, 0.4}},   {"terrain", {16, 0.3, 7}},
                {"terrain", {8, 3, 8}},   {"genus2", {3, 0.03}},         {"saddle", {1, 0.6, 5, 6}},
                {"obstacles", {5, 1, 3}}, {"cylinder", {0.1, 3, 16, 5}}, {"tetrahedron", {1, 3}},
                {"tangle", {200, 11}},    {"tangle", {200, 12}},         {"box", {1, 1, 0.001, 6}}};

/* Fields of one and of three seeds on a surface, levels at random and of vertices, to the last bit. */
static void check_surface(const char *name, const struct gd_polygons *polygons, uint64_t seed, int rounds)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    struct rng rng = {seed};
    uint32_t lines = 0, arcs = 0;
    double worst = 0, *distance = malloc(sizeof *distance * polygons->position_count);
    for (int round = 0; round < rounds; round++) {
        struct gd_seed seeds[3] = {0};
        for (int i = 0; i < 3; i++) seeds[i].point = test_point(mesh, test_random_place(polygons, &rng));
        struct gd_field *field = field_of(mesh, seeds, round % 2 ? 3 : 1, 0);
        struct gd_point farthest;
        double most;
        check_ok(gd_field_farthest(field, NULL, &farthest, &most), NULL);
        gd_field_vertex_distances(field, distance);
        for (int k = 0; k < 8; k++) {
            double level =
                k % 2 ? rng_between(&rng, 0.01, 1.05) * most : distance[rng_below(&rng, polygons->position_count)];
            if (!(level > 1e-3 * most && isfinite(level))) continue;
            struct gd_isoline isoline;
            check_ok(gd_isoline_trace(field, level, NULL, &isoline), NULL);
            worst = fmax(worst, check_isoline(field, &isoline));
            check_sides(field, &isoline, &rng);
            check_ends(mesh, &isoline);
            assert_true(level <= most || !isoline.line_count);
            lines += isoline.line_count;
            for (uint32_t i = 0; i < isoline.line_count; i++) arcs += isoline.lines[i].arc_count;
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
    }
    print_message("# %s: %u lines of %u arcs, distances off by %.1e at most\n", name, lines, arcs, worst);
    free(distance);
    gd_mesh_release(mesh);
}

static void on_any_surface(void **state)
{
    (void)state;
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        check_ok(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons), NULL);
        check_surface(surfaces[s].name, &polygons, s, 4);
        gd_polygons_free(&polygons);
    }
}

static void on_degenerate_shapes(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        zoo_maker *make;
        double values[4];
    } shapes[] = {{"cap", zoo_cap, {1e-6}},
                  {"needles", zoo_needles, {8, 5, 1e-5, 0.1}},
                  {"wheel", zoo_wheel, {64, 0.999}},
                  {"accordion", zoo_accordion, {8, 6, 1, 3}},
                  {"pillow", zoo_pillow, {1, 1, 5}},
                  {"tube", zoo_tube, {1e-3, 1, 12, 5}},
                  {"box", zoo_box, {1, 1, 1}},
                  {"plate", zoo_box, {1, 1, 1e-3}},
                  {"octahedron", zoo_octahedron, {1, 2, 1e-2}},
                  {"crumpled", zoo_crumpled, {2, 100, 10, 10}},
                  {"assembly", zoo_assembly, {3, 1e-6}},
                  {"spike", zoo_spike, {10, 1000}}};
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct zoo_shape shape;
        check_ok(shapes[s].make(shapes[s].values, &shape), NULL);
        check_surface(shapes[s].name, &shape.mesh, 100 + s, 4);
        zoo_shape_free(&shape);
    }
}

static bool never(void *user, double fraction)
{
    (void)user, (void)fraction;
    return false;
}

static void what_is_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(2, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.2, 0.3, 0.5}})};
    struct gd_field *whole = field_of(mesh, &seed, 1, 0), *partial = field_of(mesh, &seed, 1, 1);
    struct gd_isoline isoline = {.level = 7};
    const double bad[] = {-1, NAN, INFINITY};
    for (int i = 0; i < 3; i++) assert_int_equal(gd_isoline_trace(whole, bad[i], NULL, &isoline), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_isoline_trace(partial, 1.5, NULL, &isoline), GD_BEYOND_REACH);
    struct gd_control late = {.deadline_ns = 1}, cancel = {.progress = never}, poor = {.budget_bytes = 64};
    assert_int_equal(gd_isoline_trace(whole, 1, &late, &isoline), GD_DEADLINE);
    assert_int_equal(gd_isoline_trace(whole, 1, &cancel, &isoline), GD_CANCELLED);
    assert_int_equal(gd_isoline_trace(whole, 1, &poor, &isoline), GD_BUDGET);
    assert_true(isoline.level == 7);
    struct gd_isoline zero = trace(whole, 0), far = trace(whole, 100), a = trace(whole, 0.9), b = trace(partial, 0.9);
    assert_true(zero.line_count == 0 && far.line_count == 0 && a.line_count == 1 && b.line_count == 1);
    check_close(a.lines[0].length, b.lines[0].length, 1e-12);
    struct gd_path path;
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 0, NULL, &path), GD_INVALID_ARGUMENT);
    check_ok(gd_isoline_flatten(mesh, &a.lines[0], 1e-9, NULL, &path), NULL);
    check_close(path.length, a.lines[0].length, 1e-7);
    gd_path_free(&path);
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 1, &late, &path), GD_DEADLINE);
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 1, &cancel, &path), GD_CANCELLED);
    assert_int_equal(gd_isoline_flatten(mesh, &a.lines[0], 1, &poor, &path), GD_BUDGET);
    gd_isoline_free(&zero);
    gd_isoline_free(&far);
    gd_isoline_free(&a);
    gd_isoline_free(&b);
    gd_field_release(whole);
    gd_field_release(partial);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- control ------------------------------------------------------------------------------------------------------------- */

static double cpu_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

struct watch {
    uint32_t calls, most; /* cancels at call number `most` */
    double fraction;
};

static bool watch(void *user, double fraction)
{
    struct watch *seen = user;
    assert_true(fraction >= seen->fraction && fraction <= 1);
    seen->fraction = fraction;
    return ++seen->calls != seen->most;
}

/* Once in a millisecond on the average, with a part done that grows; and whichever call says no, it ends. */
static void it_asks_its_control(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_icosphere(6, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seed = {.point = test_point(mesh, (struct test_place){0, {0.2, 0.3, 0.5}})};
    struct gd_field *field = field_of(mesh, &seed, 1, 0);
    struct watch whole = {0};
    struct gd_control control = {.progress = watch, .user = &whole};
    struct gd_isoline isoline;
    double begun = cpu_ms();
    check_ok(gd_isoline_trace(field, 1.5, &control, &isoline), NULL);
    double took = cpu_ms() - begun;
    print_message("# %u looks at the control in %.1f ms\n", whole.calls, took);
    assert_true(whole.calls >= 3 && whole.calls >= took);
    gd_isoline_free(&isoline);
    for (uint32_t most = 1; most <= whole.calls; most += 1 + whole.calls / 20) {
        struct watch part = {.most = most};
        control.user = &part;
        assert_int_equal(gd_isoline_trace(field, 1.5, &control, &isoline), GD_CANCELLED);
        assert_int_equal(part.calls, most);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circles_in_the_plane),  cmocka_unit_test(levels_through_vertices),
        cmocka_unit_test(circles_about_an_apex), cmocka_unit_test(two_seeds_in_the_plane),
        cmocka_unit_test(loops_within_one_face), cmocka_unit_test(on_a_cube),
        cmocka_unit_test(on_any_surface),        cmocka_unit_test(on_degenerate_shapes),
        cmocka_unit_test(what_is_refused),       cmocka_unit_test(it_asks_its_control),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
