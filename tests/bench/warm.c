/* gd_bench warm: measures queries of a cached field: paths, and distances in random order and in
 * the order of faces. Distances are queried one by one and as a batch. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/field.h"
#include "tests/bench/bench.h"

enum { POINTS = 100000, PATHS = 5000 };

/* The number of queries a second of each run. */
struct rates {
    double *random_order, *face_order, *random_batch, *face_batch, *paths;
    /* sums over all paths: the number of points except both ends, and the number of paths */
    double crossings, traced;
};

static struct gd_field *build_field(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_seed seed = {.point = bench_random_point(mesh, GD_POINT_FACE, rng)};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    bench_require(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                 NULL, &field, &detail),
                  &detail);
    return field;
}

static double distance_rate(const struct gd_field *field, const struct gd_point *points)
{
    double distance, sum = 0;
    uint64_t start = gd_now_ns();
    for (uint32_t i = 0; i < POINTS; i++) {
        bench_require(gd_field_distance(field, &points[i], &distance), NULL);
        sum += distance;
    }
    double ms = bench_ms_since(start);
    bench_require(sum > 0 ? GD_OK : GD_INTERNAL, NULL);
    return 1e3 * POINTS / ms;
}

static double batch_rate(const struct gd_field *field, const struct gd_point *points,
                         double *distances)
{
    uint64_t start = gd_now_ns();
    bench_require(gd_field_distances(field, points, POINTS, NULL, distances), NULL);
    return 1e3 * POINTS / bench_ms_since(start);
}

/* Returns the number of paths a second. Paths to unreachable points are not counted. */
static double path_rate(const struct gd_field *field, const struct gd_point *points,
                        struct rates *rates)
{
    double before = rates->traced;
    uint64_t start = gd_now_ns();
    for (uint32_t i = 0; i < PATHS; i++) {
        struct gd_path path;
        enum gd_status status = gd_field_path(field, &points[i], &path);
        if (status == GD_NOT_ON_SURFACE) continue;
        bench_require(status, NULL);
        rates->crossings += path.count > 2 ? path.count - 2 : 0;
        rates->traced++;
        gd_path_free(&path);
    }
    return 1e3 * (rates->traced - before) / bench_ms_since(start);
}

/* Orders points by their face in the mesh's order, which is the order in memory. */
static int by_element(const void *a, const void *b)
{
    const struct gd_point *p = a, *q = b;
    return (p->element > q->element) - (p->element < q->element);
}

static void run(const struct gd_mesh *mesh, uint32_t at, struct rng *rng, struct gd_point *points,
                double *distances, struct rates *rates)
{
    struct gd_field *field = build_field(mesh, rng);
    for (uint32_t i = 0; i < POINTS; i++) points[i] = bench_random_point(mesh, GD_POINT_FACE, rng);
    rates->random_order[at] = distance_rate(field, points);
    rates->random_batch[at] = batch_rate(field, points, distances);
    rates->paths[at] = path_rate(field, points, rates);
    qsort(points, POINTS, sizeof *points, by_element);
    rates->face_order[at] = distance_rate(field, points);
    rates->face_batch[at] = batch_rate(field, points, distances);
    gd_field_release(field);
}

static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    uint32_t runs = options->runs;
    double *values = bench_allocate(5 * sizeof *values * runs),
           *distances = bench_allocate(sizeof *distances * POINTS);
    struct rates rates = {.random_order = values,
                          .face_order = values + runs,
                          .random_batch = values + 2 * runs,
                          .face_batch = values + 3 * runs,
                          .paths = values + 4 * runs};
    struct gd_point *points = bench_allocate(sizeof *points * POINTS);
    struct rng rng = {6};
    for (uint32_t i = 0; i < runs; i++) run(mesh, i, &rng, points, distances, &rates);
    bench_print_mesh(name, mesh);
    printf(
        "\"runs\":%u,\"points\":%d,\"distances_per_s\":%.0f,\"distances_per_s_face_order\":%.0f,",
        runs, POINTS, bench_median(rates.random_order, runs), bench_median(rates.face_order, runs));
    printf("\"batch_distances_per_s\":%.0f,\"batch_distances_per_s_face_order\":%.0f,",
           bench_median(rates.random_batch, runs), bench_median(rates.face_batch, runs));
    printf("\"paths_per_s\":%.0f,\"crossings_per_path\":%.1f,", bench_median(rates.paths, runs),
           rates.crossings / fmax(1, rates.traced));
    bench_print_end();
    free(points);
    free(distances);
    free(values);
}

int bench_warm(char **arguments)
{
    return bench_each_mesh(arguments, 5, measure);
}
