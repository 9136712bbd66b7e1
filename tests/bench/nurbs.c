/* gd_bench nurbs: measures the shortest path between two closed curves, after the examples of W.-H.
 * Chen, "Improvement of the shortest path problem with geodesic-like method". The surfaces are an
 * open bicubic B-spline surface of 8 x 4 control points, and a model of a human face with two
 * holes. The program compares three methods. The first is the engine's: piecewise splines at the
 * default tolerance. The second is that of the paper's table: single splines of given numbers of
 * control points. The third is the paper's Algorithm 1: the shortest of all paths between points
 * sampled on the two curves. The reference is a solution of the geodesic equation, found by
 * shooting, that meets both curves at right angles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/geodesic_like.h"
#include "gd/nurbs.h"
#include "tests/bench/bench.h"
#include "tests/unit/nurbs/face.h"
#include "tests/unit/nurbs/shooting.h"

enum { ROWS = 8, COLUMNS = 4 };

/* A surface with two curves. `exact` is the length that shooting finds. */
struct scene {
    const char *name;
    struct gd_parametric *surface;
    struct gd_tessellation *tessellation;
    struct gd_domain_curve *from, *to;
    double exact;
};

/* --- the scenes ------------------------------------------------------------------------------- */

/* Returns a surface with control points over a grid of cells of size 1, with bumps of up to one
 * cell. */
static struct gd_parametric *make_bumps(void)
{
    struct gd_parametric *surface;
    struct gd_detail detail = {0};
    struct rng rng = {11};
    double knots[2][ROWS + FACE_DEGREE + 1], points[ROWS * COLUMNS][3];
    face_knots(ROWS, knots[0]);
    face_knots(COLUMNS, knots[1]);
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        points[i][0] = i / COLUMNS;
        points[i][1] = i % COLUMNS;
        points[i][2] = rng_between(&rng, -1, 1);
    }
    const struct gd_nurbs_data data = {.degree_u = FACE_DEGREE,
                                       .degree_v = FACE_DEGREE,
                                       .count_u = ROWS,
                                       .count_v = COLUMNS,
                                       .knots_u = knots[0],
                                       .knots_v = knots[1],
                                       .knot_count_u = ROWS + FACE_DEGREE + 1,
                                       .knot_count_v = COLUMNS + FACE_DEGREE + 1,
                                       .points = (const double(*)[3])points};
    bench_require(gd_nurbs_create(&data, &surface, &detail), &detail);
    return surface;
}

/* Returns the length of the path. Sets `*points`, if not NULL, to the number of control points. */
static double solve(const struct scene *scene, const struct gd_domain_curve *from,
                    const struct gd_domain_curve *to, const struct gd_geodesic_options *options,
                    uint32_t *points)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    bench_require(
        gd_geodesic_solve(scene->tessellation,
                          &(struct gd_geodesic_request){.from = from, .to = to, .options = options},
                          bench_control(), &found, &detail),
        &detail);
    double length = found.items[0].length;
    for (uint32_t i = 0; points && i < found.items[0].piece_count; i++)
        *points += found.items[0].pieces[i].count - (i > 0);
    gd_geodesics_free(&found);
    return length;
}

/* Returns the length of the solution of the geodesic equation. Only the initial values are from the
 * engine. */
static double shoot_scene(const struct scene *scene)
{
    struct gd_geodesics found;
    double places[257][2];
    bench_require(
        gd_geodesic_solve(scene->tessellation,
                          &(struct gd_geodesic_request){.from = scene->from, .to = scene->to}, NULL,
                          &found, NULL),
        NULL);
    const struct gd_geodesic *path = &found.items[0];
    bench_require(gd_geodesic_sample(scene->surface, path, 257, places, NULL), NULL);
    struct shot shot = {path->from_parameter, path->to_parameter, path->length, 0};
    shot.side = shooting_side(scene->from, shot.s, places[1]);
    bool arrived = shoot_between(scene->from, scene->to, &shot);
    gd_geodesics_free(&found);
    bench_require(arrived ? GD_OK : GD_INTERNAL, NULL);
    return shot.length;
}

static void prepare(struct scene *scene)
{
    bench_require(gd_tessellation_build(scene->surface, NULL, NULL, &scene->tessellation, NULL),
                  NULL);
    scene->exact = shoot_scene(scene);
}

static struct scene open_bumps(void)
{
    struct scene scene = {.name = "8x4", .surface = make_bumps()};
    bench_require(face_outline(scene.surface, 0.2, 0.3, 0.12, 0.12, &scene.from), NULL);
    bench_require(face_outline(scene.surface, 0.8, 0.65, 0.12, 0.12, &scene.to), NULL);
    prepare(&scene);
    return scene;
}

