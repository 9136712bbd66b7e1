#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "gd/curve.h"
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

/* The point of a face halfway between two places of it. */
static struct gd_point halfway(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 a, struct gd_vec3 b)
{
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, corners);
    struct gd_vec3 o = gd_mesh_position(mesh, corners[0]), e = gd_vec3_sub(gd_mesh_position(mesh, corners[1]), o),
                   f = gd_vec3_sub(gd_mesh_position(mesh, corners[2]), o), n = gd_vec3_cross(e, f),
                   p = gd_vec3_scale(gd_vec3_add(gd_vec3_sub(a, o), gd_vec3_sub(b, o)), 0.5);
    double v = gd_vec3_dot(gd_vec3_cross(p, f), n) / gd_vec3_dot(n, n),
           w = gd_vec3_dot(gd_vec3_cross(e, p), n) / gd_vec3_dot(n, n);
    v = fmin(fmax(v, 0), 1);
    w = fmin(fmax(w, 0), 1 - v);
    return test_point(mesh, (struct test_place){face, {1 - v - w, v, w}});
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
        double scale = level + arc->radius + gd_vec3_length(start);
        assert_true(gd_vec3_distance(arc_place(mesh, arc, arc->from), start) < promise * scale);
        length += gd_isoline_arc_length(arc);
        if (arc->radius > 0) {
            assert_true(gd_vec3_distance(arc_place(mesh, arc, arc->to), stop) < promise * scale);
            continue;
        }
        assert_true(fabs(gd_vec3_distance(start, stop) - fabs(arc->to)) < promise * (scale + arc->to));
        struct gd_point middle = halfway(mesh, arc->face.index, start, stop);
        worst = fmax(worst, misfit(field, &middle, level));
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
    struct gd_seed seed = {0};
    double moved;
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

/* --- segments ------------------------------------------------------------------------------------------------------------ */

/* The seeds of a curve. The caller frees. */
static struct gd_seed *seeds_of(const struct gd_mesh *mesh, const struct gd_curve_request *request, uint32_t *count,
                                double *length)
{
    struct gd_curve curve;
    struct gd_detail detail = {0};
    check_ok(gd_curve_resolve(mesh, request, NULL, NULL, &curve, &detail), &detail);
    *count = gd_curve_seed_count(&curve);
    struct gd_seed *seeds = calloc(*count, sizeof *seeds);
    gd_curve_seeds(&curve, 0, seeds);
    *length = gd_curve_length(mesh, &curve);
    gd_curve_free(&curve);
    return seeds;
}

static struct gd_field *field_of_curve(const struct gd_mesh *mesh, const struct gd_curve_request *request,
                                       double *length)
{
    uint32_t count;
    struct gd_seed *seeds = seeds_of(mesh, request, &count, length);
    struct gd_field *field = field_of(mesh, seeds, count, 0);
    free(seeds);
    return field;
}

static struct gd_point point_at(const struct gd_mesh *mesh, double x, double y)
{
    struct gd_point point;
    double moved;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, 0}, INFINITY, &point, &moved, NULL), NULL);
    return point;
}

static double straight_length(const struct gd_isoline *isoline)
{
    double length = 0;
    for (uint32_t i = 0; i < isoline->line_count; i++)
        for (uint32_t k = 0; k < isoline->lines[i].arc_count; k++)
            if (isoline->lines[i].arcs[k].radius == 0) length += gd_isoline_arc_length(&isoline->lines[i].arcs[k]);
    return length;
}

/* One closed line, of that length, of which that part is straight: joints lie where the two are as far from each other as rounding, a square of the way.
 * Returns the error of the length, relative. */
static double check_offset(const struct gd_field *field, double level, double length, double straight)
{
    struct gd_isoline isoline = trace(field, level);
    assert_int_equal(isoline.line_count, 1);
    assert_true(isoline.lines[0].closed);
    assert_true(fabs(straight_length(&isoline) - straight) < 1e-6 * (straight + level));
    double error = check_close(total_length(&isoline), length, promise);
    gd_isoline_free(&isoline);
    return error;
}

