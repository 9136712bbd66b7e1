/* gd_bench SUBCOMMAND [arguments]: measures the engine; prints JSON lines. */
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/bench/bench.h"

/* Replaces this program by gd_ablation, which is in the same folder. */
static int run_ablation(char **arguments)
{
    char path[PATH_MAX + 1];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - sizeof "gd_ablation");
    if (length > 0) {
        path[length] = 0;
        strcpy(strrchr(path, '/') + 1, "gd_ablation");
        *--arguments = path; /* this element holds the subcommand's name */
        execv(path, arguments);
    }
    perror("gd_bench: gd_ablation");
    return EXIT_FAILURE;
}

static const struct {
    const char *name, *arguments, *sentence;
    int (*run)(char **arguments);
} commands[] = {
    {"field", "[OPTION...] MESH...", "fields of random sources: time, windows, wedges, memory",
     bench_field},
    {"pair", "[OPTION...] MESH...", "distances of random pairs of points, each from nothing",
     bench_pair},
    {"warm", "[OPTION...] MESH...", "distances and paths from a field that is kept", bench_warm},
    {"locate", "[OPTION...] MESH...", "nearest points and first hits of rays", bench_locate},
    {"trace", "[OPTION...] MESH...", "straightest geodesics, the log map of a point, means",
     bench_trace},
    {"spline", "", "geodesic Hermite splines at the sizes of their paper's table", bench_spline},
    {"limit", "[--quick] [--loop] [MESH...]",
     "limit surfaces: a million vertices, 360 geodesics, and the same by other means; a cube when "
     "none is named",
     bench_limit},
    {"curve", "[OPTION...] MESH...",
     "fields of a curve of a thousand segments: seeding them, and all of it", bench_curve},
    {"nurbs", "[--runs N] [--samples N]",
     "shortest paths between curves of smooth surfaces, and the sampling that their paper starts "
     "from",
     bench_nurbs},
    {"load", "[OPTION...] MESH...", "from a file to a mesh: reading, parsing, building",
     bench_load},
    {"peer", "[--cpu NAME] [--pair] MESH VERTEX...",
     "the engine by the protocol of races (tests/bench/peer.h)", bench_peer},
    {"export", "[OPTION...] MESH", "the mesh as every solver takes it, OBJ on standard output",
     bench_export},
    {"ablation", "[--quick] [--sources N] [MODEL...]",
     "the paper's tables remade; --quick: only check that every combination of methods gives the "
     "same distances",
     run_ablation},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static void print_usage(void)
{
    for (int i = 0; i < COMMANDS; i++)
        fprintf(stderr, "%s gd_bench %s %s\n           %s\n",
                i ? "      " : "usage:", commands[i].name, commands[i].arguments,
                commands[i].sentence);
    fputs("MESH is a file in any format that the engine reads, or sample:NAME[,key=value...] (see "
          "gd_sample --list).\n"
          "OPTION: --runs N        repetitions: sources, pairs, rounds of questions, loadings\n"
          "        --pin PROCESSOR stay on that processor\n"
          "        --cpu NAME      kernels: baseline, avx2, avx512 (auto)\n"
          "        --landmarks N   pair: build so many first\n"
          "        --distances-only  field: only the vertices' distances, no wedges\n"
          "        --repair        separate non-manifold parts\n"
          "        --subdivide N   split every triangle at the middles of its edges, N times\n"
          "        --noise A       then move every vertex along its normal by up to A mean edges\n",
          stderr);
}

int main(int argc, char **argv)
{
    for (int i = 0; i < COMMANDS && argc > 1; i++)
        if (strcmp(argv[1], commands[i].name) == 0) return commands[i].run(argv + 2);
    print_usage();
    return BENCH_USAGE;
}
