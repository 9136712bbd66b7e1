/* Compares shortest paths in trimmed domains with closed forms: paths around circles, corners and
 * holes in the plane, and on a cylinder, which develops into the plane. */
#include "gd/geodesic_like.h"

#include <string.h>

#include "gd/field.h"
#include "tests/support/test.h"
#include "tests/unit/nurbs/surfaces.h"

static const double promise = 1e-10; /* relative error of a length */

struct scene {
    struct gd_parametric *base, *surface;
    struct gd_tessellation *tessellation;
};

static struct scene open_scene(struct gd_parametric *base, const struct gd_trims *trims)
{
    struct scene scene = {.base = base};
    struct gd_trim_fault fault = {0};
    struct gd_detail detail = {0};
    check_ok(gd_parametric_trim(base, trims, NULL, &scene.surface, &fault), &fault.detail);
    check_ok(gd_tessellation_build(scene.surface, NULL, NULL, &scene.tessellation, &detail),
             &detail);
    return scene;
}

static void close_scene(struct scene *scene)
{
    gd_tessellation_release(scene->tessellation);
    gd_parametric_release(scene->surface);
    gd_parametric_release(scene->base);
}

/* Creates the rectangle [0, width] x [0, height] of the plane, with (u, v) = (x, y). */
static struct gd_parametric *flat(double width, double height)
{
    static const double zero[1] = {0};
    struct gd_parametric *surface;
    struct gd_detail detail = {0};
    const struct gd_graph graph = {
        .coefficients = zero, .u_range = (double[]){0, width}, .v_range = (double[]){0, height}};
    check_ok(gd_parametric_graph(&graph, &surface, &detail), &detail);
    return surface;
}

/* A circle as a loop of one rational curve. */
struct circle {
    double points[9][2], weights[9];
    struct gd_trim_curve curve;
    struct gd_trim_loop loop;
};

static void circle_make(struct circle *out, double u, double v, double radius)
{
    for (int i = 0; i < 9; i++) {
        out->points[i][0] = u + radius * circle_x[i];
        out->points[i][1] = v + radius * circle_y[i];
        out->weights[i] = circle_weight(i);
    }
    out->curve = (struct gd_trim_curve){.degree = 2,
                                        .count = 9,
                                        .points = (const double(*)[2])out->points,
                                        .weights = out->weights,
                                        .knots = circle_knots};
    out->loop = (struct gd_trim_loop){&out->curve, 1};
}

static struct gd_geodesics solve(const struct scene *scene, const double from[2],
                                 const double to[2], bool all)
{
    struct gd_domain_curve *ends[2];
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    check_ok(gd_domain_curve_point(scene->surface, from[0], from[1], &ends[0], &detail), &detail);
    check_ok(gd_domain_curve_point(scene->surface, to[0], to[1], &ends[1], &detail), &detail);
    const struct gd_geodesic_options options = {.all_minima = all};
    check_ok(gd_geodesic_solve(
                 scene->tessellation,
                 &(struct gd_geodesic_request){.from = ends[0], .to = ends[1], .options = &options},
                 NULL, &found, &detail),
             &detail);
    for (int k = 0; k < 2; k++) gd_domain_curve_release(ends[k]);
    return found;
}

static double distance(const struct scene *scene, const double from[2], const double to[2])
{
    struct gd_geodesics found = solve(scene, from, to, false);
    double length = found.items[0].length;
    assert_true(found.items[0].is_minimum);
    assert_true(!(found.items[0].warnings & GD_GEODESIC_NOT_CONVERGED));
    gd_geodesics_free(&found);
    return length;
}

/* Returns the length of the path from p to q that has a circle on its left or on its right:
 * tangent, arc, tangent. */
static double around_circle(const double p[2], const double q[2], const double c[2], double radius,
                            bool left)
{
    double a = hypot(p[0] - c[0], p[1] - c[1]), b = hypot(q[0] - c[0], q[1] - c[1]);
    double turn = atan2(p[1] - c[1], p[0] - c[0]) - atan2(q[1] - c[1], q[0] - c[0]);
    if (!left) turn = -turn;
    turn = fmod(turn + 4 * M_PI, 2 * M_PI) - acos(radius / a) - acos(radius / b);
    return sqrt(a * a - radius * radius) + sqrt(b * b - radius * radius) + radius * turn;
}

