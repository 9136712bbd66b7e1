/* gd_ablation: repeats the tables of Y.-J. Liu's paper (paper.h) on models of the sizes in that
 * paper. It is a separate program, because its engine is compiled with the switch one_list
 * (-DGD_ABLATION). */
#include "tests/bench/ablation.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/bench.h"

static const struct {
    const char *name;
    struct gd__variant methods;
} settings[SETTINGS] = {
    [PLAIN] = {"plain", {.no_filter = true, .no_cone = true}},
    [PLAIN_APART] = {"plain-not-coalesced",
                     {.no_filter = true, .no_cone = true, .no_coalescing = true}},
    [NO_FILTER] = {"no-filter", {.no_filter = true}},
    [ALL_METHODS] = {"all-methods", {.no_filter = false}},
};

const char *setting_name(enum setting setting)
{
    return settings[setting].name;
}

struct gd__variant setting_methods(enum setting setting, enum structure structure)
{
    struct gd__variant methods = settings[setting].methods;
    methods.one_list = structure != HALF_EDGE;
    return methods;
}

static bool measure(const struct paper_model *model, uint32_t sources)
{
    struct gd_mesh *mesh = bench_open(model->sample, NULL);
    if (!mesh) return false;
    ablation_edges(model, mesh);
    ablation_wedges(model, mesh, sources ? sources : model->sources);
    ablation_reach(model, mesh, PLAIN, sources ? sources : model->targets);
    ablation_reach(model, mesh, ALL_METHODS, sources ? sources : model->targets);
    gd_mesh_release(mesh);
    return true;
}

static bool are_models(char **names)
{
    for (; *names; names++) {
        if (paper_find(*names)) continue;
        fprintf(stderr, "gd_bench: there is no model \"%s\". There are:", *names);
        for (uint32_t i = 0; i < paper_model_count; i++)
            fprintf(stderr, " %s", paper_models[i].name);
        fputs(".\n", stderr);
        return false;
    }
    return true;
}

int main(int argc, char **argv)
{
    char **arguments = argv + (argc > 0);
    bool quick = bench_take_word(&arguments, "--quick"), well = true;
    uint32_t sources = 0;
    if (!bench_take_count(&arguments, "--sources", &sources) ||
        !bench_arguments_end(arguments, false) || !are_models(arguments))
        return BENCH_USAGE;
    if (quick) return ablation_agreement() ? EXIT_SUCCESS : EXIT_FAILURE;
    if (!*arguments)
        for (uint32_t i = 0; i < paper_model_count && well; i++)
            well = measure(&paper_models[i], sources);
    for (; *arguments && well; arguments++) well = measure(paper_find(*arguments), sources);
    return well ? EXIT_SUCCESS : EXIT_FAILURE;
}
