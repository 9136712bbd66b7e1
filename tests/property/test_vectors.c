/* Tests log, exp, transport, traces, means and splines at points 1e-15 to 1e-9 edge lengths from
 * vertices and edges. No operation may fail, exp must invert log, and traces that start close to
 * each other must stay close to each other. GD_SCENES: points of each kind (300). */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "gd/mean.h"
#include "gd/query.h"
#include "gd/spline.h"
#include "gd/trace.h"
#include "tests/samples/samples.h"

enum { SCENES = 300, SMOOTH_EVERY = 8, SAMPLES = 16 };

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"terrain", {12, 0.4, 3}},  {"torus", {14, 9, 1, 0.4}},
                {"icosphere", {2, 1}},      {"grid", {6, 6, 1, 1}},
                {"box", {1, 1, 1, 3}},      {"cylinder", {1, 2, 8, 4}},
                {"saddle", {1, 0.5, 5, 3}}, {"graded", {1, 6, 5, 5, 0.4, 0.2, 2}}};

struct scene {
    const struct gd_polygons *polygons;
    const struct gd_mesh *mesh;
    struct rng *rng;
};

static double random_gap(struct rng *rng)
{
    return pow(10, rng_between(rng, -15, -9));
}

/* Returns a point in the slot's face or on one of its edges, at the distance `gap` from the slot's
 * vertex. A slot is an index into the array of corners. */
static struct gd_point beside_corner(const struct scene *scene, uint32_t slot, double gap)
{
    uint32_t k = slot % 3;
    double part = rng_below(scene->rng, 2) ? rng_unit(scene->rng) : 0;
    struct test_place place = {.face = slot / 3};
    place.weight[k] = 1 - gap;
    place.weight[(k + 1) % 3] = gap * (1 - part);
    place.weight[(k + 2) % 3] = gap * part;
    return test_point(scene->mesh, place);
}

static struct gd_point beside_edge(const struct scene *scene, uint32_t slot, double gap)
{
    uint32_t k = slot % 3;
    double part = rng_unit(scene->rng);
    struct test_place place = {.face = slot / 3};
    place.weight[k] = gap;
    place.weight[(k + 1) % 3] = (1 - gap) * (1 - part);
    place.weight[(k + 2) % 3] = (1 - gap) * part;
    return test_point(scene->mesh, place);
}

static struct gd_point random_point(const struct scene *scene)
{
    uint32_t slot = rng_below(scene->rng, 3 * scene->polygons->polygon_count);
    double gap = random_gap(scene->rng);
    switch (rng_below(scene->rng, 4)) {
    case 0:
        return test_point(scene->mesh, test_random_place(scene->polygons, scene->rng));
    case 1:
        return beside_edge(scene, slot, gap);
    default:
        return beside_corner(scene, slot, gap);
    }
}

/* Returns a point close to the slot's vertex, in any face of this vertex. */
static struct gd_point random_neighbour(const struct scene *scene, uint32_t slot)
{
    const struct gd_polygons *polygons = scene->polygons;
    uint32_t count = 3 * polygons->polygon_count, other = rng_below(scene->rng, count);
    while (polygons->corners[other] != polygons->corners[slot]) other = (other + 1) % count;
    return beside_corner(scene, other, random_gap(scene->rng));
}

static double distance_in_space(const struct gd_mesh *mesh, const struct gd_point *a,
                                const struct gd_point *b)
{
    return gd_vec3_distance(gd_point_position(mesh, a), gd_point_position(mesh, b));
}

static const struct gd_point *end_of(const struct gd_trace *trace)
{
    return &trace->path.points[trace->path.count - 1];
}

/* --- log and exp ------------------------------------------------------------------------------ */

/* Returns whether the trace passes no vertex and ends inside the surface. If a trace passes a
 * vertex, a rounding error of its start decides how it continues. */
static bool is_straight(const struct gd_trace *trace)
{
    for (uint32_t i = 1; i + 1 < trace->path.count; i++)
        if (trace->path.points[i].kind == GD_POINT_VERTEX) return false;
    return trace->end == GD_TRACE_END_LENGTH;
}

/* Checks exp of the log from one point to another. Returns the distance of the end from `to`.
 * `bound` is the largest permitted distance for a straight trace. */
static double check_log(const struct gd_mesh *mesh, const struct gd_point *from,
                        const struct gd_point *to, double bound)
{
    struct gd_pair_answer answer;
    struct gd_log log;
    struct gd_trace trace;
    check_ok(gd_pair_solve(
                 mesh, &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
                 NULL, &answer, NULL),
             NULL);
    check_ok(gd_vector_log(mesh, &answer.path, &log, NULL), NULL);
    check_ok(gd_vector_exp(mesh,
                           &(struct gd_exp_request){
                               .start = from, .segments = log.segments, .count = log.count},
                           NULL, &trace, NULL),
             NULL);
    double off = distance_in_space(mesh, end_of(&trace), to);
    assert_true(off <= (is_straight(&trace) ? bound : 1e-10));
    if (log.count) {
        struct gd_vector moved = log.segments[0];
        check_ok(gd_vector_transport(mesh, &answer.path, &moved, 1, NULL), NULL);
        assert_true(isfinite(moved.direction.angle));
    }
    gd_trace_free(&trace);
    gd_log_free(&log);
    gd_pair_answer_free(&answer);
    return off;
}

