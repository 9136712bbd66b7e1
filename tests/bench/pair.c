/* gd_bench pair: measures the time of the distance between two points, without cached data. */
#include <stdio.h>
#include <stdlib.h>

#include "gd/query.h"
#include "tests/bench/bench.h"

static double time_pair(const struct gd_mesh *mesh, const struct gd_landmarks *landmarks,
                        const struct gd_point *from, const struct gd_point *to)
{
    struct gd_pair_answer answer = {0};
    struct gd_detail detail = {0};
    uint64_t start = gd_now_ns();
    enum gd_status status = gd_pair_solve(
        mesh, &(struct gd_pair_request){.from = from, .to = to, .landmarks = landmarks},
        bench_control(), &answer, &detail);
    double ms = bench_ms_since(start);
    bench_require(status, &detail);
    gd_pair_answer_free(&answer);
    return ms;
}

/* Every run solves a new pair. The first run repeats the pair that the process has solved first. */
static void measure(const char *name, const struct gd_mesh *mesh,
                    const struct bench_options *options)
{
    uint32_t pairs = options->runs;
    double *ms = bench_allocate(sizeof *ms * pairs), first_ms = 0, landmarks_ms = 0;
    struct rng rng = {2};
    struct gd_landmarks *landmarks = NULL;
    if (options->landmarks) {
        uint64_t start = gd_now_ns();
        bench_require(gd_landmarks_build(mesh, options->landmarks, bench_control(), &landmarks),
                      NULL);
        landmarks_ms = bench_ms_since(start);
    }
    for (uint32_t i = 0; i < pairs; i++) {
        struct gd_point from = bench_random_point(mesh, GD_POINT_FACE, &rng),
                        to = bench_random_point(mesh, GD_POINT_FACE, &rng);
        if (i == 0) first_ms = time_pair(mesh, landmarks, &from, &to);
        ms[i] = time_pair(mesh, landmarks, &from, &to);
    }
    bench_print_mesh(name, mesh);
    printf("\"pairs\":%u,\"pair_ms_median\":%.3f,\"pair_ms_p95\":%.3f,\"first_ms\":%.3f,", pairs,
           bench_median(ms, pairs), bench_quantile(ms, pairs, 0.95), first_ms);
    printf("\"landmarks\":%u,\"landmarks_ms\":%.3f,", options->landmarks, landmarks_ms);
    bench_print_end();
    gd_landmarks_release(landmarks);
    free(ms);
}

int bench_pair(char **arguments)
{
    return bench_each_mesh(arguments, 50, measure);
}
