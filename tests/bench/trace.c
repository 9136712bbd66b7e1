/* gd_bench trace: measures straightest geodesics in edge crossings a second, log maps from a cached
 * field, and means. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/field.h"
#include "gd/mean.h"
#include "gd/vector.h"
#include "tests/bench/bench.h"

enum { LINES = 1000, EDGES = 300, MAPS = 3, MEANS = 10, MEAN_POINTS = 4 };

/* Traces lines from random points of faces in random directions. Each line is as long as EDGES mean
 * edges. Returns the number of edge crossings a second. */
static double trace_rate(const struct gd_mesh *mesh, struct rng *rng)
{
    double length = EDGES * gd_mesh_summary(mesh)->edge_length.mean;
    uint64_t crossings = 0, start = gd_now_ns();
    for (int i = 0; i < LINES; i++) {
        struct gd_point from = bench_random_point(mesh, GD_POINT_FACE, rng);
        struct gd_direction ahead;
        struct gd_trace trace;
        bench_require(gd_direction_at_angle(mesh, &from, rng_between(rng, 0, 6), &ahead, NULL),
                      NULL);
        bench_require(
            gd_trace_follow(
                mesh, &(struct gd_trace_request){.start = &from, .ahead = &ahead, .length = length},
                NULL, &trace, NULL),
            NULL);
        crossings += trace.path.count - 1;
        gd_trace_free(&trace);
    }
    return 1e3 * (double)crossings / bench_ms_since(start);
}

/* Returns the milliseconds of one log map. */
static double log_time(const struct gd_mesh *mesh, struct rng *rng)
{
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    double *angles = bench_allocate(2 * count * sizeof *angles);
    struct gd_seed seed = {.point = bench_random_point(mesh, GD_POINT_FACE, rng)};
    struct gd_field *field;
    bench_require(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                 bench_control(), &field, NULL),
                  NULL);
    uint64_t start = gd_now_ns();
    for (int i = 0; i < MAPS; i++)
        bench_require(gd_vector_log_all(field, NULL, angles, angles + count, NULL), NULL);
    double time = bench_ms_since(start) / MAPS;
    gd_field_release(field);
    free(angles);
    return time;
}

/* Returns the milliseconds of one mean of random points of one component. */
static double mean_time(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_point points[MEAN_POINTS];
    struct gd_mean mean;
    uint64_t start = gd_now_ns();
    for (int i = 0; i < MEANS; i++) {
        for (uint32_t k = 0; k < MEAN_POINTS;) {
            points[k] = bench_random_point(mesh, GD_POINT_FACE, rng);
            if (gd_point_component(mesh, &points[k]) == gd_point_component(mesh, &points[0])) k++;
        }
        bench_require(
            gd_mean_find(mesh, &(struct gd_mean_request){.points = points, .count = MEAN_POINTS},
                         bench_control(), &mean, NULL),
            NULL);
    }
    return bench_ms_since(start) / MEANS;
}

static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    uint32_t runs = options->runs;
    double *traces = bench_allocate(3 * sizeof *traces * runs), *logs = traces + runs,
           *means = logs + runs;
    struct rng rng = {7};
    for (uint32_t run = 0; run < runs; run++) {
        traces[run] = trace_rate(mesh, &rng);
        logs[run] = log_time(mesh, &rng);
        means[run] = mean_time(mesh, &rng);
    }
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"crossings_per_s\":%.0f,\"log_map_ms\":%.3f,\"mean_of_%d_ms\":%.3f,", runs,
           bench_median(traces, runs), bench_median(logs, runs), MEAN_POINTS,
           bench_median(means, runs));
    bench_print_end();
    free(traces);
}

int bench_trace(char **arguments)
{
    return bench_each_mesh(arguments, 5, measure);
}