static double check_far_logs(const struct scene *scene)
{
    struct gd_point from = random_point(scene), to = random_point(scene);
    return check_log(scene->mesh, &from, &to, 1e-10);
}

/* Tests two points that are close to the same vertex. The error is the rounding of points in faces,
 * not a fraction of the edge length. */
static double check_near_logs(const struct scene *scene)
{
    uint32_t slot = rng_below(scene->rng, 3 * scene->polygons->polygon_count);
    struct gd_point from = random_neighbour(scene, slot), to = random_neighbour(scene, slot);
    return check_log(scene->mesh, &from, &to, 3e-14);
}

/* --- traces ----------------------------------------------------------------------------------- */

/* Returns whether no vertex lies between two traces that start in one face. Their first edges may
 * differ close to the first vertex. */
static bool are_parallel(const struct gd_trace *a, const struct gd_trace *b)
{
    if (a->end != GD_TRACE_END_LENGTH || b->end != GD_TRACE_END_LENGTH) return false;
    uint32_t count = a->path.count < b->path.count ? a->path.count : b->path.count;
    if (a->path.count > count + 1 || b->path.count > count + 1) return false;
    for (uint32_t i = 1; i + 2 < count; i++) {
        const struct gd_point *p = end_of(a) - i, *q = end_of(b) - i;
        if (p->kind != q->kind || p->element != q->element) return false;
    }
    return true;
}

static double check_traces(const struct scene *scene)
{
    uint32_t slot = rng_below(scene->rng, 3 * scene->polygons->polygon_count);
    double gap = random_gap(scene->rng), length = rng_between(scene->rng, 0.2, 1.2), off = 0;
    struct gd_point starts[2] = {beside_corner(scene, slot, gap), beside_corner(scene, slot, gap)},
                    towards = beside_edge(scene, slot, 0);
    struct gd_trace traces[2];
    for (int i = 0; i < 2; i++) {
        struct gd_direction direction;
        struct gd_vec3 ahead = gd_vec3_sub(gd_point_position(scene->mesh, &towards),
                                           gd_point_position(scene->mesh, &starts[0]));
        check_ok(gd_direction_along(scene->mesh, &starts[i], ahead, &direction, NULL), NULL);
        check_ok(gd_trace_follow(scene->mesh,
                                 &(struct gd_trace_request){
                                     .start = &starts[i], .ahead = &direction, .length = length},
                                 NULL, &traces[i], NULL),
                 NULL);
    }
    if (are_parallel(&traces[0], &traces[1]))
        off = distance_in_space(scene->mesh, end_of(&traces[0]), end_of(&traces[1])) -
              distance_in_space(scene->mesh, &starts[0], &starts[1]);
    assert_true(off <= 1e-13);
    gd_trace_free(&traces[0]);
    gd_trace_free(&traces[1]);
    return off;
}

/* --- means and splines ------------------------------------------------------------------------ */

static double check_smooth(const struct scene *scene)
{
    const struct gd_mesh *mesh = scene->mesh;
    struct gd_point points[3];
    struct gd_mean mean;
    struct gd_spline spline;
    struct gd_spline_line line;
    if (rng_below(scene->rng, SMOOTH_EVERY)) return 0;
    for (int i = 0; i < 3; i++) points[i] = random_point(scene);
    check_ok(gd_mean_find(mesh, &(struct gd_mean_request){.points = points, .count = 3}, NULL,
                          &mean, NULL),
             NULL);
    assert_true(isfinite(mean.spread));
    struct gd_spline_request request = {.points = points, .count = 3, .alpha = 0.5};
    enum gd_status status = gd_spline_build(mesh, &request, NULL, &spline, NULL);
    if (status == GD_INVALID_ARGUMENT) return 0; /* two points are equal */
    check_ok(status, NULL);
    struct gd_spline_sampling sampling = {.spline = &spline, .per_segment = SAMPLES};
    check_ok(gd_spline_sample(mesh, &sampling, NULL, &line, NULL), NULL);
    gd_spline_line_free(&line);
    gd_spline_free(&spline);
    return 0;
}

/* --- all surfaces ----------------------------------------------------------------------------- */

static void check_surfaces(double (*check)(const struct scene *scene))
{
    const char *asked = getenv("GD_SCENES");
    int scenes = asked ? atoi(asked) : SCENES;
    double worst = 0;
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        struct gd_mesh *mesh = test_sample(surfaces[s].name, surfaces[s].values, &polygons);
        struct rng rng = {s};
        struct scene scene = {&polygons, mesh, &rng};
        for (int i = 0; i < scenes; i++) worst = fmax(worst, check(&scene));
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# off by %.1e at most\n", worst);
}

static void exp_undoes_log(void **state)
{
    (void)state;
    check_surfaces(check_far_logs);
}

static void exp_undoes_log_around_a_vertex(void **state)
{
    (void)state;
    check_surfaces(check_near_logs);
}

static void traces_stay_together(void **state)
{
    (void)state;
    check_surfaces(check_traces);
}

static void means_and_splines(void **state)
{
    (void)state;
    check_surfaces(check_smooth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exp_undoes_log), cmocka_unit_test(exp_undoes_log_around_a_vertex),
        cmocka_unit_test(traces_stay_together), cmocka_unit_test(means_and_splines)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
