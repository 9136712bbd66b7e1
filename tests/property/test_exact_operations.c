/* Tests points close to vertices and edges as targets, as ends of curves, as members of sets, and
 * as starts of traces, vectors and splines. */
#include <math.h>
#include <stdlib.h>

#include "gd/curve.h"
#include "gd/query.h"
#include "gd/spline.h"
#include "gd/vector.h"
#include "tests/support/exact_run.h"

enum { UNITS = 6, TARGETS = 8, POINTS_MOST = 4, SAMPLES = 32, STEPS = 60 };

/* Allowed error of distances very close to a curve, relative to the edge length
 * (engine/doc/002). */
static const double BESIDE_CURVE = 1e-10;

static struct gd_point beside_something(struct exact_scene *scene)
{
    if (rng_below(&scene->rng, 2)) return exact_beside_edge(scene, -15, -6);
    return exact_beside_vertex(scene, exact_random_vertex(scene), -15, -6);
}

static struct gd_point any_point(struct exact_scene *scene)
{
    return rng_below(&scene->rng, 2) ? exact_random(scene) : beside_something(scene);
}

static struct gd_field *build_field(struct exact_unit *unit)
{
    struct gd_field *field = NULL;
    struct gd_field_request request = {.seeds = unit->seeds, .seed_count = unit->seed_count};
    enum gd_status status = gd_field_build(unit->scene->mesh, &request, NULL, &field, NULL);
    if (status) exact_failure(unit, "gd_field_build", status, &unit->seeds[0].point);
    return field;
}

/* --- targets, and members of sets ------------------------------------------------------------- */

static void check_target(struct exact_unit *unit, struct exact_truth *truth,
                         const struct gd_field *field, struct gd_point to)
{
    double distance = NAN;
    uint32_t seed = 0;
    struct gd_path path = {0};
    struct gd_vec3 gradient;
    enum gd_status status = gd_field_distance(field, &to, &distance);
    if (status) exact_failure(unit, "gd_field_distance", status, &to);
    exact_answer(unit, truth, &to, distance);
    status = gd_field_nearest(field, &to, &distance, &seed);
    if (status) exact_failure(unit, "gd_field_nearest", status, &to);
    status = gd_field_path_to_seed(field, &to, &path, &seed);
    if (status)
        exact_failure(unit, "gd_field_path_to_seed", status, &to);
    else
        exact_answer(unit, truth, &to, path.length + unit->seeds[seed].offset);
    gd_path_free(&path);
    bool is_seed = false;
    for (uint32_t i = 0; i < unit->seed_count; i++)
        is_seed |= gd_point_equal(&to, &unit->seeds[i].point);
    status = is_seed ? GD_OK : gd_field_gradient(field, &to, &gradient);
    if (status) exact_failure(unit, "gd_field_gradient", status, &to);
}

static void targets_of(struct exact_scene *scene, const struct gd_seed *seeds, uint32_t count,
                       struct exact_tally *tally)
{
    struct exact_unit unit = {.scene = scene, .seeds = seeds, .seed_count = count};
    struct exact_truth truth;
    exact_truth_open(scene, seeds, count, INFINITY, &truth);
    struct gd_field *field = build_field(&unit);
    for (int k = 0; field && k < TARGETS; k++)
        check_target(&unit, &truth, field, beside_something(scene));
    gd_field_release(field);
    exact_truth_close(&truth);
    exact_conclude(&unit, tally);
}

static void targets(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < UNITS; i++)
        targets_of(&scene, &(struct gd_seed){.point = exact_random(&scene)}, 1, tally);
    exact_scene_close(&scene);
}

static void members(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < UNITS; i++) {
        struct gd_seed seeds[POINTS_MOST] = {0};
        uint32_t count = 1 + rng_below(&scene.rng, POINTS_MOST);
        for (uint32_t k = 0; k < count; k++) {
            seeds[k].point = any_point(&scene);
            if (rng_below(&scene.rng, 3) == 0)
                seeds[k].offset = scene.size * 0.3 * rng_unit(&scene.rng);
        }
        targets_of(&scene, seeds, count, tally);
    }
    exact_scene_close(&scene);
}

/* --- curves ----------------------------------------------------------------------------------- */

/* Returns the point at t of a segment whose ends are given by weights in one face. */
static struct naive_point between(const struct naive_point *a, const struct naive_point *b,
                                  double t)
{
    struct naive_point out = {.face = a->face};
    for (int k = 0; k < 3; k++) out.weight[k] = (1 - t) * a->weight[k] + t * b->weight[k];
    return out;
}

/* Returns the smallest distance of a segment from the source. Takes samples, and then runs a
 * golden-section search around the best sample. */