static void around_a_circular_hole(void **state)
{
    (void)state;
    struct circle hole;
    circle_make(&hole, 2, 2, 1);
    struct scene scene = open_scene(flat(4, 4), &(struct gd_trims){&hole.loop, 1, false});
    static const double centre[2] = {2, 2};
    static const double pairs[][2][2] = {{{0.5, 2.1}, {3.5, 1.8}},
                                         {{0.2, 0.3}, {3.7, 3.3}},
                                         {{0.9, 2}, {2.05, 0.9}},
                                         {{1.2, 1.1}, {2.9, 2.9}}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        const double *p = pairs[i][0], *q = pairs[i][1];
        struct gd_geodesics found = solve(&scene, p, q, true);
        double left = around_circle(p, q, centre, 1, true),
               right = around_circle(p, q, centre, 1, false);
        check_close(found.items[0].length, fmin(left, right), promise);
        assert_int_equal(found.count, 2);
        check_close(found.items[1].length, fmax(left, right), promise);
        assert_true(found.items[0].warnings & GD_GEODESIC_BOUNDARY_CONTACT);
        gd_geodesics_free(&found);
    }
    close_scene(&scene);
}

/* A polygon as a loop of one polyline, whose last point repeats the first. */
struct polygon {
    struct gd_trim_curve curve;
    struct gd_trim_loop loop;
};

static void polygon_make(struct polygon *out, const double (*points)[2], uint32_t count)
{
    out->curve = (struct gd_trim_curve){.degree = 1, .count = count, .points = points};
    out->loop = (struct gd_trim_loop){&out->curve, 1};
}

/* The straight line between the ends crosses a hole close to a corner. The path passes this corner,
 * not the nearer or the far edges of the hole. */
static void past_a_corner_of_a_hole(void **state)
{
    (void)state;
    /* the path passes the first corner */
    static const struct {
        double hole[9][2], ends[2][2];
        uint32_t count;
    } cases[] = {
        {{{0.5339, 4.1209}, {0.3033, 4.1295}, {0.2065, 4.0109}, {0.2507, 3.8047}, {0.4112, 3.9325}},
         {{0.3006, 3.1455}, {1.4338, 8}},
         5},
        {{{1.1803, 3.8567},
          {1.0322, 3.8418},
          {0.9413, 3.8919},
          {0.7068, 3.8844},
          {0.8149, 4.0619},
          {0.8571, 4.233},
          {1.0348, 4.2336},
          {1.148, 4.131},
          {1.1673, 4.0044}},
         {{2, 8}, {0.0114, 0}},
         9},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct polygon hole;
        double points[10][2];
        uint32_t count = cases[i].count;
        memcpy(points, cases[i].hole, sizeof cases[i].hole);
        memcpy(points[count], points[0], sizeof points[0]);
        polygon_make(&hole, (const double(*)[2])points, count + 1);
        struct scene scene = open_scene(flat(2, 8), &(struct gd_trims){&hole.loop, 1, false});
        const double *p = cases[i].ends[0], *q = cases[i].ends[1], *corner = points[0];
        double length =
            hypot(p[0] - corner[0], p[1] - corner[1]) + hypot(q[0] - corner[0], q[1] - corner[1]);
        check_close(distance(&scene, p, q), length, promise);
        check_close(distance(&scene, q, p), length, promise);
        close_scene(&scene);
    }
}

/* The first part of a path, before a corner, is so short that its coordinates are not exact enough
 * for the relative tolerance. */
