/* gd_bench nurbs: the shortest path between two closed curves on open bicubic B-spline surfaces, after the second experiment of W.-H. Chen,
 * "Improvement of the shortest path problem with geodesic-like method": the engine in pieces to its default tolerance; single splines of so many
 * control points, as in the paper's table; and its Algorithm 1, which takes the least of all shortest paths between points sampled on the two curves. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/geodesic_like.h"
#include "gd/nurbs.h"
#include "tests/bench/bench.h"

enum { CORNERS = 8, CURVE_DEGREE = 3, COUNT_MOST = 64 };

/* A surface with two curves; its reference is a quintic, refined far below what is measured. */
struct scene {
    uint32_t rows, columns;
    struct gd_parametric *surface;
    struct gd_tessellation *tessellation;
    struct gd_domain_curve *from, *to;
    double exact;
};

/* --- the scene ---------------------------------------------------------------------------------------------------- */

static void set_knots(uint32_t count, double knots[COUNT_MOST])
{
    for (uint32_t i = 0; i < count + CURVE_DEGREE + 1; i++)
        knots[i] = i <= CURVE_DEGREE ? 0 : i >= count ? 1 : (double)(i - CURVE_DEGREE) / (count - CURVE_DEGREE);
}

/* Control points over a grid of cells of size 1, with bumps of up to one cell. */
static struct gd_parametric *make_surface(uint32_t rows, uint32_t columns)
{
    struct gd_parametric *surface;
    struct gd_detail detail = {0};
    struct rng rng = {11};
    double knots[2][COUNT_MOST], (*points)[3] = bench_allocate(rows * columns * sizeof *points);
    set_knots(rows, knots[0]);
    set_knots(columns, knots[1]);
    for (uint32_t i = 0; i < rows * columns; i++) {
        points[i][0] = i / columns;
        points[i][1] = i % columns;
        points[i][2] = rng_between(&rng, -1, 1);
    }
    const struct gd_nurbs_data data = {.degree_u = CURVE_DEGREE,
                                       .degree_v = CURVE_DEGREE,
                                       .count_u = rows,
                                       .count_v = columns,
                                       .knots_u = knots[0],
                                       .knots_v = knots[1],
                                       .knot_count_u = rows + CURVE_DEGREE + 1,
                                       .knot_count_v = columns + CURVE_DEGREE + 1,
                                       .points = (const double(*)[3])points};
    bench_require(gd_nurbs_create(&data, &surface, &detail), &detail);
    free(points);
    return surface;
}

/* A closed cubic B-spline around a place of the domain. */
static struct gd_domain_curve *make_curve(const struct gd_parametric *surface, double u, double v, double radius)
{
    double knots[CORNERS + 2 * CURVE_DEGREE + 1], points[CORNERS + CURVE_DEGREE][2];
    struct gd_domain_curve *curve;
    struct gd_detail detail = {0};
    for (int i = 0; i < CORNERS + 2 * CURVE_DEGREE + 1; i++) knots[i] = i - CURVE_DEGREE;
    for (int i = 0; i < CORNERS + CURVE_DEGREE; i++) {
        double angle = 2 * M_PI * i / CORNERS;
        points[i][0] = u + radius * cos(angle);
        points[i][1] = v + radius * sin(angle);
    }
    bench_require(gd_domain_curve_bspline(surface, CURVE_DEGREE, knots, (const double(*)[2])points,
                                          CORNERS + CURVE_DEGREE, &curve, &detail),
                  &detail);
    return curve;
}

/* Returns the length; `*points`, if it is not NULL: how many control points the path has. */
static double solve(const struct scene *scene, const struct gd_domain_curve *from, const struct gd_domain_curve *to,
                    const struct gd_geodesic_options *options, uint32_t *points)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    bench_require(gd_geodesic_solve(scene->tessellation, from, to, options, bench_control(), &found, &detail), &detail);
    double length = found.items[0].length;
    for (uint32_t i = 0; points && i < found.items[0].piece_count; i++)
        *points += found.items[0].pieces[i].count - (i > 0);
    gd_geodesics_free(&found);
    return length;
}

static struct scene open_scene(uint32_t rows, uint32_t columns)
{
    struct scene scene = {.rows = rows, .columns = columns, .surface = make_surface(rows, columns)};
    bench_require(gd_tessellation_build(scene.surface, NULL, NULL, &scene.tessellation, NULL), NULL);
    scene.from = make_curve(scene.surface, 0.2, 0.3, 0.12);
    scene.to = make_curve(scene.surface, 0.8, 0.65, 0.12);
    scene.exact = solve(&scene, scene.from, scene.to,
                        &(struct gd_geodesic_options){.degree = GD_GEODESIC_DEGREE_MOST, .tolerance = 1e-13}, NULL);
    return scene;
}

static void close_scene(struct scene *scene)
{
    gd_domain_curve_release(scene->from);
    gd_domain_curve_release(scene->to);
    gd_tessellation_release(scene->tessellation);
    gd_parametric_release(scene->surface);
}

/* --- the rows ----------------------------------------------------------------------------------------------------- */

static void print_row(const struct scene *scene, const char *method, uint32_t points, double length, double ms)
{
    printf("{\"surface\":\"%ux%u\",\"method\":\"%s\",\"points\":%u,\"error_percent\":%.2g,\"cpu_ms\":%.2f}\n",
           scene->rows, scene->columns, method, points, 100 * (length / scene->exact - 1), ms);
}

/* The median time of so many runs. */
static void measure_spline(const struct scene *scene, const char *method, const struct gd_geodesic_options *options,
                           uint32_t runs)
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

static struct gd_domain_curve *sample(const struct gd_domain_curve *curve, uint32_t i, uint32_t count)
{
    struct gd_domain_curve *point;
    double low, high, uv[2];
    gd_domain_curve_range(curve, &low, &high);
    gd_domain_curve_at(curve, low + (high - low) * i / count, uv);
    bench_require(gd_domain_curve_point(gd_domain_curve_surface(curve), uv[0], uv[1], &point, NULL), NULL);
    return point;
}

/* Algorithm 1 with `count` points on each curve, each pair of them solved well below the error that sampling makes. */
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

static void measure(uint32_t rows, uint32_t columns, uint32_t runs, uint32_t samples)
{
    static const uint32_t counts[] = {3, 4, 8, 11, 20, 30, 60};
    static const char *const methods[] = {"one quadratic", "one cubic"};
    struct scene scene = open_scene(rows, columns);
    measure_spline(&scene, "pieces", NULL, runs);
    for (uint32_t degree = 2; degree <= 3; degree++) {
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            const struct gd_geodesic_options options = {.degree = degree, .control_points = counts[i]};
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
        if (!bench_take_count(&arguments, "--runs", &runs) || !bench_take_count(&arguments, "--samples", &samples))
            return BENCH_USAGE;
        if (arguments == before) break;
    }
    if (!bench_arguments_end(arguments, false)) return BENCH_USAGE;
    measure(8, 4, runs, samples);
    measure(14, 12, runs, samples);
    return 0;
}
