#include "tests/bench/peer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/control.h"
#include "tests/bench/bench.h"

/* A built surface and the buffers for answers. */
struct course {
    const struct peer *peer;
    void *surface;
    uint32_t vertices, faces;
    double line;       /* length of a traced line */
    double *distances; /* distances of all vertices */
};

/* A task that a program may support. */
struct question {
    const char *word; /* the option; NULL if the task has no option */
    uint32_t arguments;
    bool of_faces;
    bool (*answer)(const struct course *course, const uint32_t *arguments);
};

static void print_times(const char *key, uint64_t start_ns, double start_cpu_ms)
{
    double ms = bench_ms_since(start_ns), cpu_ms = bench_thread_ms() - start_cpu_ms;
    printf("{\"%s\":%.6f,\"cpu_ms\":%.6f,", key, ms, cpu_ms);
}

static bool run_field(const struct course *course, const uint32_t *source)
{
    double sum = 0, start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    if (!course->peer->field(course->surface, *source, course->distances)) return false;
    print_times("field_ms", start, start_cpu_ms);
    for (uint32_t i = 0; i < course->vertices; i++) sum += course->distances[i];
    printf("\"sum\":%.17g}\n", sum);
    return true;
}

static bool run_pair(const struct course *course, const uint32_t *ends)
{
    double distance, start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    if (!course->peer->pair(course->surface, ends[0], ends[1], &distance)) return false;
    print_times("pair_ms", start, start_cpu_ms);
    printf("\"distance\":%.17g}\n", distance);
    return true;
}

static bool run_trace(const struct course *course, const uint32_t *face)
{
    struct peer_lines lines = {0};
    double start_cpu_ms = bench_thread_ms();
    uint64_t start = gd_now_ns();
    if (!course->peer->trace(course->surface, *face, course->line, &lines)) return false;
    print_times("trace_ms", start, start_cpu_ms);
    printf("\"crossings\":%llu,\"ends\":%.17g}\n", (unsigned long long)lines.crossings, lines.ends);
    return true;
}

/* Reads the next argument as a vertex or a face. Returns false, after printing a sentence, if there
 * is no such element. */
static bool take_number(const struct course *course, bool of_face, char ***arguments, uint32_t *out)
{
    const char *text = **arguments ? *(*arguments)++ : "";
    char *end;
    unsigned long value = strtoul(text, &end, 10);
    uint32_t count = of_face ? course->faces : course->vertices;
    if (end == text || *end || value >= count) {
        fprintf(stderr, "%s: \"%s\" is no %s: they are numbered from 0 to %u.\n",
                course->peer->name, text, of_face ? "face" : "vertex", count - 1);
        return false;
    }
    *out = (uint32_t)value;
    return true;
}

static int run_all(const struct course *course, const struct question *question, char **arguments)
{
    while (*arguments) {
        uint32_t numbers[2];
        for (uint32_t i = 0; i < question->arguments; i++)
            if (!take_number(course, question->of_faces, &arguments, &numbers[i]))
                return BENCH_USAGE;
        if (!question->answer(course, numbers)) {
            fprintf(stderr, "%s: no answer from %s %u.\n", course->peer->name,
                    question->of_faces ? "face" : "vertex", numbers[0]);
            return EXIT_FAILURE;
        }
        fflush(stdout);
        if (course->peer->forget) course->peer->forget(course->surface);
    }
    return EXIT_SUCCESS;
}

static double mean_edge(const struct gd_polygons *triangles)
{
    double sum = 0;
    uint32_t sides = 3 * triangles->polygon_count;
    for (uint32_t i = 0; i < sides; i++) {
        const double *a = triangles->positions[triangles->corners[i]],
                     *b = triangles->positions[triangles->corners[i % 3 == 2 ? i - 2 : i + 1]];
        sum += sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                    (a[2] - b[2]) * (a[2] - b[2]));
    }
    return sum / sides;
}

static struct question take_question(const struct peer *peer, char ***arguments)
{
    static const struct question field = {NULL, 1, false, run_field};
    const struct question others[] = {{"--pair", 2, false, peer->pair ? run_pair : NULL},
                                      {"--trace", 1, true, peer->trace ? run_trace : NULL}};
    for (int i = 0; i < 2; i++)
        if (bench_take_word(arguments, others[i].word)) return others[i];
    return field;
}

int peer_run(const struct peer *peer, char **arguments)
{
    struct question question = take_question(peer, &arguments);
    struct gd_polygons triangles;
    if (!bench_arguments_end(arguments, true)) return BENCH_USAGE;
    if (!question.answer) {
        fprintf(stderr, "%s: does not do %s.\n", peer->name, question.word);
        return BENCH_USAGE;
    }
    if (!bench_read(*arguments++, &(struct bench_options){0}, &triangles)) return EXIT_FAILURE;
    struct course course = {.peer = peer,
                            .vertices = triangles.position_count,
                            .faces = triangles.polygon_count,
                            .line = PEER_LINE_EDGES * mean_edge(&triangles)};
    course.surface = triangles.first ? NULL : peer->create(&triangles);
    gd_polygons_free(&triangles);
    if (!course.surface) {
        fprintf(stderr, "%s: the mesh is not taken; see gd_bench export.\n", peer->name);
        return EXIT_FAILURE;
    }
    course.distances = bench_allocate(sizeof *course.distances * course.vertices);
    int status = run_all(&course, &question, arguments);
    free(course.distances);
    peer->release(course.surface);
    return status;
}