static void from_next_to_a_corner(void **state)
{
    (void)state;
    static const double corners[4][2] = {
        {3.2816, 14.0927}, {3.28174, 14.09274}, {3.209, 15.927}, {3.2816, 14.0927}};
    struct polygon hole;
    polygon_make(&hole, corners, 4);
    struct scene scene = open_scene(flat(6, 20), &(struct gd_trims){&hole.loop, 1, false});
    for (int i = 1; i < 10; i++) {
        const double p[2] = {corners[0][0] + 0.1 * i * (corners[1][0] - corners[0][0]),
                             corners[0][1] + 0.1 * i * (corners[1][1] - corners[0][1])},
                     q[2] = {3.0756, 19.2964};
        double length[2];
        for (int k = 0; k < 2; k++)
            length[k] = hypot(p[0] - corners[k][0], p[1] - corners[k][1]) +
                        hypot(q[0] - corners[k][0], q[1] - corners[k][1]);
        check_close(distance(&scene, p, q), fmin(length[0], length[1]), promise);
    }
    close_scene(&scene);
}

static void around_a_reflex_corner(void **state)
{
    (void)state;
    static const double corners[7][2] = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}, {0, 0}};
    struct polygon outer;
    polygon_make(&outer, corners, 7);
    struct scene scene = open_scene(flat(4, 4), &(struct gd_trims){&outer.loop, 1, true});
    check_close(distance(&scene, (double[]){3.5, 0.5}, (double[]){0.5, 3.5}), 2 * hypot(2.5, 0.5),
                promise);
    check_close(distance(&scene, (double[]){3.5, 0.9}, (double[]){0.2, 3.1}),
                hypot(2.5, 0.1) + hypot(0.8, 2.1), promise);
    /* straight paths, also along an edge and from corner to corner */
    check_close(distance(&scene, (double[]){0.1, 0.2}, (double[]){0.9, 3.9}), hypot(0.8, 3.7),
                promise);
    check_close(distance(&scene, (double[]){4, 1}, (double[]){1, 4}), 6, promise);
    check_close(distance(&scene, (double[]){3, 1}, (double[]){1.5, 1}), 1.5, promise);
    check_close(distance(&scene, (double[]){0, 4}, (double[]){4, 0}), 2 * hypot(3, 1), promise);
    close_scene(&scene);
}

/* Returns the length of the path that runs clockwise around the first circle, and then
 * counter-clockwise around the second. Its parts are a tangent, an arc, the inner common tangent,
 * an arc and a tangent. */
static double between_circles(const double p[2], const double q[2], const double c[2][2],
                              const double r[2])
{
    double d = hypot(c[1][0] - c[0][0], c[1][1] - c[0][1]);
    double axis = atan2(c[1][1] - c[0][1], c[1][0] - c[0][0]), inner = acos((r[0] + r[1]) / d);
    double a = hypot(p[0] - c[0][0], p[1] - c[0][1]), b = hypot(q[0] - c[1][0], q[1] - c[1][1]);
    double first = atan2(p[1] - c[0][1], p[0] - c[0][0]) - acos(r[0] / a) - (axis + inner);
    double second = atan2(q[1] - c[1][1], q[0] - c[1][0]) - acos(r[1] / b) - (axis + M_PI + inner);
    first = fmod(first + 6 * M_PI, 2 * M_PI);
    second = fmod(second + 6 * M_PI, 2 * M_PI);
    return sqrt(a * a - r[0] * r[0]) + r[0] * first + sqrt(d * d - (r[0] + r[1]) * (r[0] + r[1])) +
           r[1] * second + sqrt(b * b - r[1] * r[1]);
}

