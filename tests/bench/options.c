#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/cpu.h"
#include "tests/bench/bench.h"

bool bench_take_word(char ***arguments, const char *word)
{
    if (!**arguments || strcmp(**arguments, word) != 0) return false;
    ++*arguments;
    return true;
}

/* Removes "NAME NUMBER" with a number from `least` to `most`; `*out` is untouched if the name is
 * not there. */
static bool take_number(char ***arguments, const char *name, double least, double most, double *out)
{
    if (!bench_take_word(arguments, name)) return true;
    const char *text = **arguments ? **arguments : "";
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= least && value <= most)) {
        fprintf(stderr,
                "gd_bench: %s must be followed by a number from %.15g to %.15g, not by \"%s\".\n",
                name, least, most, text);
        return false;
    }
    ++*arguments;
    *out = value;
    return true;
}

static bool take_whole(char ***arguments, const char *name, double least, double most,
                       uint32_t *out)
{
    double value = *out;
    if (!take_number(arguments, name, least, most, &value)) return false;
    *out = (uint32_t)value;
    if (*out == value) return true;
    fprintf(stderr, "gd_bench: %s wants a whole number, not %g.\n", name, value);
    return false;
}

bool bench_take_count(char ***arguments, const char *name, uint32_t *count)
{
    return take_whole(arguments, name, 1, 1000000, count);
}

bool bench_arguments_end(char **arguments, bool wants_mesh)
{
    if (*arguments && **arguments == '-') {
        fprintf(stderr,
                "gd_bench: there is no option \"%s\" here; gd_bench alone lists what there is.\n",
                *arguments);
        return false;
    }
    if (wants_mesh && !*arguments) {
        fputs("gd_bench: name a mesh: a file, or sample:NAME[,key=value...].\n", stderr);
        return false;
    }
    return true;
}

bool bench_take_cpu(char ***arguments)
{
    if (!bench_take_word(arguments, "--cpu")) return true;
    const char *name = **arguments ? **arguments : "";
    if (gd_cpu_select(name)) {
        fprintf(stderr,
                "gd_bench: --cpu wants auto, baseline, avx2 or avx512, and one that this machine "
                "has, not \"%s\".\n",
                name);
        return false;
    }
    ++*arguments;
    return true;
}

/* Pins the process to one processor. Returns false, after printing a sentence, if the machine has
 * no processor with that number. */
static bool pin(uint32_t cpu)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    if (sched_setaffinity(0, sizeof set, &set) == 0) return true;
    fprintf(stderr, "gd_bench: --pin %u: the process may not run on that processor.\n", cpu);
    return false;
}

bool bench_take_options(char ***arguments, struct bench_options *options)
{
    uint32_t cpu = UINT32_MAX;
    char **before;
    do {
        before = *arguments;
        if (bench_take_word(arguments, "--repair")) options->repair = true;
        if (bench_take_word(arguments, "--distances-only")) options->distances_only = true;
        if (!bench_take_count(arguments, "--runs", &options->runs) ||
            !take_whole(arguments, "--pin", 0, CPU_SETSIZE - 1, &cpu) ||
            !take_whole(arguments, "--subdivide", 0, 8, &options->levels) ||
            !take_whole(arguments, "--landmarks", 1, 32, &options->landmarks) ||
            !bench_take_cpu(arguments) ||
            !take_number(arguments, "--noise", 0, 10, &options->noise))
            return false;
    } while (*arguments != before);
    return bench_arguments_end(*arguments, true) && (cpu == UINT32_MAX || pin(cpu));
}
