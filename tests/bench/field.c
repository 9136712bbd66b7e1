/* gd_bench field: measures the time and the memory of fields. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/field.h"
#include "tests/bench/bench.h"

/* The sums over all runs, and the elapsed time and processor time of each run. */
struct totals {
    double created, propagated, wedges, bytes;
    double *ms, *cpu_ms;
};

static void add_field(const struct gd_mesh *mesh, struct gd_point source, uint32_t run,
                      struct totals *totals)
{
    struct gd_seed seed = {.point = source};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    double start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    enum gd_status status =
        gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                       bench_control(), &field, &detail);
    totals->ms[run] = bench_ms_since(start);
    totals->cpu_ms[run] = bench_thread_ms() - start_cpu_ms;
    bench_require(status, &detail);
    const struct gd_field_statistics *statistics = gd_field_statistics(field);
    totals->created += (double)statistics->windows_created;
    totals->propagated += (double)statistics->windows_propagated;
    totals->wedges += (double)statistics->wedges;
    totals->bytes += (double)gd_field_memsize(field);
    gd_field_release(field);
}

static void print_totals(const struct totals *totals, uint32_t runs, uint32_t edges)
{
    printf("\"windows_created\":%.0f,\"windows_propagated\":%.0f,\"wedges\":%.0f,\"bytes\":%.0f,",
           totals->created / runs, totals->propagated / runs, totals->wedges / runs,
           totals->bytes / runs);
    printf("\"wedges_per_edge\":%.2f,\"bytes_per_edge\":%.1f,", totals->wedges / runs / edges,
           totals->bytes / runs / edges);
}

static void add_distances(const struct gd_mesh *mesh, struct gd_point source, double *distances,
                          double *ms, double *cpu_ms)
{
    struct gd_seed seed = {.point = source};
    struct gd_detail detail = {0};
    double start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    enum gd_status status =
        gd_field_distances_only(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                bench_control(), distances, &detail);
    *ms = bench_ms_since(start);
    *cpu_ms = bench_thread_ms() - start_cpu_ms;
    bench_require(status, &detail);
}

/* Measures `field --distances-only`: the times, and the memory of one call without the mesh and the
 * answer. The memory is computed from the peak of the process during the first call. */
static void measure_distances(const char *name, const struct gd_mesh *mesh,
                              const struct bench_options *options)
{
    uint32_t runs = options->runs;
    double *times = bench_allocate(2 * sizeof *times * runs);
    double *distances = bench_allocate(sizeof *distances * gd_mesh_summary(mesh)->index_count);
    /* makes the array resident before the measurement */
    memset(distances, 0, sizeof *distances * gd_mesh_summary(mesh)->index_count);
    struct rng rng = {1};
    double bytes = 0;
    bench_forget_peak();
    uint64_t before = bench_resident_bytes();
    for (uint32_t run = 0; run < runs; run++) {
        struct gd_point source = bench_random_point(mesh, GD_POINT_FACE, &rng);
        add_distances(mesh, source, distances, times + run, times + runs + run);
        if (run == 0) bytes = (double)(bench_peak_bytes() - before);
    }
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"distances_ms\":%.3f,\"distances_cpu_ms\":%.3f,\"bytes\":%.0f,\"bytes_per_"
           "face\":%.1f,",
           runs, bench_median(times, runs), bench_median(times + runs, runs), bytes,
           bytes / gd_mesh_summary(mesh)->faces);
    bench_print_end();
    free(distances);
    free(times);
}

/* Measures the process' first field separately, because it cannot reuse memory. The first of the
 * other runs uses the same source as this field. */
static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    if (options->distances_only) {
        measure_distances(name, mesh, options);
        return;
    }
    uint32_t runs = options->runs;
    double *times = bench_allocate(2 * sizeof *times * runs), first_ms, first_cpu_ms;
    struct totals first = {.ms = &first_ms, .cpu_ms = &first_cpu_ms},
                  totals = {.ms = times, .cpu_ms = times + runs};
    struct rng rng = {1};
    struct gd_point source = bench_random_point(mesh, GD_POINT_FACE, &rng);
    add_field(mesh, source, 0, &first);
    for (uint32_t run = 0; run < runs; run++) {
        add_field(mesh, source, run, &totals);
        source = bench_random_point(mesh, GD_POINT_FACE, &rng);
    }
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"field_ms\":%.3f,\"field_ms_p95\":%.3f,\"field_cpu_ms\":%.3f,\"first_ms\":"
           "%.3f,",
           runs, bench_median(totals.ms, runs), bench_quantile(totals.ms, runs, 0.95),
           bench_median(totals.cpu_ms, runs), first_ms);
    print_totals(&totals, runs, gd_mesh_summary(mesh)->edges);
    bench_print_end();
    free(times);
}

int bench_field(char **arguments)
{
    return bench_each_mesh(arguments, 20, measure);
}