static void between_two_holes(void **state)
{
    (void)state;
    static const double centres[2][2] = {{1.4, 1.6}, {2.7, 2.3}}, radii[2] = {0.7, 0.6};
    static const double p[2] = {1, 0.4}, q[2] = {3, 3.7};
    struct circle holes[2];
    for (int i = 0; i < 2; i++) circle_make(&holes[i], centres[i][0], centres[i][1], radii[i]);
    const struct gd_trim_loop loops[2] = {holes[0].loop, holes[1].loop};
    struct scene scene = open_scene(flat(4, 4), &(struct gd_trims){loops, 2, false});
    struct gd_geodesics found = solve(&scene, p, q, true);
    /* mirrored, the path of this scene runs clockwise around the first circle */
    double through = between_circles((double[]){p[0], -p[1]}, (double[]){q[0], -q[1]},
                                     (const double[2][2]){{centres[0][0], -centres[0][1]},
                                                          {centres[1][0], -centres[1][1]}},
                                     radii),
           nearest = INFINITY;
    for (uint32_t i = 0; i < found.count; i++)
        if (fabs(found.items[i].length - through) < fabs(nearest - through))
            nearest = found.items[i].length;
    check_close(nearest, through, promise);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

/* A cylinder of radius 1 and height 3 has a hole between two meridians and two parallels. The
 * developed path is a polyline through corners of a rectangle. */
static void around_a_hole_of_a_cylinder(void **state)
{
    (void)state;
    double a = circle_parameter(1), b = circle_parameter(2);
    const double corners[5][2] = {{a, 0.3}, {b, 0.3}, {b, 0.6}, {a, 0.6}, {a, 0.3}};
    struct polygon hole;
    polygon_make(&hole, corners, 5);
    struct scene scene =
        open_scene(nurbs_ruled(1, 0, 1, 3), &(struct gd_trims){&hole.loop, 1, false});
    const double p[2] = {circle_parameter(0.8), 0.5}, q[2] = {circle_parameter(2.3), 0.4};
    /* heights 1.5 and 1.2; the hole reaches from 0.9 to 1.8 */
    double below = hypot(0.2, 0.6) + 1 + hypot(0.3, 0.3),
           above = hypot(0.2, 0.3) + 1 + hypot(0.3, 0.6);
    double behind = hypot(2 * M_PI - 1.5, 0.3);
    struct gd_geodesics found = solve(&scene, p, q, true);
    check_close(found.items[0].length, fmin(below, above), promise);
    assert_true(found.count >= 3);
    check_close(found.items[1].length, fmax(below, above), promise);
    check_close(found.items[2].length, behind, promise);
    assert_int_equal(found.items[0].turns[0], 0);
    assert_int_equal(found.items[2].turns[0], -1);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

/* Tests a hole between meridians and parallels of the unit sphere. A path that passes south of the
 * hole has three parts: an arc of a great circle, a part of the hole's southern parallel, and
 * another arc of a great circle. Both arcs are tangential to this parallel. */
static void along_a_parallel_of_a_sphere(void **state)
{
    (void)state;
    const double south = 0.5, north = 1, p_latitude = 0.2, q_latitude = 0.1;
    double u[2] = {circle_parameter(1), circle_parameter(3)},
           v[2] = {2 * circle_parameter(south + M_PI_2), 2 * circle_parameter(north + M_PI_2)};
    const double corners[5][2] = {
        {u[0], v[0]}, {u[1], v[0]}, {u[1], v[1]}, {u[0], v[1]}, {u[0], v[0]}};
    struct polygon hole;
    polygon_make(&hole, corners, 5);
    struct scene scene = open_scene(nurbs_sphere(), &(struct gd_trims){&hole.loop, 1, false});
    const double p[2] = {circle_parameter(0.2), 2 * circle_parameter(p_latitude + M_PI_2)},
                 q[2] = {circle_parameter(3.9), 2 * circle_parameter(q_latitude + M_PI_2)};
    double turn = 3.7 - acos(tan(p_latitude) / tan(south)) - acos(tan(q_latitude) / tan(south));
    double length =
        acos(sin(p_latitude) / sin(south)) + acos(sin(q_latitude) / sin(south)) + turn * cos(south);
    struct gd_geodesics found = solve(&scene, p, q, true);
    double nearest = INFINITY;
    for (uint32_t i = 0; i < found.count; i++) {
        if (fabs(found.items[i].length - length) < fabs(nearest - length))
            nearest = found.items[i].length;
    }
    check_close(nearest, length, promise);
    gd_geodesics_free(&found);
    close_scene(&scene);
}

/* Distances of a trimmed, bent surface are a metric. */
static void distances_are_a_metric(void **state)
{
    (void)state;
    static const double heights[9] = {0, 0.3, -0.2, 0.1, -0.4, 0.2, 0, 0.15, 0.05};
    static const double notch[7][2] = {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {1.5, 1.7}, {0, 3}, {0, 0}};
    struct gd_parametric *surface;
    struct gd_detail detail = {0};
    const struct gd_graph graph = {.degree_u = 2,
                                   .degree_v = 2,
                                   .coefficients = heights,
                                   .u_range = (double[]){0, 3},
                                   .v_range = (double[]){0, 3}};
    check_ok(gd_parametric_graph(&graph, &surface, &detail), &detail);
    struct polygon outer;
    struct circle hole;
    polygon_make(&outer, notch, 7);
    circle_make(&hole, 1.5, 0.9, 0.4);
    const struct gd_trim_loop loops[2] = {outer.loop, hole.loop};
    struct scene scene = open_scene(surface, &(struct gd_trims){loops, 2, true});
    double at[6][2] = {{1.1, 0.3}, {2.5, 2.6}, {0.2, 2.7}, {2, 0.8}, {1.5, 0.5}, {0.1, 0.1}},
           d[6][6];
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++) {
            if (i == k) {
                struct gd_geodesics found = solve(&scene, at[i], at[k], false);
                assert_true(found.items[0].length == 0);
                gd_geodesics_free(&found);
            }
            d[i][k] = i == k ? 0 : distance(&scene, at[i], at[k]);
        }
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 6; k++) {
            check_close(d[i][k], d[k][i], promise);
            for (int m = 0; m < 6; m++) assert_true(d[i][k] <= (d[i][m] + d[m][k]) * (1 + promise));
        }
    close_scene(&scene);
}