static struct scene open_face(void)
{
    struct scene scene = {.name = "face"};
    struct gd_detail detail = {0};
    bench_require(face_create(&scene.surface, &detail), &detail);
    bench_require(face_eye(scene.surface, 0, &scene.from), NULL);
    bench_require(face_eye(scene.surface, 1, &scene.to), NULL);
    prepare(&scene);
    return scene;
}

static void close_scene(struct scene *scene)
{
    gd_domain_curve_release(scene->from);
    gd_domain_curve_release(scene->to);
    gd_tessellation_release(scene->tessellation);
    gd_parametric_release(scene->surface);
}

/* --- the rows --------------------------------------------------------------------------------- */

static void print_row(const struct scene *scene, const char *method, uint32_t points, double length,
                      double ms)
{
    printf("{\"surface\":\"%s\",\"method\":\"%s\",\"points\":%u,\"length\":%.12g,\"error_percent\":"
           "%.2g,\"cpu_ms\":%."
           "2f}\n",
           scene->name, method, points, length, 100 * (length / scene->exact - 1), ms);
}

/* Measures single splines; prints the median time of several runs. */
static void measure_spline(const struct scene *scene, const char *method,
                           const struct gd_geodesic_options *options, uint32_t runs)
{
    double *ms = bench_allocate(runs * sizeof *ms), length = 0;
    uint32_t points = 0;
    for (uint32_t i = 0; i < runs; i++) {
        double start = bench_thread_ms();
        points = 0;
        length = solve(scene, scene->from, scene->to, options, &points);
        ms[i] = bench_thread_ms() - start;
    }
    print_row(scene, method, points, length, bench_median(ms, runs));
    free(ms);
}

static struct gd_domain_curve *sample(const struct gd_domain_curve *curve, uint32_t i,
                                      uint32_t count)
{
    struct gd_domain_curve *point;
    double low, high, uv[2];
    gd_domain_curve_range(curve, &low, &high);
    gd_domain_curve_at(curve, low + (high - low) * i / count, uv);
    bench_require(gd_domain_curve_point(gd_domain_curve_surface(curve), uv[0], uv[1], &point, NULL),
                  NULL);
    return point;
}

/* Measures Algorithm 1 with `count` points on each curve. The error of each pair's path is much
 * smaller than the error of the sampling. */
static void measure_sampling(const struct scene *scene, uint32_t count)
{
    const struct gd_geodesic_options options = {.tolerance = 1e-8};
    double least = INFINITY, start = bench_thread_ms();
    for (uint32_t i = 0; i < count; i++) {
        struct gd_domain_curve *from = sample(scene->from, i, count);
        for (uint32_t k = 0; k < count; k++) {
            struct gd_domain_curve *to = sample(scene->to, k, count);
            least = fmin(least, solve(scene, from, to, &options, NULL));
            gd_domain_curve_release(to);
        }
        gd_domain_curve_release(from);
    }
    print_row(scene, "sampling (Algorithm 1)", count, least, bench_thread_ms() - start);
}

static void measure(struct scene scene, uint32_t runs, uint32_t samples)
{
    static const uint32_t counts[] = {3,  4,  5,  6,  7,  8,  9,  10, 11,
                                      12, 13, 14, 15, 16, 17, 20, 30, 60};
    static const char *const methods[] = {"one quadratic", "one cubic"};
    measure_spline(&scene, "pieces", NULL, runs);
    for (uint32_t degree = 2; degree <= 3; degree++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            const struct gd_geodesic_options options = {.degree = degree,
                                                        .control_points = counts[i]};
            if (counts[i] > degree) measure_spline(&scene, methods[degree - 2], &options, runs);
        }
    }
    for (uint32_t count = 4; count <= samples; count *= 2) measure_sampling(&scene, count);
    close_scene(&scene);
}

int bench_nurbs(char **arguments)
{
    uint32_t runs = 5, samples = 16;
    while (*arguments) {
        char **before = arguments;
        if (!bench_take_count(&arguments, "--runs", &runs) ||
            !bench_take_count(&arguments, "--samples", &samples))
            return BENCH_USAGE;
        if (arguments == before) break;
    }
    if (!bench_arguments_end(arguments, false)) return BENCH_USAGE;
    measure(open_bumps(), runs, samples);
    measure(open_face(), runs, samples);
    return 0;
}