static long double to_segment(const struct exact_truth *truth, const struct naive_point *a,
                              const struct naive_point *b)
{
    long double least = INFINITY;
    int best = 0;
    for (int i = 0; i <= SAMPLES; i++) {
        struct naive_point at = between(a, b, (double)i / SAMPLES);
        long double distance = naive_field_distance(truth->field, &at);
        if (distance < least) least = distance, best = i;
    }
    double low = fmax(best - 1, 0) / SAMPLES, high = fmin(best + 1, SAMPLES) / SAMPLES,
           golden = 0.6180339887498949;
    for (int i = 0; i < STEPS; i++) {
        double left = high - golden * (high - low), right = low + golden * (high - low);
        struct naive_point p = between(a, b, left), q = between(a, b, right);
        long double dp = naive_field_distance(truth->field, &p),
                    dq = naive_field_distance(truth->field, &q);
        least = fminl(least, fminl(dp, dq));
        if (dp < dq)
            high = right;
        else
            low = left;
    }
    return least;
}

/* Converts a point to weights in a face. Returns false if the face does not contain it. */
static bool in_face(const struct exact_scene *scene, const struct gd_point *point, uint32_t face,
                    struct naive_point *out)
{
    struct naive_point own = exact_point(scene, point);
    const uint32_t *from = &scene->polygons.corners[3 * own.face],
                   *to = &scene->polygons.corners[3 * face];
    *out = (struct naive_point){.face = face};
    for (int i = 0; i < 3; i++) {
        bool found = own.weight[i] == 0;
        for (int k = 0; k < 3; k++) {
            if (from[i] != to[k]) continue;
            out->weight[k] = own.weight[i];
            found = true;
        }
        if (!found) return false;
    }
    return true;
}

static long double to_curve(const struct exact_truth *truth, const struct gd_curve *curve)
{
    long double least = INFINITY;
    uint32_t segments = curve->closed ? curve->count : curve->count - 1;
    for (uint32_t i = 0; i < segments; i++) {
        const struct gd_point *a = &curve->points[i], *b = &curve->points[(i + 1) % curve->count];
        struct naive_point p, q;
        for (uint32_t face = 0; face < truth->scene->polygons.polygon_count; face++) {
            if (!in_face(truth->scene, a, face, &p) || !in_face(truth->scene, b, face, &q))
                continue;
            least = fminl(least, to_segment(truth, &p, &q));
            break;
        }
    }
    return least;
}

static void check_curve_at(struct exact_unit *unit, const struct gd_curve *curve,
                           const struct gd_field *field, struct gd_point to)
{
    double distance = NAN;
    enum gd_status status = gd_field_distance(field, &to, &distance);
    if (status) exact_failure(unit, "gd_field_distance", status, &to);
    struct exact_truth truth;
    exact_truth_open(unit->scene, &(struct gd_seed){.point = to}, 1, INFINITY, &truth);
    double expected = (double)to_curve(&truth, curve);
    double allowed = EXACT_PROMISE * expected + BESIDE_CURVE * unit->scene->mean_edge;
    exact_law(unit, &to, distance, expected, fabs(distance - expected) / allowed);
    exact_truth_close(&truth);
}

static void check_curve(struct exact_unit *unit, struct exact_scene *scene,
                        const struct gd_curve *curve)
{
    uint32_t count = gd_curve_seed_count(curve);
    struct gd_field *field = NULL;
    struct gd_seed *seeds = calloc(count, sizeof *seeds);
    if (!seeds) abort();
    gd_curve_seeds(curve, 0, seeds);
    struct gd_field_request request = {.seeds = seeds, .seed_count = count};
    enum gd_status status = gd_field_build(scene->mesh, &request, NULL, &field, NULL);
    if (status) exact_failure(unit, "gd_field_build, curve", status, &unit->seeds[0].point);
    for (int k = 0; field && k < TARGETS; k++) {
        struct gd_path path = {0};
        struct gd_point to = any_point(scene);
        check_curve_at(unit, curve, field, to);
        status = gd_field_path(field, &to, &path);
        if (status) exact_failure(unit, "gd_field_path, curve", status, &to);
        gd_path_free(&path);
    }
    gd_field_release(field);
    free(seeds);
}