/* --- the domain ------------------------------------------------------------------------------- */

static void faulty_loops_are_refused(void **state)
{
    (void)state;
    static const struct {
        uint32_t outer_count, hole_count, loop;
        double outer[5][2], hole[5][2];
        const char *part;
    } cases[] = {
        {3, 0, 0, {{1, 1}, {3, 1}, {3, 3}}, {{0}}, "not closed"},
        {5, 0, 0, {{1, 1}, {3, 3}, {1, 3}, {3, 1}, {1, 1}}, {{0}}, "itself"},
        {5, 0, 0, {{1, 1}, {3, 1}, {2, 1}, {2, 3}, {1, 1}}, {{0}}, "itself"},
        {5, 0, 0, {{1, 1}, {1, 1}, {3, 1}, {3, 3}, {1, 1}}, {{0}}, "equal"},
        {4, 0, 0, {{1, 1}, {5, 1}, {3, 3}, {1, 1}}, {{0}}, "leaves the domain"},
        {4,
         4,
         1,
         {{1, 1}, {3, 1}, {3, 3}, {1, 1}},
         {{2, 0.5}, {2.5, 2}, {2.5, 0.5}, {2, 0.5}},
         "crosses"},
        {4,
         4,
         1,
         {{1, 1}, {3, 1}, {3, 3}, {1, 1}},
         {{2, 1}, {2.5, 1.5}, {2.2, 1.5}, {2, 1}},
         "touches"},
        {4,
         4,
         1,
         {{1, 1}, {2, 1}, {2, 2}, {1, 1}},
         {{3, 3}, {3.5, 3}, {3.5, 3.5}, {3, 3}},
         "outside the outer loop"},
        {0, 4, 0, {{0}}, {{0, 1}, {1, 1}, {1, 2}, {0, 1}}, "border"},
    };
    struct gd_parametric *surface = flat(4, 4), *made;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct polygon polygons[2];
        struct gd_trim_loop loops[2];
        uint32_t count = 0;
        if (cases[i].outer_count) {
            polygon_make(&polygons[0], cases[i].outer, cases[i].outer_count);
            loops[count++] = polygons[0].loop;
        }
        if (cases[i].hole_count) {
            polygon_make(&polygons[1], cases[i].hole, cases[i].hole_count);
            loops[count++] = polygons[1].loop;
        }
        struct gd_trim_fault fault;
        const struct gd_trims trims = {loops, count, cases[i].outer_count > 0};
        assert_int_equal(gd_parametric_trim(surface, &trims, NULL, &made, &fault),
                         GD_INVALID_ARGUMENT);
        assert_int_equal(fault.loop, cases[i].loop);
        assert_non_null(strstr(fault.detail.text, cases[i].part));
    }
    gd_parametric_release(surface);
}

