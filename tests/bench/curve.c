/* gd_bench curve: measures fields of a curve with about a thousand segments, each of which is an
 * exact source. Prints the cost of seeding, and the cost of the field relative to the field of a
 * point. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/curve.h"
#include "tests/bench/bench.h"

enum {
    SEGMENTS = 1000,
    /* largest number of points that are joined; on a small mesh, the curve through them can have
     * fewer than SEGMENTS segments */
    MOST_POINTS = 64
};

/* Joins random points by shortest paths until the curve has SEGMENTS segments. Cuts off further
 * segments. Returns the curve. */
static struct gd_curve random_curve(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_point points[MOST_POINTS];
    struct gd_detail detail = {0};
    struct gd_curve curve = {0};
    for (uint32_t i = 0; i < MOST_POINTS; i++)
        points[i] = bench_random_point(mesh, GD_POINT_FACE, rng);
    for (uint32_t count = 2; count <= MOST_POINTS && curve.count <= SEGMENTS; count *= 2) {
        struct gd_curve_request request = {
            .kind = GD_CURVE_POINTS, .points = points, .count = count};
        gd_curve_free(&curve);
        bench_require(gd_curve_resolve(mesh, &request, bench_control(), &curve, &detail), &detail);
    }
    if (curve.count > SEGMENTS + 1) curve.count = SEGMENTS + 1;
    return curve;
}

/* Returns the processor time of a field. */
static double build(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    const struct gd_field_request request = {.seeds = seeds, .seed_count = count};
    double start = bench_thread_ms();
    bench_require(gd_field_build(mesh, &request, bench_control(), &field, &detail), &detail);
    double ms = bench_thread_ms() - start;
    gd_field_release(field);
    return ms;
}

/* Records when the first side has been propagated, and stops there. */
static bool stop_watch(void *user, double fraction)
{
    (void)fraction;
    double *ms = user;
    if (!*ms) *ms = bench_thread_ms();
    return false;
}

/* Returns the processor time until a field's first side has been propagated. At that time all seeds
 * are checked, sorted by face and emitted. Releasing the cancelled field is not counted. */
static double begin(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count)
{
    struct gd_field *field = NULL;
    double begun = 0;
    struct gd_control control = *bench_control();
    control.progress = stop_watch;
    control.user = &begun;
    const struct gd_field_request request = {.seeds = seeds, .seed_count = count};
    double start = bench_thread_ms();
    enum gd_status status = gd_field_build(mesh, &request, &control, &field, NULL);
    if (status != GD_CANCELLED) bench_require(GD_INTERNAL, NULL);
    return begun - start;
}

static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    struct rng rng = {8};
    uint32_t runs = options->runs;
    struct gd_curve curve = random_curve(mesh, &rng);
    uint32_t count = gd_curve_seed_count(&curve);
    struct gd_seed *seeds = bench_allocate(count * sizeof *seeds);
    double *values = bench_allocate(3 * runs * sizeof *values), *seeding = values,
           *whole = values + runs, *point = values + 2 * (size_t)runs;
    gd_curve_seeds(&curve, 0, seeds);
    for (uint32_t i = 0; i < runs; i++) {
        /* subtracts the cost of a field with one seed */
        seeding[i] = begin(mesh, seeds, count) - begin(mesh, seeds, 1);
        whole[i] = build(mesh, seeds, count);
        point[i] = build(mesh, seeds, 1);
    }
    double seeding_ms = bench_median(seeding, runs), field_ms = bench_median(whole, runs);
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"segments\":%u,\"seeding_cpu_ms\":%.3f,\"curve_field_cpu_ms\":%.3f,"
           "\"point_field_cpu_ms\":%.3f,",
           runs, count - curve.count, seeding_ms, field_ms, bench_median(point, runs));
    printf("\"seeding_part\":%.4f,", seeding_ms / field_ms);
    bench_print_end();
    free(values);
    free(seeds);
    gd_curve_free(&curve);
}

int bench_curve(char **arguments)
{
    return bench_each_mesh(arguments, 7, measure);
}
