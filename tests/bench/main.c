/* gd_bench SUBCOMMAND [arguments]: measures the engine; prints JSON lines. */
#include <stdio.h>
#include <string.h>

#include "tests/bench/bench.h"

static const struct {
    const char *name, *arguments, *sentence;
    int (*run)(char **arguments);
} commands[] = {
    {"ablation", "[--quick] [--sources N] [MODEL...]",
     "the paper's tables remade; --quick: only check that every combination of methods gives the same distances",
     bench_ablation},
    {"field", "[--runs N] MESH...", "fields of random sources: time, windows, wedges, memory", bench_field},
    {"pair", "[--pairs N] MESH...", "distances of random pairs of points, each from nothing", bench_pair},
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static void print_usage(void)
{
    for (int i = 0; i < COMMANDS; i++)
        fprintf(stderr, "%s gd_bench %s %s\n           %s\n", i ? "      " : "usage:", commands[i].name,
                commands[i].arguments, commands[i].sentence);
    fputs("MESH is a file in any format that the engine reads, or sample:NAME[,key=value...] (see gd_sample --list).\n",
          stderr);
}

int main(int argc, char **argv)
{
    for (int i = 0; i < COMMANDS && argc > 1; i++)
        if (strcmp(argv[1], commands[i].name) == 0) return commands[i].run(argv + 2);
    print_usage();
    return BENCH_USAGE;
}