/* Creates a square with a circular hole. The outer loop of the square consists of a line, a Bézier
 * curve and a polyline. */
static struct scene open_plate(void)
{
    static const double bottom[][2] = {{0, 0}, {4, 0}}, right[][2] = {{4, 0}, {4, 1}, {4, 4}},
                        rest[][2] = {{4, 4}, {0, 4}, {0, 0}};
    const struct gd_trim_curve outer[] = {{.degree = 1, .count = 2, .points = bottom},
                                          {.degree = 2, .count = 3, .points = right},
                                          {.degree = 1, .count = 3, .points = rest}};
    struct circle hole;
    circle_make(&hole, 2, 2, 1);
    const struct gd_trim_loop loops[] = {{outer, 3}, hole.loop};
    return open_scene(flat(4, 4), &(struct gd_trims){loops, 2, true});
}

static void the_mesh_ends_at_the_loops(void **state)
{
    (void)state;
    struct scene scene = open_plate();
    const struct gd_polygons *polygons = gd_tessellation_polygons(scene.tessellation);
    const struct gd_mesh_summary *summary =
        gd_mesh_summary(gd_tessellation_mesh(scene.tessellation));
    double area = 0;
    for (uint32_t f = 0; f < polygons->polygon_count; f++) {
        const double *a = polygons->positions[polygons->corners[3 * f]],
                     *b = polygons->positions[polygons->corners[3 * f + 1]],
                     *c = polygons->positions[polygons->corners[3 * f + 2]];
        double part = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert_true(part > 0);
        area += 0.5 * part;
    }
    check_close(area, 16 - M_PI, 2e-4);
    assert_int_equal(summary->boundaries, 2);
    assert_int_equal(summary->components, 1);
    /* a point of the tessellation has the parameters of the request */
    struct gd_point point;
    double uv[2];
    check_ok(gd_tessellation_point(scene.tessellation, 3.2, 1.1, &point, NULL), NULL);
    gd_tessellation_parameters(scene.tessellation, &point, uv);
    assert_true(fabs(uv[0] - 3.2) < 1e-12 && fabs(uv[1] - 1.1) < 1e-12);
    close_scene(&scene);
}

static void the_domain_ends_at_the_loops(void **state)
{
    (void)state;
    struct scene scene = open_plate();
    struct gd_parametric_closest found;
    bool has_outer;
    assert_int_equal(gd_parametric_loops(scene.surface, &has_outer), 2);
    assert_true(has_outer);
    assert_true(gd_parametric_contains(scene.surface, 0, 0));
    assert_true(gd_parametric_contains(scene.surface, 3, 2));
    assert_true(gd_parametric_contains(scene.surface, 2 + M_SQRT1_2, 2 - M_SQRT1_2));
    assert_true(gd_parametric_contains(scene.surface, 2, 1 - 1e-6));
    assert_false(gd_parametric_contains(scene.surface, 2, 1 + 1e-6));
    assert_false(gd_parametric_contains(scene.surface, 2, 2));
    /* computes the points nearest to a position above the domain, to a position in the hole, and to
     * a position beyond a corner */
    check_ok(
        gd_parametric_nearest(scene.surface, (struct gd_vec3){0.5, 0.7, 2}, NULL, &found, NULL),
        NULL);
    check_close(found.distance, 2, promise);
    check_ok(
        gd_parametric_nearest(scene.surface, (struct gd_vec3){2.3, 2.4, 0}, NULL, &found, NULL),
        NULL);
    check_close(found.distance, 0.5, promise);
    assert_true(fabs(found.u - 2.6) < 1e-9 && fabs(found.v - 2.8) < 1e-9);
    check_ok(gd_parametric_nearest(scene.surface, (struct gd_vec3){7, 8, 0}, NULL, &found, NULL),
             NULL);
    check_close(found.distance, 5, promise);
    close_scene(&scene);
}