/* Two straight pieces and two half circles, at scales and places far from the origin. */
static void offsets_of_a_segment(void **state)
{
    (void)state;
    static const double scales[] = {1e-6, 1, 1e6};
    struct rng rng = {3};
    double worst = 0;
    for (int round = 0; round < 30; round++) {
        double scale = scales[round % 3], away = round % 2 ? 1e3 * scale : 0;
        struct gd_polygons polygons;
        check_ok(sample_grid(9, 7, 3 * scale, 2 * scale, &polygons), NULL);
        for (uint32_t v = 0; v < polygons.position_count; v++) polygons.positions[v][0] += away;
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_point ends[2];
        for (int i = 0; i < 2; i++)
            ends[i] = point_at(mesh, away + scale * rng_between(&rng, 0.9, 2.1), scale * rng_between(&rng, 0.9, 1.1));
        double length;
        struct gd_field *field = field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
        for (double level = 1e-4; level < 0.9; level += 0.0511)
            worst = fmax(worst, check_offset(field, level * scale, 2 * (length + M_PI * level * scale), 2 * length));
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# offsets of a segment: lengths off by %.1e at most\n", worst);
}

/* Segments along edges and parallel to them, at levels at which the line runs along edges. */
static void offsets_along_edges(void **state)
{
    (void)state;
    static const double at[][4] = {{3, 5, 6, 5}, {3.25, 5, 6.5, 5},  {3.25, 4.5, 6.5, 4.5}, {3.3, 5, 3.6, 5},
                                   {5, 3, 5, 6}, {3, 3, 6.25, 6.25}, {4, 4.5, 4, 5.75},     {3.1, 4.75, 3.2, 4.75}};
    static const double levels[] = {0.25,      0.5,     1,         1.5,       2,         2.5,
                                    M_SQRT1_2, M_SQRT2, 1 - 1e-13, 1 + 1e-13, 2 - 1e-12, 2 + 1e-12};
    struct gd_polygons polygons;
    check_ok(sample_grid(10, 10, 10, 10, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        struct gd_point ends[2] = {point_at(mesh, at[i][0], at[i][1]), point_at(mesh, at[i][2], at[i][3])};
        double length;
        struct gd_field *field = field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
        for (size_t k = 0; k < sizeof levels / sizeof *levels; k++)
            check_offset(field, levels[k], 2 * (length + M_PI * levels[k]), 2 * length);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* About a convex polygon: outside parallel sides and arcs that make one turn, inside a polygon again. */
static void offsets_of_a_polygon(void **state)
{
    (void)state;
    static const double corners[5][2] = {{3, 3}, {6.5, 2.5}, {7.25, 5}, {5, 7}, {3, 6.5}};
    struct gd_polygons polygons;
    check_ok(sample_grid(11, 13, 10, 10, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_point points[5];
    double length, shrinking = 0;
    for (int i = 0; i < 5; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % 5], *c = corners[(i + 4) % 5];
        double turn_at = atan2(a[0] - c[0], a[1] - c[1]) - atan2(b[0] - a[0], b[1] - a[1]);
        points[i] = point_at(mesh, a[0], a[1]);
        shrinking += 2 * tan(0.5 * remainder(turn_at, 2 * M_PI));
    }
    struct gd_field *field =
        field_of_curve(mesh, &(struct gd_curve_request){.points = points, .count = 5, .closed = true}, &length);
    for (double level = 0.01; level < 1.5; level += 0.0791) {
        struct gd_isoline isoline = trace(field, level);
        double inner = length - level * shrinking;
        assert_int_equal(isoline.line_count, 2);
        check_close(total_length(&isoline), length + 2 * M_PI * level + inner, promise);
        check_close(straight_length(&isoline), length + inner, 1e-7);
        gd_isoline_free(&isoline);
    }
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Inwards from a rectangle's boundary, also along rows of edges, up to the ridge. */
static void offsets_of_a_boundary(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(8, 6, 8, 6, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    double length;
    struct gd_field *field = field_of_curve(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, &length);
    check_close(length, 28, 1e-14);
    for (double level = 0.0625; level < 3; level += 0.0625) check_offset(field, level, 28 - 8 * level, 28 - 8 * level);
    check_offset(field, 1e-5, 28 - 8e-5, 28 - 8e-5);
    struct gd_isoline ridge = trace(field, 3), none = trace(field, 3.001);
    check_close(total_length(&ridge), 4, promise);
    assert_int_equal(none.line_count, 0);
    gd_isoline_free(&ridge);
    gd_isoline_free(&none);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* From one end of a prism's mantle all lines go round it, from both ends two do; about a geodesic on it, or on a cone's, they are as in the plane. */
static void offsets_on_mantles(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    double length, half;
    check_ok(sample_cylinder(1, 4, 7, 8, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_field *field = field_of_curve(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, &length);
    check_close(length, 14 * sin(M_PI / 7), 1e-14);
    for (double level = 0.125; level < 4; level += 0.125) check_offset(field, level, length, length);
    gd_field_release(field);
    uint32_t count, more;
    struct gd_seed seeds[128],
        *low = seeds_of(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY}, &count, &half),
        *high = seeds_of(mesh, &(struct gd_curve_request){.kind = GD_CURVE_BOUNDARY, .boundary = 1}, &more, &half);
    for (uint32_t i = 0; i < count + more; i++) seeds[i] = i < count ? low[i] : high[i - count];
    field = field_of(mesh, seeds, count + more, 0);
    for (double level = 0.125; level < 2; level += 0.125) {
        struct gd_isoline isoline = trace(field, level);
        assert_int_equal(isoline.line_count, 2);
        check_close(total_length(&isoline), 2 * length, promise);
        gd_isoline_free(&isoline);
    }
    gd_field_release(field);
    free(low);
    free(high);
    struct gd_point ends[2] = {test_point(mesh, (struct test_place){2 * 7 * 3 + 1, {0.2, 0.3, 0.5}}),
                               test_point(mesh, (struct test_place){2 * 7 * 4 + 4, {0.6, 0.3, 0.1}})};
    field = field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
    for (double level = 0.01; level < 1; level += 0.0713)
        check_offset(field, level, 2 * (length + M_PI * level), 2 * length);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
    check_ok(sample_cone(2, 1, 9, 12, &polygons), NULL);
    mesh = test_mesh(&polygons);
    for (int i = 0; i < 2; i++) ends[i] = point_at(mesh, 0.9 + 0.1 * i, i ? 0.4 : -0.3);
    field = field_of_curve(mesh, &(struct gd_curve_request){.points = ends, .count = 2}, &length);
    for (double level = 0.01; level < 0.6; level += 0.0713)
        check_offset(field, level, 2 * (length + M_PI * level), 2 * length);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- any surface --------------------------------------------------------------------------------------------------------- */

/* An arc, and where it ends, in the plane of its face. */
struct flat_arc {
    const struct gd_isoline_arc *arc;
    double end[2];
};

static double turn(const double o[2], const double p[2], const double q[2])
{
    return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
}

/* How often the segment a-b crosses an arc, all in the plane of its face. */
static uint32_t times_crossed(const struct flat_arc *flat, const double a[2], const double b[2])
{
    const struct gd_isoline_arc *arc = flat->arc;
    const double start[2] = {arc->u, arc->v};
    if (arc->radius == 0)
        return (turn(a, b, start) > 0) != (turn(a, b, flat->end) > 0) &&
               (turn(start, flat->end, a) > 0) != (turn(start, flat->end, b) > 0);
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

/* A point's place in the plane of a face of it, in the arcs' frame. */
static void lay_flat(const struct gd_mesh *mesh, uint32_t face, const struct gd_point *point, double at[2])
{
    struct gd_vec3 x, y, p = gd_point_position(mesh, point);
    struct gd_vertex corners[3];
    gd_mesh_corners(mesh, (struct gd_face){face}, corners);
    gd_isoline_arc_axes(mesh, &(struct gd_isoline_arc){.face = {face}}, &x, &y);
    struct gd_vec3 from = gd_vec3_sub(p, gd_mesh_position(mesh, corners[0]));
    at[0] = gd_vec3_dot(from, x);
    at[1] = gd_vec3_dot(from, y);
}

/* A random point of a face, and its place in the arcs' frame. */
static struct gd_point random_in_face(const struct gd_mesh *mesh, uint32_t face, struct rng *rng, double at[2])
{
    double weight[3] = {rng_between(rng, 0.01, 1), rng_between(rng, 0.01, 1), rng_between(rng, 0.01, 1)};
    double sum = weight[0] + weight[1] + weight[2];
    for (int k = 0; k < 3; k++) weight[k] /= sum;
    struct gd_point point = test_point(mesh, (struct test_place){face, {weight[0], weight[1], weight[2]}});
    lay_flat(mesh, face, &point, at);
    return point;
}

/* The arcs of all lines by face. */
struct by_face {
    uint32_t *first;
    struct flat_arc *arc;
};

static struct by_face sort_arcs(const struct gd_mesh *mesh, const struct gd_isoline *isoline, uint32_t faces)
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
            const struct gd_isoline_line *line = &isoline->lines[i];
            uint32_t face = line->arcs[k].face.index;
            struct flat_arc *flat = &sorted.arc[sorted.first[face + 1]++];
            flat->arc = &line->arcs[k];
            lay_flat(mesh, face, &line->points[k + 1 < line->point_count ? k + 1 : 0], flat->end);
        }
    return sorted;
}

/* Between two points of a face the segment crosses the isoline an odd number of times if and only if one of them is below the level. */
static void check_sides(const struct gd_field *field, const struct gd_isoline *isoline, struct rng *rng)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    uint32_t faces = gd_mesh_summary(mesh)->face_index_count;
    struct by_face sorted = sort_arcs(mesh, isoline, faces);
    for (uint32_t f = 0; f < faces; f++) {
        for (int k = 0; k < 12; k++) {
            double a[2], b[2], da, db;
            struct gd_point p = random_in_face(mesh, f, rng, a), q = random_in_face(mesh, f, rng, b);
            uint32_t times = 0;
            check_ok(gd_field_distance(field, &p, &da), NULL);
            check_ok(gd_field_distance(field, &q, &db), NULL);
            for (uint32_t i = sorted.first[f]; i < sorted.first[f + 1]; i++)
                times += times_crossed(&sorted.arc[i], a, b);
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

static struct gd_field *field_of_points(const struct gd_mesh *mesh, const struct gd_polygons *polygons, uint32_t count,
                                        struct rng *rng)
{
    struct gd_seed seeds[3] = {0};
    for (int i = 0; i < 3; i++) seeds[i].point = test_point(mesh, test_random_place(polygons, rng));
    return field_of(mesh, seeds, count, 0);
}

/* In the face, on one of its edges or at a corner. */
static struct gd_point random_end(const struct gd_mesh *mesh, uint32_t face, struct rng *rng)
{
    struct test_place place = {.face = face};
    uint32_t zeros = rng_below(rng, 3), first = rng_below(rng, 3);
    double sum = 0;
    for (uint32_t k = zeros; k < 3; k++) sum += place.weight[(first + k) % 3] = 0.01 + rng_unit(rng);
    for (int k = 0; k < 3; k++) place.weight[k] /= sum;
    return test_point(mesh, place);
}

/* Segments at random, across faces and along edges, with their ends. */
static struct gd_field *field_of_segments(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                                          uint32_t count, struct rng *rng)
{
    struct gd_seed seeds[9];
    uint32_t filled = 0;
    while (filled < 3 * count) {
        uint32_t face = rng_below(rng, polygons->polygon_count);
        struct gd_point a = random_end(mesh, face, rng), b = random_end(mesh, face, rng);
        if (gd_point_equal(&a, &b)) continue;
        seeds[filled++] = (struct gd_seed){.point = a};
        seeds[filled++] = (struct gd_seed){.point = a, .end = b, .is_segment = true};
        seeds[filled++] = (struct gd_seed){.point = b};
    }
    return field_of(mesh, seeds, filled, 0);
}

/* A corner, the middle of an edge, or a place of the face at quarters. */
static struct gd_point lattice_end(const struct gd_mesh *mesh, uint32_t face, struct rng *rng)
{
    struct test_place place = {.face = face};
    uint32_t kind = rng_below(rng, 3), first = rng_below(rng, 3);
    for (uint32_t k = 0; k < 3; k++) place.weight[k] = kind == 2 ? 0.25 : 0;
    place.weight[first] += kind == 2 ? 0.25 : kind == 1 ? 0.5 : 1;
    if (kind == 1) place.weight[(first + 1) % 3] = 0.5;
    return test_point(mesh, place);
}

/* Segments between places of a lattice, half of which begin half a unit later. */
static struct gd_field *field_on_lattice(const struct gd_mesh *mesh, const struct gd_polygons *polygons, uint32_t count,
                                         struct rng *rng)
{
    struct gd_seed seeds[18];
    uint32_t filled = 0;
    while (filled < 3 * count) {
        uint32_t face = rng_below(rng, polygons->polygon_count);
        double offset = 0.5 * rng_below(rng, 2);
        struct gd_point a = lattice_end(mesh, face, rng), b = lattice_end(mesh, face, rng);
        if (gd_point_equal(&a, &b)) continue;
        seeds[filled++] = (struct gd_seed){.point = a, .offset = offset};
        seeds[filled++] = (struct gd_seed){.point = b, .offset = offset};
        seeds[filled++] = (struct gd_seed){.point = a, .end = b, .is_segment = true, .offset = offset};
    }
    return field_of(mesh, seeds, filled, 0);
}

typedef struct gd_field *field_maker(const struct gd_mesh *, const struct gd_polygons *, uint32_t, struct rng *);

/* Fields of one and of three seeds on a surface, levels at random and of vertices, to the last bit. */
static void check_surface(const char *name, const struct gd_polygons *polygons, field_maker *make, uint64_t seed,
                          int rounds)
{
    struct gd_mesh *mesh = test_mesh(polygons);
    struct rng rng = {seed};
    uint32_t lines = 0, arcs = 0;
    double worst = 0, *distance = malloc(sizeof *distance * polygons->position_count);
    for (int round = 0; round < rounds; round++) {
        struct gd_field *field = make(mesh, polygons, round % 2 ? 3 : 1, &rng);
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

static void check_surfaces(field_maker *make)
{
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        check_ok(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons), NULL);
        check_surface(surfaces[s].name, &polygons, make, s, 4);
        gd_polygons_free(&polygons);
    }
}

static void check_degenerate_shapes(field_maker *make)
{
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
        check_surface(shapes[s].name, &shape.mesh, make, 100 + s, 4);
        zoo_shape_free(&shape);
    }
}

/* Between two parallel segments the ridge has the level's height: inside faces (x = 2.75), and along edges. */
static void along_a_ridge(void **state)
{
    (void)state;
    static const double at[2][2][4] = {{{2, 1, 2, 0.5}, {3, 1, 3, 0}}, {{1, 2, 1, 1}, {3, 1.5, 3, 1}}};
    static const double offsets[2] = {0.5, 0}, levels[2] = {0.75, 1};
    struct rng rng = {41};
    struct gd_polygons polygons;
    check_ok(sample_grid(6, 3, 6, 3, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    for (int i = 0; i < 2; i++) {
        struct gd_seed seeds[6];
        for (int k = 0; k < 2; k++) {
            const double *p = at[i][k];
            struct gd_point a = point_at(mesh, p[0], p[1]), b = point_at(mesh, p[2], p[3]);
            double offset = k ? offsets[i] : 0;
            seeds[3 * k] = (struct gd_seed){.point = a, .offset = offset};
            seeds[3 * k + 1] = (struct gd_seed){.point = b, .offset = offset};
            seeds[3 * k + 2] = (struct gd_seed){.point = a, .end = b, .is_segment = true, .offset = offset};
        }
        struct gd_field *field = field_of(mesh, seeds, 6, 0);
        struct gd_isoline isoline = trace(field, levels[i]);
        check_sides(field, &isoline, &rng);
        check_ends(mesh, &isoline);
        gd_isoline_free(&isoline);
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Lines along edges, through vertices, along ridges, and all of it at once. */
static void levels_that_tie(void **state)
{
    (void)state;
    struct rng rng = {31};
    uint32_t lines = 0;
    for (int round = 0; round < 500; round++) {
        uint32_t columns = 2 + rng_below(&rng, 6), rows = 2 + rng_below(&rng, 6);
        struct gd_polygons polygons;
        check_ok(sample_grid(columns, rows, columns, rows, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_field *field = field_on_lattice(mesh, &polygons, 1 + rng_below(&rng, 6), &rng);
        for (int k = 1; k <= 12; k++) {
            struct gd_isoline isoline = trace(field, 0.25 * k);
            check_sides(field, &isoline, &rng);
            check_ends(mesh, &isoline);
            lines += isoline.line_count;
            gd_isoline_free(&isoline);
        }
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# lattices: %u lines\n", lines);
}

static void of_points_on_any_surface(void **state)
{
    (void)state;
    check_surfaces(field_of_points);
}

static void of_segments_on_any_surface(void **state)
{
    (void)state;
    check_surfaces(field_of_segments);
}

static void of_points_on_degenerate_shapes(void **state)
{
    (void)state;
    check_degenerate_shapes(field_of_points);
}

static void of_segments_on_degenerate_shapes(void **state)
{
    (void)state;
    check_degenerate_shapes(field_of_segments);
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
        cmocka_unit_test(circles_in_the_plane),
        cmocka_unit_test(levels_through_vertices),
        cmocka_unit_test(circles_about_an_apex),
        cmocka_unit_test(two_seeds_in_the_plane),
        cmocka_unit_test(loops_within_one_face),
        cmocka_unit_test(on_a_cube),
        cmocka_unit_test(offsets_of_a_segment),
        cmocka_unit_test(offsets_along_edges),
        cmocka_unit_test(offsets_of_a_polygon),
        cmocka_unit_test(offsets_of_a_boundary),
        cmocka_unit_test(offsets_on_mantles),
        cmocka_unit_test(along_a_ridge),
        cmocka_unit_test(levels_that_tie),
        cmocka_unit_test(of_points_on_any_surface),
        cmocka_unit_test(of_segments_on_any_surface),
        cmocka_unit_test(of_points_on_degenerate_shapes),
        cmocka_unit_test(of_segments_on_degenerate_shapes),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(it_asks_its_control),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
