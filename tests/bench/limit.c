/* gd_bench limit: measures the main figures of S. Lai and F. Cheng, "Approximate geodesics on
 * smooth surfaces of arbitrary topology": a discretization with a million vertices, and 360
 * geodesics from one point, each as long as the bounding box's diagonal. For comparison, computes
 * the same bundle by the two methods that the paper calls expensive: exact shortest paths, and the
 * differential equation alone. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/discretization.h"
#include "gd/limit_mesh.h"
#include "gd/limit_path.h"
#include "gd/limit_place.h"
#include "gd/query.h"
#include "gd/trace.h"
#include "tests/bench/bench.h"

enum {
    FAN = 360,
    VERTICES = 1000000,
    QUICK_VERTICES = 20000,
    SEARCHES = 12,
    SEARCHES_MS = 3000,
    ROUNDS = 3
};

static const char cube[] =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 5 6 8 7\nf 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

/* A surface and the bundle of lines on it. */
struct bundle {
    const struct gd_subdivision *surface;
    struct gd_limit_mesh *fine;
    struct gd_limit_point start;
    struct gd_limit_jet jet;
    double length;
    struct gd_vec3 ends[FAN]; /* the ends of the lines that are traced on the mesh */
    struct gd_point end_points[FAN];
};

static struct gd_subdivision *read_surface(const char *bytes, size_t size, enum gd_scheme scheme)
{
    struct gd_control_mesh control_mesh;
    struct gd_subdivision *surface;
    struct gd_detail detail = {0};
    bench_require(gd_read_control_mesh(bytes, size, NULL, &control_mesh, &detail), &detail);
    bench_require(gd_subdivision_create(&control_mesh, scheme, NULL, &surface, &detail), &detail);
    gd_control_mesh_free(&control_mesh);
    return surface;
}

/* Returns the milliseconds of the fastest of several discretizations. Sets `*vertices` to the
 * number of vertices of each. */
static double discretize(const struct gd_subdivision *surface, uint32_t level, uint32_t *vertices)
{
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        struct gd_discretization made;
        double start = bench_thread_ms();
        bench_require(gd_discretize(surface, &(struct gd_discretize_options){.level = level},
                                    bench_control(), &made, NULL),
                      NULL);
        best = fmin(best, bench_thread_ms() - start);
        *vertices = made.polygons.position_count;
        gd_discretization_free(&made);
    }
    return best;
}

/* Returns the first level with at least this many vertices, and the time of its discretization. */
static uint32_t choose_level(const struct gd_subdivision *surface, uint32_t least,
                             uint32_t *vertices, double *time)
{
    uint32_t level = gd_limit_mesh_least_level(surface);
    do {
        *time = discretize(surface, level, vertices);
    } while (*vertices < least && level++ < GD_LIMIT_LEVEL_MOST);
    return level;
}

static struct gd_vec3 direction_of(const struct bundle *bundle, int i)
{
    return gd_limit_direction(&bundle->jet, 2 * M_PI * i / FAN);
}

/* Traces all lines of the bundle on the mesh. Returns the milliseconds. */
static double trace_mesh(struct bundle *bundle)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(bundle->fine);
    const struct gd_trace_options options = {.vertex_rule = GD_VERTEX_RULE_NORMAL,
                                             .normals = gd_limit_mesh_normals(bundle->fine)};
    double begun = bench_thread_ms();
    struct gd_point start;
    bench_require(gd_limit_mesh_point(bundle->fine, &bundle->start, &start, NULL), NULL);
    for (int i = 0; i < FAN; i++) {
        struct gd_direction ahead;
        struct gd_trace trace;
        bench_require(gd_direction_along(mesh, &start, direction_of(bundle, i), &ahead, NULL),
                      NULL);
        bench_require(gd_trace_follow(mesh,
                                      &(struct gd_trace_request){.start = &start,
                                                                 .ahead = &ahead,
                                                                 .length = bundle->length,
                                                                 .options = &options},
                                      NULL, &trace, NULL),
                      NULL);
        bundle->end_points[i] = trace.path.points[trace.path.count - 1];
        bundle->ends[i] = gd_point_position(mesh, &bundle->end_points[i]);
        gd_trace_free(&trace);
    }
    return bench_thread_ms() - begun;
}

/* Traces all lines of the bundle on the surface. Returns the milliseconds. Sets `*off` to the
 * median distance between the ends of these lines and the ends on the mesh. */
