#include "gd/mean.h"

#include <stdlib.h>

#include "base/share.h"
#include "base/tolerance.h"
#include "gd/locate.h"
#include "gd/query.h"
#include "gd/vector.h"
#include "mesh/canonical.h"
#include "transport/ascent.h"

/* Minimises f, the weighted sum of squared distances to the points, by Newton's method with halved
 * steps. While the paths to the points cross the same faces, f is a sum of squared distances in the
 * plane (to the points, or via the first bends of the paths) with known second derivatives. A
 * minimum may be at a vertex, where f is not smooth. Therefore the corners of the current face are
 * tried when steps must be halved. */

enum { ITERATIONS = 100, HALVINGS = 8, SEARCHES = ITERATIONS / 4 };

/* An iterate, with f and its derivatives. Turns are those of line/turn.h. */
struct view {
    struct gd_point point;
    double value; /* f divided by the sum of the weights; normalised unit */
    /* rate of steepest descent of value / 2; negative if f grows in all directions */
    double slope;
    double heading; /* the turn of steepest descent */
    double length;  /* length of the next step */
    double turn;    /* turn of the next step */
    bool is_cut;    /* true if the shortest path to one of the points is not unique */
};

struct finder {
    const struct gd_mesh *mesh;
    const struct gd_mean_request *request;
    struct gd__share *share;
    const struct gd_control *control;
    struct gd_detail *detail;
    struct gd__pull *pulls; /* the pulls at the current iterate */
    double weights;         /* sum of the weights */
};

static double mean_weight_of(const struct finder *finder, uint32_t i)
{
    return finder->request->weights ? finder->request->weights[i] : 1;
}

/* --- evaluation ------------------------------------------------------------------------------- */

static enum gd_status pull_of(const struct finder *finder, const struct gd_point *from, uint32_t i,
                              struct gd__pull *pull, double *length, bool *is_cut)
{
    struct gd_pair_answer answer;
    struct gd_log log;
    enum gd_status status =
        gd_pair_solve(finder->mesh,
                      &(struct gd_pair_request){.from = from,
                                                .to = &finder->request->points[i],
                                                .output = GD_PAIR_PATH_AND_CUT,
                                                .landmarks = finder->request->landmarks},
                      finder->control, &answer, finder->detail);
    if (status) return status;
    status = gd_vector_log(finder->mesh, &answer.path, &log, finder->detail);
    gd_pair_answer_free(&answer);
    if (status) return status;
    double weight = mean_weight_of(finder, i);
    *is_cut |= answer.is_cut && weight > 0;
    *length = log.vector.length / finder->mesh->unit;
    *pull =
        (struct gd__pull){.turn = gd__turn_of_angle(finder->mesh, from, log.vector.direction.angle),
                          .strength = *length * weight,
                          .weight = weight,
                          .bend = log.count > 1 ? log.vector.length / log.segments[0].length : 1};
    gd_log_free(&log);
    return GD_OK;
}

static enum gd_status mean_evaluate(const struct finder *finder, const struct gd_point *point,
                                    struct view *out)
{
    double value = 0, length;
    bool is_cut = false;
    for (uint32_t i = 0; i < finder->request->count; i++) {
        enum gd_status status = pull_of(finder, point, i, &finder->pulls[i], &length, &is_cut);
        if (status) return status;
        value += finder->pulls[i].strength * length;
        if (finder->share->done + 1 < finder->share->total) finder->share->done++;
    }
    uint32_t count = finder->request->count;
    struct view view = {.point = *point, .value = value / finder->weights, .is_cut = is_cut};
    view.slope =
        gd__ascent(finder->mesh, point, finder->pulls, count, &view.heading) / finder->weights;
    view.length =
        gd__ascent_step(finder->mesh, point, finder->pulls, count, view.heading, &view.turn);
    *out = view;
    return GD_OK;
}

/* --- steps ------------------------------------------------------------------------------------ */