static void curves(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < UNITS; i++) {
        struct gd_point points[POINTS_MOST];
        struct gd_seed seeds[POINTS_MOST] = {0};
        uint32_t count = 2 + rng_below(&scene.rng, POINTS_MOST - 1);
        for (uint32_t k = 0; k < count; k++)
            points[k] = seeds[k].point = k == 0 ? beside_something(&scene) : any_point(&scene);
        struct exact_unit unit = {.scene = &scene, .seeds = seeds, .seed_count = count};
        struct gd_curve_request request = {
            .kind = GD_CURVE_POINTS, .points = points, .count = count};
        struct gd_curve curve;
        enum gd_status status = gd_curve_resolve(scene.mesh, &request, NULL, &curve, NULL);
        if (status)
            exact_failure(&unit, "gd_curve_resolve", status, &points[0]);
        else
            check_curve(&unit, &scene, &curve);
        if (!status) gd_curve_free(&curve);
        exact_conclude(&unit, tally);
    }
    exact_scene_close(&scene);
}

/* --- traces ----------------------------------------------------------------------------------- */

/* Checks that a line has the requested length unless it meets the boundary. The distance between
 * the line's ends must be at most the line's length. */
static void check_trace(struct exact_unit *unit, struct exact_truth *truth,
                        const struct gd_trace *trace, double length)
{
    const struct gd_point *end = &trace->path.points[trace->path.count - 1];
    if (trace->end == GD_TRACE_END_LENGTH)
        exact_law(unit, end, trace->path.length, length,
                  exact_relative(trace->path.length, length) / EXACT_PROMISE);
    else if (trace->end != GD_TRACE_END_BOUNDARY)
        exact_failure(unit, "gd_trace_follow, end", GD_INTERNAL, end);
    double distance = exact_distance(truth, end);
    if (distance > trace->path.length * (1 + EXACT_PROMISE) + 1e-15 * unit->scene->size)
        exact_law(unit, end, trace->path.length, distance,
                  exact_relative(trace->path.length, distance) / EXACT_PROMISE);
}

static void traces(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < UNITS; i++) {
        struct gd_seed seed = {.point = beside_something(&scene)};
        struct exact_unit unit = {.scene = &scene, .seeds = &seed, .seed_count = 1};
        struct exact_truth truth;
        exact_truth_open(&scene, &seed, 1, INFINITY, &truth);
        for (int k = 0; k < TARGETS; k++) {
            struct gd_trace trace;
            double length = scene.size * pow(10, rng_between(&scene.rng, -4, 0));
            struct gd_direction ahead = gd_trace_fan(scene.mesh, &seed.point, TARGETS, (uint32_t)k);
            enum gd_status status = gd_trace_follow(
                scene.mesh,
                &(struct gd_trace_request){.start = &seed.point, .ahead = &ahead, .length = length},
                NULL, &trace, NULL);
            if (status)
                exact_failure(&unit, "gd_trace_follow", status, &seed.point);
            else
                check_trace(&unit, &truth, &trace, length);
            if (!status) gd_trace_free(&trace);
        }
        exact_truth_close(&truth);
        exact_conclude(&unit, tally);
    }
    exact_scene_close(&scene);
}

/* --- log, exp and transport ------------------------------------------------------------------- */

/* Checks that exp of the log ends where the path ends. In graded patches, checks only that exp
 * succeeds. There, lines pass the apex at distances of 1e-20. A direction in double precision does
 * not determine the side on which such a line passes. */
static void check_exp(struct exact_unit *unit, const struct gd_log *log,
                      const struct gd_point *from, const struct gd_point *to)
{
    const struct gd_mesh *mesh = unit->scene->mesh;
    struct gd_trace trace;
    enum gd_status status = gd_vector_exp(
        mesh,
        &(struct gd_exp_request){.start = from, .segments = log->segments, .count = log->count},
        NULL, &trace, NULL);
    if (status) {
        exact_failure(unit, "gd_vector_exp", status, to);
        return;
    }
    struct gd_vec3 end = gd_point_position(mesh, &trace.path.points[trace.path.count - 1]);
    double off = gd_vec3_distance(end, gd_point_position(mesh, to)), length = log->vector.length;
    if (unit->scene->kind != EXACT_GRADED)
        exact_law(unit, to, length + off, length,
                  off / (EXACT_PROMISE * length + 1e-14 * unit->scene->size));
    gd_trace_free(&trace);
}

static void check_log(struct exact_unit *unit, const struct gd_path *path, double distance,
                      const struct gd_point *to)
{
    const struct gd_mesh *mesh = unit->scene->mesh;
    struct gd_log log;
    enum gd_status status = gd_vector_log(mesh, path, &log, NULL);
    if (status) {
        exact_failure(unit, "gd_vector_log", status, to);
        return;
    }
    exact_law(unit, to, log.vector.length, distance,
              exact_relative(log.vector.length, distance) / EXACT_PROMISE);
    check_exp(unit, &log, &unit->seeds[0].point, to);
    struct gd_vector moved = log.vector;
    status = gd_vector_transport(mesh, path, &moved, 1, NULL);
    if (status) exact_failure(unit, "gd_vector_transport", status, to);
    gd_log_free(&log);
}