/* Tests a point on one side of the hole, and a curve on the other side. */
static void a_curve_behind_a_hole(void **state)
{
    (void)state;
    struct scene scene = open_plate();
    struct gd_domain_curve *point, *line;
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    const double corners[2][2] = {{3.5, 0.5}, {3.5, 3.5}}, through[2][2] = {{0.5, 2}, {3.5, 2}};
    check_ok(gd_domain_curve_point(scene.surface, 0.5, 2, &point, NULL), NULL);
    check_ok(gd_domain_curve_polyline(scene.surface, &(struct gd_domain_polyline){corners, 2}, NULL,
                                      &line, NULL),
             NULL);
    const struct gd_geodesic_request request = {.from = point, .to = line};
    check_ok(gd_geodesic_solve(scene.tessellation, &request, NULL, &found, &detail), &detail);
    /* tangent, arc, and the tangent that meets the line at a right angle */
    check_close(found.items[0].length, sqrt(1.25) + M_PI_2 - acos(1 / 1.5) + 1.5, promise);
    check_close(found.items[0].to_angle, M_PI_2, 1e-7);
    gd_geodesics_free(&found);
    gd_domain_curve_release(line);
    check_ok(gd_domain_curve_polyline(scene.surface, &(struct gd_domain_polyline){through, 2}, NULL,
                                      &line, NULL),
             NULL);
    assert_int_equal(gd_geodesic_solve(scene.tessellation,
                                       &(struct gd_geodesic_request){.from = point, .to = line},
                                       NULL, &found, &detail),
                     GD_INVALID_ARGUMENT);
    gd_domain_curve_release(line);
    gd_domain_curve_release(point);
    close_scene(&scene);
}

/* Tests paths that begin or end on the loop. */
static void paths_along_a_loop(void **state)
{
    (void)state;
    struct scene scene = open_plate();
    double places[4][2];
    const double angles[4] = {0.1, 0.9, 1.7, M_PI};
    for (int i = 0; i < 4; i++)
        places[i][0] = 2 + cos(angles[i]), places[i][1] = 2 + sin(angles[i]);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < i; k++)
            check_close(distance(&scene, places[i], places[k]), angles[i] - angles[k], promise);
    close_scene(&scene);
}

static void a_deadline_ends_the_search(void **state)
{
    (void)state;
    struct scene scene = open_plate();
    struct gd_domain_curve *from = point_at(scene.surface, 0.5, 2),
                           *to = point_at(scene.surface, 3.5, 2);
    struct gd_geodesics found;
    const struct gd_control late = {.deadline_ns = 1};
    assert_int_equal(gd_geodesic_solve(scene.tessellation,
                                       &(struct gd_geodesic_request){.from = from, .to = to}, &late,
                                       &found, NULL),
                     GD_DEADLINE);
    gd_domain_curve_release(from);
    gd_domain_curve_release(to);
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(around_a_circular_hole),
        cmocka_unit_test(past_a_corner_of_a_hole),
        cmocka_unit_test(from_next_to_a_corner),
        cmocka_unit_test(around_a_reflex_corner),
        cmocka_unit_test(between_two_holes),
        cmocka_unit_test(around_a_hole_of_a_cylinder),
        cmocka_unit_test(along_a_parallel_of_a_sphere),
        cmocka_unit_test(distances_are_a_metric),
        cmocka_unit_test(faulty_loops_are_refused),
        cmocka_unit_test(the_mesh_ends_at_the_loops),
        cmocka_unit_test(the_domain_ends_at_the_loops),
        cmocka_unit_test(a_curve_behind_a_hole),
        cmocka_unit_test(paths_along_a_loop),
        cmocka_unit_test(a_deadline_ends_the_search),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
