/* gd_bench field: how long fields take, what they hold. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/field.h"
#include "tests/bench/bench.h"

/* Sums over the runs. */
struct totals {
    double created, propagated, wedges, bytes;
};

static double time_field(const struct gd_mesh *mesh, struct gd_point source, struct totals *totals)
{
    struct gd_seed seed = {.point = source};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    uint64_t start = gd_now_ns();
    enum gd_status status =
        gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL, NULL, &field, &detail);
    double ms = bench_ms_since(start);
    bench_require(status, &detail);
    const struct gd_field_statistics *statistics = gd_field_statistics(field);
    totals->created += (double)statistics->windows_created;
    totals->propagated += (double)statistics->windows_propagated;
    totals->wedges += (double)statistics->wedges;
    totals->bytes += (double)gd_field_memsize(field);
    gd_field_release(field);
    return ms;
}

static void measure(const char *name, const struct gd_mesh *mesh, uint32_t runs)
{
    double *ms = bench_allocate(sizeof *ms * runs);
    struct totals first = {0}, totals = {0};
    struct rng rng = {1};
    struct gd_point source = bench_random_point(mesh, GD_POINT_FACE, &rng);
    double first_ms = time_field(mesh, source, &first);
    for (uint32_t i = 0; i < runs; i++) {
        ms[i] = time_field(mesh, source, &totals);
        source = bench_random_point(mesh, GD_POINT_FACE, &rng);
    }
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    printf("{");
    bench_print_text("mesh", name);
    printf("\"vertices\":%u,\"faces\":%u,\"edges\":%u,\"runs\":%u,", summary->vertices, summary->faces, summary->edges,
           runs);
    printf("\"field_ms\":%.3f,\"field_ms_p95\":%.3f,\"first_ms\":%.3f,", bench_median(ms, runs),
           bench_quantile(ms, runs, 0.95), first_ms);
    printf("\"windows_created\":%.0f,\"windows_propagated\":%.0f,\"wedges\":%.0f,\"bytes\":%.0f,\"peak_bytes\":%llu}\n",
           totals.created / runs, totals.propagated / runs, totals.wedges / runs, totals.bytes / runs,
           (unsigned long long)bench_peak_bytes());
    fflush(stdout);
    free(ms);
}

int bench_field(char **arguments)
{
    uint32_t runs = 20;
    if (!bench_take_count(&arguments, "--runs", &runs) || !bench_arguments_end(arguments, true)) return BENCH_USAGE;
    for (; *arguments; arguments++) {
        struct gd_mesh *mesh = bench_open(*arguments);
        if (!mesh) return EXIT_FAILURE;
        measure(*arguments, mesh, runs);
        gd_mesh_release(mesh);
    }
    return EXIT_SUCCESS;
}