static enum gd_status mean_step(const struct finder *finder, const struct view *view, double turn,
                                double length, struct gd_point *out)
{
    const struct gd_direction ahead = gd__turn_direction(finder->mesh, &view->point, turn);
    struct gd_trace trace;
    enum gd_status status = gd_trace_follow(
        finder->mesh,
        &(struct gd_trace_request){
            .start = &view->point, .ahead = &ahead, .length = length * finder->mesh->unit},
        finder->control, &trace, finder->detail);
    if (status) return status;
    *out = trace.path.points[trace.path.count - 1];
    gd_trace_free(&trace);
    return GD_OK;
}

/* Returns true if `a` is better than `b`. Near a minimum, f is constant up to rounding; the slopes
 * are compared then. */
static bool mean_is_better(const struct view *a, const struct view *b)
{
    double noise = GD_TOL_HIT * b->value;
    return a->value < b->value - noise ||
           (a->value < b->value + noise && a->slope < 0.5 * b->slope);
}

static enum gd_status try_point(const struct finder *finder, const struct gd_point *point,
                                struct view *view, bool *has_moved)
{
    struct view next;
    enum gd_status status = mean_evaluate(finder, point, &next);
    if (status || !mean_is_better(&next, view)) return status;
    next.is_cut |= view->is_cut;
    *view = next;
    *has_moved = true;
    return GD_OK;
}

/* Moves to a corner of the point's face, or to an end of its edge, if f is smaller there. */
static enum gd_status try_corners(const struct finder *finder, struct view *view, bool *has_moved)
{
    const struct gd_mesh *mesh = finder->mesh;
    struct gd_point from = view->point;
    enum gd_status status = GD_OK;
    uint32_t corners = from.kind == GD_POINT_FACE ? 3 : from.kind == GD_POINT_EDGE ? 2 : 0;
    for (uint32_t k = 0; k < corners && !status; k++) {
        uint32_t side =
            from.kind == GD_POINT_FACE ? mesh->face_side[from.element][k] : 2 * from.element + k;
        struct gd_point corner = gd__point_of_vertex(mesh->origin[side]);
        status = try_point(finder, &corner, view, has_moved);
    }
    return status;
}

/* Moves to a position with a smaller f, if one is found. */
static enum gd_status mean_improve(const struct finder *finder, struct view *view, bool *has_moved)
{
    double part = 1;
    enum gd_status status = GD_OK;
    *has_moved = false;
    for (int i = 0; i < HALVINGS && !status && !*has_moved; i++, part /= 2) {
        struct gd_point point;
        status = mean_step(finder, view, view->turn, part * view->length, &point);
        if (!status) status = try_point(finder, &point, view, has_moved);
        if (!status && !*has_moved && i == 0) status = try_corners(finder, view, has_moved);
    }
    return status;
}

static bool is_there(const struct view *view)
{
    return view->slope <= GD_TOL_MEAN * sqrt(view->value);
}

static enum gd_status mean_descend(const struct finder *finder, struct view *view,
                                   uint32_t *iterations)
{
    bool has_moved = true;
    enum gd_status status = GD_OK;
    while (!status && has_moved && !is_there(view) && *iterations < ITERATIONS) {
        status = mean_improve(finder, view, &has_moved);
        ++*iterations;
    }
    return status;
}

/* --- start ------------------------------------------------------------------------------------ */

static struct gd_vec3 centroid(const struct finder *finder)
{
    struct gd_vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < finder->request->count; i++)
        sum = gd_vec3_along(sum, mean_weight_of(finder, i) / finder->weights,
                            gd_point_position(finder->mesh, &finder->request->points[i]));
    return sum;
}

static struct gd_point nearest_given(const struct finder *finder, struct gd_vec3 place)
{
    const struct gd_point *points = finder->request->points;
    uint32_t best = 0;
    double least = INFINITY;
    for (uint32_t i = 0; i < finder->request->count; i++) {
        double distance = gd_vec3_distance(gd_point_position(finder->mesh, &points[i]), place);
        if (distance >= least) continue;
        least = distance;
        best = i;
    }
    return points[best];
}

