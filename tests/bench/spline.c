/* gd_bench spline: builds and samples splines through farthest points, at the sizes of Table 1 of
 * the paper "Geodesic Hermite splines on triangular meshes". */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/landmarks.h"
#include "gd/sampling.h"
#include "gd/spline.h"
#include "tests/bench/bench.h"

enum { RUNS = 9, LANDMARKS = 16, SAMPLES = 16 };

/* A mesh of as many vertices as the paper's, and the milliseconds that the paper publishes for the
 * construction of the spline, without sampling. */
static const struct row {
    const char *mesh;
    uint32_t points;
    double paper_ms;
} rows[] = {{"sample:icosphere,level=4", 4, 2},
            {"sample:terrain,cells=98", 13, 44},
            {"sample:torus,columns=94,rows=74", 12, 25},
            {"sample:ball,faces=4272", 9, 10},
            {"sample:torus,columns=485,rows=277", 15, 110}};

enum { ROWS = sizeof rows / sizeof *rows, POINTS_MOST = 15 };

/* --- two threads ------------------------------------------------------------------------------ */

struct task {
    void (*run)(void *context, uint32_t index);
    void *context;
};

static void *run_first(void *user)
{
    const struct task *task = user;
    task->run(task->context, 0);
    return NULL;
}

/* Runs the first task on its own thread, and the others on the calling thread. */
static void run_on_two(void *user, void (*run)(void *context, uint32_t index), void *context,
                       uint32_t count)
{
    pthread_t thread;
    (void)user;
    if (pthread_create(&thread, NULL, run_first, &(struct task){run, context})) abort();
    for (uint32_t i = 1; i < count; i++) run(context, i);
    pthread_join(thread, NULL);
}

/* --- measurements ----------------------------------------------------------------------------- */

/* Returns the milliseconds to build the spline. On one thread this is processor time. On two
 * threads it is the least elapsed time of all runs, since other programs may run at the same
 * time. */
static double build_time(const struct gd_mesh *mesh, const struct gd_spline_request *request)
{
    double times[RUNS];
    for (int i = 0; i < RUNS; i++) {
        struct gd_spline spline;
        uint64_t begin = gd_now_ns();
        double start = bench_thread_ms();
        bench_require(gd_spline_build(mesh, request, bench_control(), &spline, NULL), NULL);
        times[i] = request->executor ? bench_ms_since(begin) : bench_thread_ms() - start;
        gd_spline_free(&spline);
    }
    return bench_quantile(times, RUNS, request->executor ? 0 : 0.5);
}

/* Returns the milliseconds to sample the spline. */
static double sample_time(const struct gd_mesh *mesh, const struct gd_spline_request *request)
{
    double times[RUNS];
    struct gd_spline spline;
    bench_require(gd_spline_build(mesh, request, bench_control(), &spline, NULL), NULL);
    for (int i = 0; i < RUNS; i++) {
        struct gd_spline_line line;
        double start = bench_thread_ms();
        bench_require(gd_spline_sample(
                          mesh,
                          &(struct gd_spline_sampling){.spline = &spline, .per_segment = SAMPLES},
                          NULL, &line, NULL),
                      NULL);
        times[i] = bench_thread_ms() - start;
        gd_spline_line_free(&line);
    }
    gd_spline_free(&spline);
    return bench_median(times, RUNS);
}

/* Sorts points in the order of a curve through them. The next point is always the remaining point
 * that is nearest in space. */
static void sort_points(const struct gd_mesh *mesh, struct gd_point *points, uint32_t count)
{
    for (uint32_t i = 1; i < count; i++) {
        struct gd_vec3 last = gd_point_position(mesh, &points[i - 1]);
        uint32_t best = i;
        for (uint32_t k = i + 1; k < count; k++)
            if (gd_vec3_distance(last, gd_point_position(mesh, &points[k])) <
                gd_vec3_distance(last, gd_point_position(mesh, &points[best])))
                best = k;
        struct gd_point point = points[i];
        points[i] = points[best];
        points[best] = point;
    }
}

static void measure(const struct row *row, const struct gd_mesh *mesh)
{
    struct gd_point points[POINTS_MOST], start;
    double radii[POINTS_MOST];
    struct gd_landmarks *landmarks;
    bench_require(gd_point_at_vertex(mesh, (struct gd_vertex){0}, &start, NULL), NULL);
    bench_require(gd_sampling_farthest(mesh, &start, bench_control(),
                                       &(struct gd_sampling){row->points, points, radii}, NULL),
                  NULL);
    sort_points(mesh, points, row->points);
    bench_require(gd_landmarks_build(mesh, LANDMARKS, bench_control(), &landmarks), NULL);
    struct gd_spline_request request = {.points = points, .count = row->points, .alpha = 0.5};
    double build = build_time(mesh, &request);
    request.landmarks = landmarks;
    double guided = build_time(mesh, &request), sampling = sample_time(mesh, &request);
    request.executor = &(const struct gd_executor){.width = 2, .run = run_on_two};
    double together = build_time(mesh, &request);
    bench_print_mesh(row->mesh, mesh);
    printf("\"points\":%u,\"paper_ms\":%g,\"build_ms\":%.3f,\"build_with_landmarks_ms\":%.3f,"
           "\"build_on_2_threads_ms\":"
           "%.3f,"
           "\"sample_%d_ms\":%.3f,",
           row->points, row->paper_ms, build, guided, together, SAMPLES, sampling);
    printf("\"times_faster\":%.2f,\"times_faster_on_2_threads\":%.2f,\"times_faster_and_sampled\":%"
           ".2f,",
           row->paper_ms / guided, row->paper_ms / together, row->paper_ms / (together + sampling));
    bench_print_end();
    gd_landmarks_release(landmarks);
}

int bench_spline(char **arguments)
{
    struct bench_options options = {0};
    if (!bench_arguments_end(arguments, false)) return BENCH_USAGE;
    for (int i = 0; i < ROWS; i++) {
        struct gd_mesh *mesh = bench_open(rows[i].mesh, &options);
        if (!mesh) return EXIT_FAILURE;
        measure(&rows[i], mesh);
        gd_mesh_release(mesh);
    }
    return EXIT_SUCCESS;
}
