#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/ablation.h"
#include "tests/bench/bench.h"

/* --- Table 1 ---------------------------------------------------------------------------------- */

static double edge_sigma(const struct gd_mesh *mesh)
{
    double mean = gd_mesh_summary(mesh)->edge_length.mean, sum = 0;
    for (uint32_t edge = 0; edge < mesh->edge_count; edge++) {
        double off = mesh->side[2 * edge].length * mesh->unit - mean;
        sum += off * off;
    }
    return sqrt(sum / mesh->edge_count);
}

void ablation_edges(const struct paper_model *model, const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *s = gd_mesh_summary(mesh);
    printf("{\"table\":1,");
    bench_print_text("model", model->name);
    bench_print_text("mesh", model->sample);
    printf("\"faces\":%u,\"edge_no\":%u,\"genus\":%lld,\"saddles\":%u,\"vertices\":%u,", s->faces,
           3 * s->faces, (long long)s->genus, s->saddle_vertices, s->vertices);
    printf("\"mean\":%.6f,\"sigma\":%.6f,\"max\":%.6f,\"min\":%.6f,", s->edge_length.mean,
           edge_sigma(mesh), s->edge_length.max, s->edge_length.min);
    printf("\"printed\":{\"faces\":%u,\"mean\":%.6f,\"sigma\":%.6f,\"max\":%.6f,\"min\":%.6f}}\n",
           model->printed->edges.faces, model->printed->edges.mean, model->printed->edges.sigma,
           model->printed->edges.max, model->printed->edges.min);
    fflush(stdout);
}

/* --- Tables 2, 3 and 4 ------------------------------------------------------------------------ */

/* The results of one setting and structure: the sums of counts over all sources, and the time of
 * each source. */
struct sums {
    double produced, propagated, kept, merged;
    double *ms;
};

static void print_ratio(const char *name, const double ours[STRUCTURES],
                        const double printed[STRUCTURES], const char *end)
{
    printf("\"%s\":{\"half_edge\":%.8g,\"edge_based\":%.8g,\"saved\":%.4f,\"printed\":[%.8g,%.8g],"
           "\"printed_saved\":%.4f}%s",
           name, ours[0], ours[1], 1 - ours[1] / ours[0], printed[0], printed[1],
           1 - printed[1] / printed[0], end);
}

static void print_setting(const struct paper_model *model, enum setting setting,
                          const struct sums sums[STRUCTURES], uint32_t sources)
{
    double produced[STRUCTURES], kept[STRUCTURES], seconds[STRUCTURES];
    for (int i = 0; i < STRUCTURES; i++) {
        produced[i] = sums[i].produced / sources;
        kept[i] = sums[i].kept / sources;
        seconds[i] = 1e-3 * bench_median(sums[i].ms, sources);
    }
    printf("{\"table\":\"2-4\",");
    bench_print_text("model", model->name);
    bench_print_text("setting", setting_name(setting));
    printf("\"sources\":%u,", sources);
    print_ratio("produced", produced, model->printed->produced, ",");
    print_ratio("kept", kept, model->printed->kept, ",");
    print_ratio("seconds", seconds, model->printed->seconds, ",");
    printf("\"kept_if_merged_at_the_end\":%.0f,\"propagated\":[%.0f,%.0f]}\n",
           sums[0].merged / sources, sums[0].propagated / sources, sums[1].propagated / sources);
    fflush(stdout);
}

static void add_trial(const struct gd_mesh *mesh, const struct gd_point *source,
                      enum setting setting, enum structure structure, struct sums *sums,
                      uint32_t at)
{
    struct trial trial =
        trial_run(mesh, &(struct trial_request){.source = *source,
                                                .methods = setting_methods(setting, structure)});
    sums->produced += (double)trial.produced;
    sums->propagated += (double)trial.propagated;
    sums->kept += (double)(structure == HALF_EDGE ? trial.kept_half : trial.kept_merged);
    sums->merged += (double)trial.kept_merged;
    sums->ms[at] = trial.ms;
}

/* All settings and structures run for each source, alternately in forward and in backward order.
 * The load of the machine and the allocator's state therefore affect all of them equally. */
void ablation_wedges(const struct paper_model *model, const struct gd_mesh *mesh, uint32_t sources)
{
    struct sums sums[SETTINGS][STRUCTURES] = {0};
    double *ms = bench_allocate(sizeof *ms * sources * SETTINGS * STRUCTURES);
    struct rng rng = {1};
    for (int i = 0; i < SETTINGS * STRUCTURES; i++)
        sums[i / STRUCTURES][i % STRUCTURES].ms = ms + (size_t)i * sources;
    for (uint32_t at = 0; at < sources; at++) {
        struct gd_point source = bench_random_point(mesh, GD_POINT_FACE, &rng);
        for (int turn = 0; turn < SETTINGS * STRUCTURES; turn++) {
            int i = at % 2 ? SETTINGS * STRUCTURES - 1 - turn : turn;
            add_trial(mesh, &source, i / STRUCTURES, i % STRUCTURES,
                      &sums[i / STRUCTURES][i % STRUCTURES], at);
        }
    }
    for (int setting = 0; setting < SETTINGS; setting++)
        print_setting(model, setting, sums[setting], sources);
    free(ms);
}