/* Evaluates f at two positions near the points' mean in space, and returns the better one as the
 * start. */
static enum gd_status mean_begin(const struct finder *finder, struct view *out)
{
    struct gd_vec3 middle = centroid(finder);
    struct gd_point start = nearest_given(finder, middle), other;
    bool has_moved;
    enum gd_status status = mean_evaluate(finder, &start, out);
    if (status || gd_locate_nearest(finder->mesh, middle, -1, &other, NULL)) return status;
    if (gd_point_component(finder->mesh, &other) != gd_point_component(finder->mesh, &start))
        return GD_OK;
    return try_point(finder, &other, out, &has_moved);
}

/* --- public call ------------------------------------------------------------------------------ */

static enum gd_status mean_check(const struct gd_mesh *mesh, const struct gd_mean_request *request,
                                 double *sum, struct gd_detail *detail)
{
    if (!request->count)
        return gd_fail(detail, GD_INVALID_ARGUMENT, "a mean is of at least one point");
    *sum = 0;
    for (uint32_t i = 0; i < request->count; i++) {
        double weight = request->weights ? request->weights[i] : 1;
        if (!(isfinite(weight) && weight >= 0))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "weight %u is %.17g; it must be a finite number, 0 or more", i, weight);
        if (gd_point_component(mesh, &request->points[i]) !=
            gd_point_component(mesh, &request->points[0]))
            return gd_fail(
                detail, GD_NOT_ON_SURFACE,
                "point %u lies on another component than point 0: there is no path between them",
                i);
        *sum += weight;
    }
    if (*sum > 0 && isfinite(*sum)) return GD_OK;
    return gd_fail(detail, GD_INVALID_ARGUMENT, "the weights sum to %.17g; one must be more than 0",
                   *sum);
}

static enum gd_status find_in_one_step(const struct finder *finder, struct view *view)
{
    struct gd_point point;
    enum gd_status status = mean_evaluate(finder, &finder->request->points[0], view);
    bool is_cut = view->is_cut;
    if (!status) status = mean_step(finder, view, view->heading, fmax(view->slope, 0), &point);
    if (!status) status = mean_evaluate(finder, &point, view);
    view->is_cut |= is_cut;
    return status;
}

static enum gd_status mean_find(struct finder *finder, struct gd_mean *out)
{
    struct view view = {0};
    uint32_t iterations = 1;
    enum gd_status status = GD_OK;
    if (finder->request->one_step) {
        status = find_in_one_step(finder, &view);
    } else {
        iterations = 0;
        status = mean_begin(finder, &view);
        if (!status) status = mean_descend(finder, &view, &iterations);
    }
    if (status) return status;
    *out = (struct gd_mean){.point = view.point,
                            .residual = fmax(view.slope, 0) * finder->mesh->unit,
                            .spread = sqrt(view.value) * finder->mesh->unit,
                            .iterations = iterations,
                            .converged = is_there(&view),
                            .is_cut = view.is_cut};
    return GD_OK;
}

enum gd_status gd_mean_find(const struct gd_mesh *mesh, const struct gd_mean_request *request,
                            const struct gd_control *control, struct gd_mean *out,
                            struct gd_detail *detail)
{
    struct finder finder = {.mesh = mesh, .request = request, .detail = detail};
    enum gd_status status = mean_check(mesh, request, &finder.weights, detail);
    size_t held = request->count * sizeof *finder.pulls;
    if (!status) status = gd_control_afford(control, held);
    if (status) return status;
    struct gd__share share = {.control = control, .total = SEARCHES * request->count};
    struct gd_control own = gd__share_control(&share, held);
    finder.share = &share;
    finder.control = &own;
    finder.pulls = malloc(held);
    status = finder.pulls ? mean_find(&finder, out) : GD_NO_MEMORY;
    free(finder.pulls);
    return status;
}
