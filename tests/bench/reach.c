#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/ablation.h"
#include "tests/bench/bench.h"

/* Targets are vertices. Each source has one target in each tenth of the largest distance. Uniformly
 * random pairs would leave the near tenths empty. */

enum { TENTHS = 10 };

struct reach {
    /* the windows and the time of each source, divided by those of the whole field */
    double *propagated[TENTHS], *ms[TENTHS];
    uint32_t count[TENTHS];
};

/* Returns a random vertex index whose distance lies in that tenth of `farthest`; GD_NONE if there
 * is none. */
static uint32_t pick_target(const double *distances, uint32_t count, double farthest,
                            uint32_t tenth, struct rng *rng)
{
    uint32_t start = rng_below(rng, count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t index = (start + i) % count;
        double part = distances[index] / farthest * TENTHS;
        if (part > tenth && part <= tenth + 1) return index;
    }
    return GD_NONE;
}

static void reach_from(const struct gd_mesh *mesh, enum setting setting, struct rng *rng,
                       double *distances, struct reach *reach)
{
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    struct trial_request request = {.source = bench_random_point(mesh, GD_POINT_FACE, rng),
                                    .methods = setting_methods(setting, EDGE_BASED),
                                    .distances = distances};
    struct trial whole = trial_run(mesh, &request);
    double farthest = 0;
    for (uint32_t i = 0; i < count; i++)
        if (distances[i] > farthest && isfinite(distances[i])) farthest = distances[i];
    request.distances = NULL;
    for (uint32_t tenth = 0; tenth < TENTHS; tenth++) {
        uint32_t index = pick_target(distances, count, farthest, tenth, rng);
        if (index == GD_NONE) continue;
        struct gd_point target;
        bench_require(gd_point_at_vertex(mesh, (struct gd_vertex){index}, &target, NULL), NULL);
        request.target = &target;
        struct trial part = trial_run(mesh, &request);
        uint32_t at = reach->count[tenth]++;
        reach->propagated[tenth][at] = (double)part.propagated / (double)whole.propagated;
        reach->ms[tenth][at] = part.ms / whole.ms;
    }
}

static void print_medians(const char *name, double *const values[TENTHS],
                          const uint32_t count[TENTHS], const char *end)
{
    printf("\"%s\":[", name);
    for (int i = 0; i < TENTHS; i++) {
        if (count[i])
            printf("%s%.4f", i ? "," : "", bench_median(values[i], count[i]));
        else
            printf("%snull", i ? "," : "");
    }
    printf("]%s", end);
}

void ablation_reach(const struct paper_model *model, const struct gd_mesh *mesh,
                    enum setting setting, uint32_t sources)
{
    struct reach reach = {0};
    double *values = bench_allocate(sizeof *values * 2 * TENTHS * sources);
    double *distances = bench_allocate(sizeof *distances * gd_mesh_summary(mesh)->index_count);
    for (uint32_t i = 0; i < TENTHS; i++) {
        reach.propagated[i] = values + (size_t)i * sources;
        reach.ms[i] = values + (size_t)(TENTHS + i) * sources;
    }
    struct rng rng = {5};
    for (uint32_t i = 0; i < sources; i++) reach_from(mesh, setting, &rng, distances, &reach);
    printf("{\"property\":5,");
    bench_print_text("model", model->name);
    bench_print_text("setting", setting_name(setting));
    printf("\"sources\":%u,", sources);
    print_medians("propagated", reach.propagated, reach.count, ",");
    print_medians("time", reach.ms, reach.count, "}\n");
    fflush(stdout);
    free(values);
    free(distances);
}