static double trace_smooth(const struct bundle *bundle, double *off)
{
    double gaps[FAN], begun = bench_thread_ms();
    for (int i = 0; i < FAN; i++) {
        struct gd_limit_path path;
        bench_require(gd_limit_trace(bundle->surface,
                                     &(struct gd_limit_trace_request){
                                         bundle->start, direction_of(bundle, i), bundle->length},
                                     NULL, &path, NULL),
                      NULL);
        gaps[i] = gd_vec3_distance(path.steps[path.step_count - 1].position, bundle->ends[i]);
        gd_limit_path_free(&path);
    }
    *off = bench_median(gaps, FAN);
    return bench_thread_ms() - begun;
}

/* Returns the milliseconds of exact shortest paths to the same ends, extrapolated from the paths
 * that are found within SEARCHES_MS. */
static double search_all(const struct bundle *bundle)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(bundle->fine);
    struct gd_point start;
    double begun = bench_thread_ms();
    bench_require(gd_limit_mesh_point(bundle->fine, &bundle->start, &start, NULL), NULL);
    int done = 0;
    for (; done < SEARCHES && bench_thread_ms() - begun < SEARCHES_MS; done++) {
        struct gd_pair_answer answer;
        bench_require(gd_pair_solve(mesh,
                                    &(struct gd_pair_request){
                                        .from = &start,
                                        .to = &bundle->end_points[done * (FAN / SEARCHES)],
                                        .output = GD_PAIR_PATH},
                                    bench_control(), &answer, NULL),
                      NULL);
        gd_pair_answer_free(&answer);
    }
    return (bench_thread_ms() - begun) * FAN / done;
}

static void measure(const char *name, const struct gd_subdivision *surface, bool quick)
{
    uint32_t vertices;
    double discretize_ms, off;
    uint32_t level =
        choose_level(surface, quick ? QUICK_VERTICES : VERTICES, &vertices, &discretize_ms);
    struct bundle bundle = {.surface = surface, .start = {.u = 0.3, .v = 0.3}};
    double begun = bench_thread_ms();
    struct gd_detail detail = {0};
    bench_require(gd_limit_mesh_build(surface, &(struct gd_limit_mesh_options){.level = level},
                                      bench_control(), &bundle.fine, &detail),
                  &detail);
    double build_ms = bench_thread_ms() - begun;
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(bundle.fine);
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    bundle.length = gd_vec3_distance(summary->min, summary->max);
    bench_require(gd_limit_evaluate(surface, &bundle.start, &bundle.jet, NULL), NULL);
    double trace_ms = INFINITY;
    for (int round = 0; round < ROUNDS; round++) trace_ms = fmin(trace_ms, trace_mesh(&bundle));
    double smooth_ms = trace_smooth(&bundle, &off), search_ms = search_all(&bundle);
    bench_print_mesh(name, mesh);
    printf("\"level\":%u,\"discretize_ms\":%.1f,\"build_ms\":%.1f,\"length\":%.6g,\"trace_%d_ms\":%"
           ".1f,"
           "\"smooth_%d_ms\":%.1f,\"shortest_%d_ms\":%.1f,\"median_end_off\":%.3g,",
           level, discretize_ms, build_ms, bundle.length, FAN, trace_ms, FAN, smooth_ms, FAN,
           search_ms, off);
    bench_print_end();
    gd_limit_mesh_free(bundle.fine);
}

static bool measure_file(const char *path, enum gd_scheme scheme, bool quick)
{
    struct bench_file file;
    if (!bench_map_file(path, &file)) return false;
    struct gd_subdivision *surface = read_surface(file.bytes, file.size, scheme);
    bench_unmap_file(&file);
    measure(path, surface, quick);
    gd_subdivision_release(surface);
    return true;
}

int bench_limit(char **arguments)
{
    bool quick = bench_take_word(&arguments, "--quick");
    enum gd_scheme scheme =
        bench_take_word(&arguments, "--loop") ? GD_SCHEME_LOOP : GD_SCHEME_CATMULL_CLARK;
    if (!bench_arguments_end(arguments, scheme == GD_SCHEME_LOOP)) return BENCH_USAGE;
    if (!*arguments) {
        struct gd_subdivision *surface = read_surface(cube, strlen(cube), scheme);
        measure("cube", surface, quick);
        gd_subdivision_release(surface);
    }
    for (; *arguments; arguments++)
        if (!measure_file(*arguments, scheme, quick)) return EXIT_FAILURE;
    return EXIT_SUCCESS;
}
