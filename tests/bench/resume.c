/* gd_bench resume: measures fields that first reach R, a quarter of the largest distance, then 2R,
 * and then the whole mesh. Each of these fields is made in two ways: by resuming the previous
 * field, and from the seed. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/field.h"
#include "tests/bench/bench.h"

/* the steps lead from R to 2R, from 2R to the whole mesh, and from R to the whole mesh */
enum { STEPS = 3 };

/* Processor time and number of propagated windows of each run. */
struct figures {
    /* element 0 is for the resumed field, element 1 for the field that is built from the seed */
    double *ms[STEPS][2], *windows[STEPS][2];
    double *first_ms; /* milliseconds of the field that reaches R */
};

static struct gd_field *build(const struct gd_mesh *mesh, const struct gd_seed *seed, double radius)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    const struct gd_field_request request = {.seeds = seed, .seed_count = 1, .radius = radius};
    bench_require(gd_field_build(mesh, &request, bench_control(), &field, &detail), &detail);
    return field;
}

static struct gd_field *resume(const struct gd_field *partial, double radius)
{
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    bench_require(gd_field_resume(partial, radius, bench_control(), &field, &detail), &detail);
    return field;
}

static double windows_of(const struct gd_field *field)
{
    return (double)gd_field_statistics(field)->windows_propagated;
}

/* Resumes the field to the radius, and builds the same field from the seed. Returns the resumed
 * field. */
static struct gd_field *measure_step(const struct gd_field *partial, const struct gd_seed *seed,
                                     double radius, struct figures *figures, int step, uint32_t run)
{
    double start = bench_thread_ms();
    struct gd_field *resumed = resume(partial, radius);
    double middle = bench_thread_ms();
    struct gd_field *fresh = build(gd_field_mesh(partial), seed, radius);
    figures->ms[step][0][run] = middle - start;
    figures->ms[step][1][run] = bench_thread_ms() - middle;
    figures->windows[step][0][run] = windows_of(resumed) - windows_of(partial);
    figures->windows[step][1][run] = windows_of(fresh);
    gd_field_release(fresh);
    return resumed;
}

static double farthest_vertex(const struct gd_field *field)
{
    uint32_t count = gd_mesh_summary(gd_field_mesh(field))->index_count;
    double *distances = bench_allocate(count * sizeof *distances), farthest = 0;
    gd_field_vertex_distances(field, distances);
    for (uint32_t i = 0; i < count; i++)
        if (distances[i] > farthest && isfinite(distances[i])) farthest = distances[i];
    free(distances);
    return farthest;
}

static void measure_source(const struct gd_mesh *mesh, const struct gd_seed *seed,
                           struct figures *figures, uint32_t run)
{
    struct gd_field *whole = build(mesh, seed, 0);
    double radius = farthest_vertex(whole) / 4;
    gd_field_release(whole);
    double start = bench_thread_ms();
    struct gd_field *near = build(mesh, seed, radius);
    figures->first_ms[run] = bench_thread_ms() - start;
    struct gd_field *twice = measure_step(near, seed, 2 * radius, figures, 0, run);
    gd_field_release(measure_step(twice, seed, 0, figures, 1, run));
    gd_field_release(measure_step(near, seed, 0, figures, 2, run));
    gd_field_release(twice);
    gd_field_release(near);
}

static void print_step(const char *name, struct figures *figures, int step, uint32_t runs)
{
    printf("\"%s\":{\"resumed_cpu_ms\":%.2f,\"built_cpu_ms\":%.2f,", name,
           bench_median(figures->ms[step][0], runs), bench_median(figures->ms[step][1], runs));
    printf("\"resumed_windows\":%.0f,\"built_windows\":%.0f},",
           bench_median(figures->windows[step][0], runs),
           bench_median(figures->windows[step][1], runs));
}

static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    uint32_t runs = options->runs;
    double *values = bench_allocate((4 * STEPS + 1) * sizeof *values * runs);
    struct figures figures = {.first_ms = values + (size_t)4 * STEPS * runs};
    for (int step = 0; step < STEPS; step++) {
        for (int which = 0; which < 2; which++) {
            figures.ms[step][which] = values + (size_t)(4 * step + which) * runs;
            figures.windows[step][which] = values + (size_t)(4 * step + 2 + which) * runs;
        }
    }
    struct rng rng = {6};
    for (uint32_t i = 0; i < runs; i++) {
        struct gd_seed seed = {.point = bench_random_point(mesh, GD_POINT_FACE, &rng)};
        measure_source(mesh, &seed, &figures, i);
    }
    bench_print_mesh(name, mesh);
    printf("\"runs\":%u,\"first_cpu_ms\":%.2f,", runs, bench_median(figures.first_ms, runs));
    print_step("R_to_2R", &figures, 0, runs);
    print_step("2R_to_all", &figures, 1, runs);
    print_step("R_to_all", &figures, 2, runs);
    bench_print_end();
    free(values);
}

int bench_resume(char **arguments)
{
    return bench_each_mesh(arguments, 5, measure);
}
