#include "tests/bench/peer.h"

#include <stdio.h>
#include <stdlib.h>

#include "gd/control.h"
#include "tests/bench/bench.h"

/* One race course: a surface that was built, and where answers go. */
struct course {
    const struct peer *peer;
    void *surface;
    uint32_t vertices;
    double *distances;
};

static void print_times(const char *key, uint64_t start_ns, double start_cpu_ms)
{
    double ms = bench_ms_since(start_ns), cpu_ms = bench_thread_ms() - start_cpu_ms;
    printf("{\"%s\":%.6f,\"cpu_ms\":%.6f,", key, ms, cpu_ms);
}

static bool run_field(const struct course *course, uint32_t source)
{
    double sum = 0, start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    if (!course->peer->field(course->surface, source, course->distances)) return false;
    print_times("field_ms", start, start_cpu_ms);
    for (uint32_t i = 0; i < course->vertices; i++) sum += course->distances[i];
    printf("\"sum\":%.17g}\n", sum);
    return true;
}

static bool run_pair(const struct course *course, uint32_t from, uint32_t to)
{
    double distance, start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    if (!course->peer->pair(course->surface, from, to, &distance)) return false;
    print_times("pair_ms", start, start_cpu_ms);
    printf("\"distance\":%.17g}\n", distance);
    return true;
}

/* The next argument as a vertex; false, after a sentence, when it names none. */
static bool take_vertex(const struct course *course, char ***arguments, uint32_t *out)
{
    const char *text = **arguments ? *(*arguments)++ : "";
    char *end;
    unsigned long value = strtoul(text, &end, 10);
    if (end == text || *end || value >= course->vertices) {
        fprintf(stderr, "%s: \"%s\" is no vertex: they are numbered from 0 to %u.\n", course->peer->name, text,
                course->vertices - 1);
        return false;
    }
    *out = (uint32_t)value;
    return true;
}

static int run_all(const struct course *course, bool pairs, char **arguments)
{
    while (*arguments) {
        uint32_t from, to = 0;
        if (!take_vertex(course, &arguments, &from) || (pairs && !take_vertex(course, &arguments, &to)))
            return BENCH_USAGE;
        if (!(pairs ? run_pair(course, from, to) : run_field(course, from))) {
            fprintf(stderr, "%s: no answer from vertex %u.\n", course->peer->name, from);
            return EXIT_FAILURE;
        }
        fflush(stdout);
        if (course->peer->forget) course->peer->forget(course->surface);
    }
    return EXIT_SUCCESS;
}

int peer_run(const struct peer *peer, char **arguments)
{
    bool pairs = bench_take_word(&arguments, "--pair");
    struct gd_polygons triangles;
    if (!bench_arguments_end(arguments, true)) return BENCH_USAGE;
    if (pairs && !peer->pair) {
        fprintf(stderr, "%s: does not do pairs.\n", peer->name);
        return BENCH_USAGE;
    }
    if (!bench_read(*arguments++, &(struct bench_options){0}, &triangles)) return EXIT_FAILURE;
    struct course course = {.peer = peer, .vertices = triangles.position_count};
    course.surface = triangles.first ? NULL : peer->create(&triangles);
    gd_polygons_free(&triangles);
    if (!course.surface) {
        fprintf(stderr, "%s: the mesh is not taken; see gd_bench export.\n", peer->name);
        return EXIT_FAILURE;
    }
    course.distances = bench_allocate(sizeof *course.distances * course.vertices);
    int status = run_all(&course, pairs, arguments);
    free(course.distances);
    peer->release(course.surface);
    return status;
}