static void vectors(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < UNITS; i++) {
        struct gd_seed seed = {.point = any_point(&scene)};
        struct exact_unit unit = {.scene = &scene, .seeds = &seed, .seed_count = 1};
        for (int k = 0; k < TARGETS; k++) {
            struct gd_pair_answer answer = {0};
            struct gd_point to = k % 2 ? beside_something(&scene) : any_point(&scene);
            enum gd_status status =
                gd_pair_solve(scene.mesh,
                              &(struct gd_pair_request){
                                  .from = &seed.point, .to = &to, .output = GD_PAIR_PATH_AND_CUT},
                              NULL, &answer, NULL);
            if (status)
                exact_failure(&unit, "gd_pair_solve", status, &to);
            else if (!gd_point_equal(&seed.point, &to))
                check_log(&unit, &answer.path, answer.distance, &to);
            gd_pair_answer_free(&answer);
        }
        exact_conclude(&unit, tally);
    }
    exact_scene_close(&scene);
}

/* --- splines ---------------------------------------------------------------------------------- */

/* Checks that the spline passes through its points. */
static void check_spline(struct exact_unit *unit, const struct gd_spline *spline,
                         const struct gd_point *points)
{
    struct gd_spline_line line;
    enum gd_status status = gd_spline_sample(
        unit->scene->mesh, &(struct gd_spline_sampling){.spline = spline, .per_segment = 4}, NULL,
        &line, NULL);
    if (status) {
        exact_failure(unit, "gd_spline_sample", status, &points[0]);
        return;
    }
    for (uint32_t i = 0; i <= spline->count; i++) {
        const struct gd_point *knot = i < spline->count
                                          ? &spline->segments[i].control[0]
                                          : &spline->segments[spline->count - 1].control[3];
        if (!gd_point_equal(knot, &points[i]))
            exact_failure(unit, "gd_spline_build, knot", GD_INTERNAL, &points[i]);
    }
    gd_spline_line_free(&line);
}

/* Returns whether no two consecutive points count as equal. The engine treats consecutive points as
 * equal if their distance is less than 1e-12 times the distance of their neighbours. */
static bool are_apart(const struct exact_scene *scene, const struct gd_point *points,
                      uint32_t count)
{
    double least = INFINITY;
    for (uint32_t i = 1; i < count; i++)
        least = fmin(least, gd_vec3_distance(gd_point_position(scene->mesh, &points[i]),
                                             gd_point_position(scene->mesh, &points[i - 1])));
    return least > 1e-9 * scene->size;
}

static void splines(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < UNITS; i++) {
        struct gd_point points[POINTS_MOST];
        struct gd_seed seeds[POINTS_MOST] = {0};
        uint32_t count = 3 + rng_below(&scene.rng, POINTS_MOST - 2);
        for (uint32_t k = 0; k < count; k++)
            points[k] = seeds[k].point = k % 2 ? exact_random(&scene) : beside_something(&scene);
        if (!are_apart(&scene, points, count)) continue;
        struct exact_unit unit = {.scene = &scene, .seeds = seeds, .seed_count = count};
        struct gd_spline_request request = {.points = points, .count = count, .alpha = 0.5};
        struct gd_spline spline;
        enum gd_status status = gd_spline_build(scene.mesh, &request, NULL, &spline, NULL);
        if (status)
            exact_failure(&unit, "gd_spline_build", status, &points[0]);
        else
            check_spline(&unit, &spline, points);
        if (!status) gd_spline_free(&spline);
        exact_conclude(&unit, tally);
    }
    exact_scene_close(&scene);
}

static const struct exact_section sections[] = {
    {"targets", "distances, paths and gradients at points beside vertices and edges", targets, 300,
     20000, EXACT_HOLDS},
    {"members", "sets with members beside vertices and edges", members, 300, 20000, EXACT_HOLDS},
    {"curves", "curves with ends and corners beside vertices and edges", curves, 60, 3000,
     EXACT_HOLDS},
    {"traces", "traces that start beside vertices and edges", traces, 300, 20000, EXACT_HOLDS},
    {"vectors", "log, exp and transport from and to points beside vertices and edges", vectors, 300,
     20000, EXACT_HOLDS},
    {"splines", "splines through points beside vertices and edges", splines, 120, 5000,
     EXACT_HOLDS},
};

int main(int argc, char **argv)
{
    return exact_main(argc, argv, sections, sizeof sections / sizeof *sections);
}
