#include "nurbs/solve.h"

#include <math.h>
#include <stdlib.h>

#include "base/arena.h"
#include "base/tolerance.h"
#include "nurbs/energy.h"

enum {
    COARSE_SPANS = 14, /* number of spans of a coarse curve, for each turn around the surface */
    FIRST_SPANS = 10,  /* the same for the first curve that is divided into pieces */
    CUT_MOST = 12,     /* largest number of fits of the curve to the cells */
    /* largest number of fits of a curve that is stuck in a corner of four cells */
    CORNERS_MOST = 4,
    /* largest number of moves of an end from one interval of its curve to another */
    SLIDES_MOST = 256,
    STEPS_MOST = 1200, /* largest total number of Newton steps */
    PATIENCE = 12,     /* number of refinements after which a bent curve is abandoned */
    ASTRAY_MOST = 3,   /* the same for a curve that strays from the surface */
    REFINE_MOST = 48,
    SPANS_MOST = 4096
};

static const struct gd__newton_limits exact = {60, GD_TOL_STATIONARY};
/* Limits for a coarse curve. It crosses lines, where the Hessian is not continuous, so more steps
 * do not help. */
static const struct gd__newton_limits coarse = {12, 1e-7};

/* If Newton's method does not converge, and a piece is shorter than this fraction of the path's
 * length, the curve is stuck in a corner of four cells. */
static const double stuck = 1e-4;
/* A stuck curve that passes the other side of a corner is this far from it, as a fraction of a
 * cell's width. */
static const double aside = 1e-2;
/* Smallest width of the spans at the ends, as a fraction of a piece. Narrower spans would have a
 * wrong curvature because of rounding. */
static const double shortest_end = 1e-4;
/* Largest value of the integral of squared geodesic curvature, times the length. For a path with a
 * kink, this product is infinite. */
static const double most_bend = 100;
/* A control point counts as in a pole if it is nearer to the pole than this fraction of the
 * domain's width. */
static const double fallen = 1e-6;
/* A curve that strays from the surface by more than this fraction of its length is replaced by the
 * coarse curve. */
static const double astray = 1e-3;
/* Rounding error of a span's length, as a multiple of the rounding error at the chain's ends. */
static const double noise = 8;
/* A span is halved only if its error is more than this fraction of the greatest error. */
static const double worth = 0.02;

/* Returns the number of turns around the surface between two places, rounded up, but at least 1. */
static uint32_t turns_between(const struct gd_parametric *surface, const double a[2],
                              const double b[2])
{
    double most = 1;
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(surface->axis[k]);
        if (period > 0) most = fmax(most, fabs(b[k] - a[k]) / period);
    }
    return (uint32_t)fmin(ceil(most - GD_TOL_ADJACENT), SPANS_MOST / COARSE_SPANS);
}

static enum gd_status newton(struct gd__newton_limits limits, struct gd__solution *solution)
{
    enum gd_status status = gd__newton(solution->chain, &limits, &solution->report);
    if (!status) solution->iterations += solution->report.iterations;
    return status;
}

/* Returns the direction whose border contains all control points of a span, or -1. */
static int border_of(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span)
{
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = chain->surface->axis[k];
        double first = piece->points[span][k];
        if (axis->closed || (first > axis->low && first < axis->high)) continue;
        uint32_t i = 1;
        while (i <= chain->degree && piece->points[span + i][k] == first) i++;
        if (i > chain->degree) return k;
    }
    return -1;
}

/* Returns true if the border of direction k does not bend into the domain along a span. Where it
 * does, a path beside the border is shorter. */
static bool is_pressing(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                        int k)
{
    bool is_low = piece->points[span][k] <= chain->surface->axis[k]->low;
    for (int g = 0; g < gd__chain_gauss(chain); g++) {
        struct gd__curve_jet c;
        struct gd_jet x;
        gd__piece_node(chain, piece, span, g, &c);
        gd__piece_jet(chain, piece, c.at, &x);
        struct gd_vec3 d = gd__velocity(&x, c.first), normal = gd_vec3_cross(x.u, x.v),
                       inward = gd_vec3_scale(k ? x.v : x.u, is_low ? 1 : -1);
        double bend = gd_vec3_dot(gd_vec3_cross(d, gd__acceleration(&x, &c)), normal);
        if (bend * gd_vec3_dot(gd_vec3_cross(d, inward), normal) > 0) return false;
    }
    return true;
}

/* Returns true if the path follows the border along a span and the spans beside it. The curvature
 * of such a span is not an error. Where a path leaves the border, it may leave within a span that
 * lies on the border, so the curvature of the last span on the border counts. */
static bool follows_border(const struct gd__chain *chain, const struct gd__piece *piece,
                           uint32_t span)
{
    const struct gd__piece *before = piece, *after = piece, *first = chain->pieces,
                           *last = chain->pieces + chain->piece_count - 1;
    bool is_first = span == 0, is_last = span + 1 == piece->spans;
    int border = border_of(chain, piece, span);
    if (border < 0 || !is_pressing(chain, piece, span, border)) return false;
    if (is_first && piece > first) before = piece - 1;
    if (is_last && piece < last) after = piece + 1;
    return ((is_first && piece == first) ||
            border_of(chain, before, is_first ? before->spans - 1 : span - 1) >= 0) &&
           ((is_last && piece == last) || border_of(chain, after, is_last ? 0 : span + 1) >= 0);
}

/* Returns a bound of the length that can be saved by halving a span. Let e be the sideways distance
 * of the span from the geodesic between its ends, kappa the geodesic curvature and h the length.
 * Then e'' = kappa, and the span is longer than the geodesic by 1/2 int e'^2, which is at most (h /
 * pi)^2 / 2 int kappa^2. To this term, the quadrature error of the length is added. It is needed
 * for spans with an uneven speed but no curvature, such as those along a meridian. If the first
 * term exceeds `enough`, the quadrature error is not computed. */
static double span_error(const struct gd__chain *chain, const struct gd__piece *piece,
                         uint32_t span, double rounding, double enough)
{
    double bend, length;
    gd__energy_bend(chain, piece, span, &bend, &length);
    double error =
        follows_border(chain, piece, span) ? 0 : bend * length * length / (2 * M_PI * M_PI);
    if (error > enough) return error;
    /* the quadrature error is the change of the length if the same rule is applied to the two
       halves of the span */
    double uneven = fabs(gd__energy_length(chain, piece, span, gd__chain_gauss(chain), 2) - length);
    return uneven > noise * rounding ? error + uneven : error;
}

static double chain_error(const struct gd__chain *chain)
{
    double sum = 0, rounding = gd__chain_rounding(chain);
    for (uint32_t i = 0; i < chain->piece_count; i++)
        for (uint32_t span = 0; span < chain->pieces[i].spans; span++)
            sum += span_error(chain, &chain->pieces[i], span, rounding, INFINITY);
    return sum;
}

/* --- ends on curves --------------------------------------------------------------------------- */

/* Restricts a joint on a whole curve to the interval that contains the joint. */
static void settle_joint(struct gd__joint *joint)
{
    if (joint->kind != GD__JOINT_CURVE || !joint->whole) return;
    const struct gd_domain_curve *curve = joint->curve;
    double turns;
    joint->at = gd__curve_reduce(curve, joint->at, &turns);
    for (int k = 0; k < 2; k++) joint->place[k] += turns * curve->winding[k];
    joint->interval = gd__curve_interval(curve, joint->at);
    joint->low = curve->breaks[joint->interval];
    joint->high = curve->breaks[joint->interval + 1];
    joint->whole = false;
}

/* Moves a joint to the previous or next interval of its curve. Returns false if there is none. */
static bool neighbour(const struct gd__joint *joint, int step, struct gd__joint *out)
{
    const struct gd_domain_curve *curve = joint->curve;
    uint32_t last = curve->break_count - 2;
    *out = *joint;
    bool around = step > 0 ? joint->interval == last : joint->interval == 0;
    if (around && !curve->closed) return false;
    out->interval = around ? (step > 0 ? 0 : last) : joint->interval + (uint32_t)step;
    for (int k = 0; k < 2 && around; k++) out->place[k] += step * curve->winding[k];
    out->low = curve->breaks[out->interval];
    out->high = curve->breaks[out->interval + 1];
    out->at = step > 0 ? out->low : out->high;
    return true;
}

static double solve_slope_of(const struct gd__joint *joint, const double pull[2])
{
    struct gd__curve_jet jet;
    gd__joint_jet(joint, joint->at, &jet);
    return pull[0] * jet.first[0] + pull[1] * jet.first[1];
}

/* Moves a joint at the end of its interval to the next interval, if this shortens the path. Returns
 * true if the joint was moved. */
static bool solve_slide(struct gd__joint *joint, const double pull[2], bool *held)
{
    *held = joint->kind == GD__JOINT_LINE && joint->curve;
    if (joint->kind != GD__JOINT_CURVE || joint->whole) return false;
    double slope = solve_slope_of(joint, pull);
    int step = joint->at >= joint->high && slope < 0  ? 1
               : joint->at <= joint->low && slope > 0 ? -1
                                                      : 0;
    struct gd__joint next;
    if (!step) return false;
    *held = true;
    if (!neighbour(joint, step, &next) || step * solve_slope_of(&next, pull) >= 0) return false;
    *joint = next;
    return true;
}

static bool slide_ends(struct gd__solution *solution)
{
    struct gd__joint *joints = solution->chain->joints;
    bool held[2];
    bool moved = solve_slide(&joints[0], solution->report.pull[0], &held[0]);
    moved =
        solve_slide(&joints[solution->chain->piece_count], solution->report.pull[1], &held[1]) ||
        moved;
    solution->corner = held[0] || held[1];
    return moved;
}

/* The ends of a path can move along two curves. Applies Newton's method to a curve of one piece
 * until neither end moves to another interval of its curve. At a corner of this curve, the
 * derivative of the length is not continuous, so Newton's method must be applied to each interval
 * alone. */
static enum gd_status settle_ends(struct gd__solution *solution)
{
    struct gd__joint *joints = solution->chain->joints;
    bool slides = joints[0].kind == GD__JOINT_CURVE || joints[1].kind == GD__JOINT_CURVE;
    bool again = slides && !solution->report.converged;
    enum gd_status status = GD_OK;
    for (int k = 0; k < 2; k++) settle_joint(&joints[k]);
    for (int i = 0; i < SLIDES_MOST && solution->iterations < STEPS_MOST; i++) {
        if (again) status = newton(exact, solution);
        if (status || !slide_ends(solution)) break;
        again = true;
    }
    return status;
}

enum gd_status gd__solve_coarse(const struct gd__task *task, const struct gd__uv_polyline *polyline,
                                const struct gd__joint *from, const struct gd__joint *to,
                                struct gd__solution *out)
{
    uint32_t turns =
                 turns_between(task->surface, polyline->at[0], polyline->at[polyline->count - 1]),
             spans =
                 task->control_points ? task->control_points - task->degree : COARSE_SPANS * turns;
    struct gd__fit fit = {task->degree, spans, *from, *to, true};
    struct gd__solution solution = {0};
    enum gd_status status =
        gd__chain_fit(task->surface, polyline, &fit, task->pace, &solution.chain);
    if (!status) status = newton(task->control_points ? exact : coarse, &solution);
    if (!status && task->control_points) status = settle_ends(&solution);
    if (status) {
        free(solution.chain);
        return status;
    }
    solution.converged = solution.report.converged;
    solution.error = chain_error(solution.chain);
    *out = solution;
    return GD_OK;
}

/* --- cutting at lines ------------------------------------------------------------------------- */

/* Returns the shortest piece if the curve is stuck in a corner of four cells, otherwise NULL. */
static const struct gd__piece *stuck_piece(const struct gd__solution *solution)
{
    const struct gd__chain *chain = solution->chain;
    const struct gd__piece *shortest = NULL;
    double least = stuck * solution->report.length;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        double length = sqrt(2 * gd__energy_value(chain, &chain->pieces[i]));
        if (length < least) least = length, shortest = &chain->pieces[i];
    }
    return shortest;
}

/* A piece has shrunk into a corner of its cell. Replaces the places near this corner by a place in
 * the opposite cell, so that the polyline passes the other side of the corner. */
static enum gd_status pass_other_side(const struct gd__chain *chain, const struct gd__piece *piece,
                                      struct gd__uv_polyline *polyline)
{
    double corner[2], off[2], at[2];
    struct gd__uv_polyline around = {0};
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = chain->surface->axis[k];
        bool is_line[2];
        double line[2];
        for (int side = 0; side < 2; side++)
            line[side] = gd__axis_line(axis, piece->cell.index[k] + side, &is_line[side]);
        bool is_high = line[1] - piece->points[0][k] < piece->points[0][k] - line[0];
        if (!is_line[is_high]) return GD_OK; /* no other cell */
        corner[k] = line[is_high];
        off[k] = aside * (line[1] - line[0]);
        at[k] = corner[k] + (is_high ? off[k] : -off[k]);
    }
    bool passed = false;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < polyline->count && !status; i++) {
        const double *place = polyline->at[i];
        bool is_near = fabs(place[0] - corner[0]) <= off[0] && fabs(place[1] - corner[1]) <= off[1];
        bool is_end = i == 0 || i + 1 == polyline->count;
        if (is_near && !passed && i) {
            status = gd__uv_polyline_add(&around, at);
            passed = true;
        }
        if (!status && (is_end || !is_near)) status = gd__uv_polyline_add(&around, place);
    }
    gd__uv_polyline_free(status ? &around : polyline);
    if (status) return status;
    *polyline = around;
    gd__uv_polyline_measure(chain->surface, polyline);
    return GD_OK;
}

/* Fits the curve to the cells again. If a piece of it is stuck in a corner of four cells, the curve
 * then passes the other side of this corner. */
static enum gd_status solve_cut(const struct gd__task *task, struct gd__solution *solution,
                                const struct gd__piece *stuck_in, uint32_t spans)
{
    struct gd__chain *old = solution->chain, *chain;
    struct gd__fit fit = {task->degree, spans, old->joints[0], old->joints[old->piece_count],
                          false};
    settle_joint(&fit.from);
    settle_joint(&fit.to);
    struct gd__uv_polyline polyline;
    enum gd_status status = gd__uv_polyline_of_chain(old, &polyline);
    if (status) return status;
    if (stuck_in) status = pass_other_side(old, stuck_in, &polyline);
    if (!status) status = gd__chain_fit(task->surface, &polyline, &fit, task->pace, &chain);
    gd__uv_polyline_free(&polyline);
    if (status) return status;
    free(old);
    solution->chain = chain;
    return GD_OK;
}

/* Applies Newton's method to the pieces. If the curve then leaves their cells, fits it to the cells
 * again and repeats. */
static enum gd_status solve_settle(const struct gd__task *task, struct gd__solution *solution,
                                   bool begin, uint32_t spans, bool *settled)
{
    const struct gd__piece *piece = NULL;
    enum gd_status status = GD_OK;
    int corners = 0;
    *settled = false;
    for (int i = 0; i < CUT_MOST && !status && solution->iterations < STEPS_MOST; i++) {
        if (begin || i) status = solve_cut(task, solution, piece, spans);
        if (!status) status = newton(exact, solution);
        if (status) break;
        piece = NULL;
        if (slide_ends(solution)) continue;
        if (!solution->report.converged && corners++ < CORNERS_MOST) piece = stuck_piece(solution);
        if (piece) continue;
        *settled = gd__chain_is_proper(solution->chain);
        if (*settled) break;
    }
    return status;
}

/* --- refinement ------------------------------------------------------------------------------- */

/* Returns the cosine of the angle between the path and the curve on which it ends. For the exact
 * geodesic it is 0. After Newton's method, it shows the error of the spline. */
static double end_defect(const struct gd__solution *solution, int side)
{
    const struct gd__chain *chain = solution->chain;
    const struct gd__joint *joint = &chain->joints[side ? chain->piece_count : 0];
    if (joint->kind != GD__JOINT_CURVE || joint->at <= joint->low || joint->at >= joint->high)
        return 0;
    struct gd__curve_jet c;
    struct gd_jet x;
    gd__joint_jet(joint, joint->at, &c);
    struct gd_vec3 path = gd__chain_velocity(chain, side, &x), curve = gd__velocity(&x, c.first);
    return fabs(gd_vec3_dot(path, curve)) / (gd_vec3_length(path) * gd_vec3_length(curve));
}

/* Returns the width of the span at an end, as a fraction of its piece. */
static double end_share(const struct gd__chain *chain, int side)
{
    const struct gd__piece *piece = &chain->pieces[side ? chain->piece_count - 1 : 0];
    return side ? 1 - piece->knots[chain->degree + piece->spans - 1]
                : piece->knots[chain->degree + 1];
}

/* Returns the allowed error: that of the request's tolerance, but at least the rounding error of
 * the ends, which matters if they are very close to each other. */
static double allowance(const struct gd__task *task, const struct gd__solution *solution)
{
    return fmax(task->tolerance * solution->report.length, gd__chain_rounding(solution->chain));
}

/* Marks the spans that will be halved. Returns the sum of all errors. */
static double solve_mark(const struct gd__task *task, const struct gd__solution *solution,
                         double *errors, bool *marked)
{
    const struct gd__chain *chain = solution->chain;
    uint32_t spans = gd__chain_spans(chain), filled = 0;
    double sum = 0, most = 0, allowed = allowance(task, solution) / (4 * spans),
           rounding = gd__chain_rounding(chain);
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        for (uint32_t span = 0; span < chain->pieces[i].spans; span++) {
            double error = span_error(chain, &chain->pieces[i], span, rounding, allowed);
            errors[filled++] = error;
            sum += error;
            most = fmax(most, error);
        }
    }
    for (uint32_t i = 0; i < spans; i++)
        marked[i] = errors[i] > allowed && errors[i] > worth * most;
    return sum;
}

static bool mark_ends(const struct gd__solution *solution, bool *marked)
{
    uint32_t spans = gd__chain_spans(solution->chain);
    bool low = end_defect(solution, 0) > GD_TOL_END && end_share(solution->chain, 0) > shortest_end;
    bool high =
        end_defect(solution, 1) > GD_TOL_END && end_share(solution->chain, 1) > shortest_end;
    marked[0] = marked[0] || low;
    marked[spans - 1] = marked[spans - 1] || high;
    return low || high;
}

/* Halves spans and applies Newton's method again. Sets *done if the tolerance is met. */
static enum gd_status solve_refine(const struct gd__task *task, struct gd__solution *solution,
                                   bool *done)
{
    uint32_t spans = gd__chain_spans(solution->chain);
    struct gd__arena arena = {0};
    double *errors = gd__arena_take(&arena, spans, sizeof *errors);
    bool *marked = gd__arena_take(&arena, spans, sizeof *marked);
    struct gd__chain *finer = NULL;
    enum gd_status status = arena.status;
    double before = solution->report.length;
    if (!status) {
        double sum = solve_mark(task, solution, errors, marked);
        bool ends = mark_ends(solution, marked);
        *done = solution->converged && !ends && sum <= allowance(task, solution);
        if (*done) solution->error = fmax(solution->error, sum);
        if (!*done) {
            finer = gd__chain_refine(solution->chain, marked);
            if (!finer) status = GD_NO_MEMORY;
        }
    }
    gd__arena_free(&arena);
    if (!finer) return status;
    free(solution->chain);
    solution->chain = finer;
    bool settled;
    status = solve_settle(task, solution, false, 2 * spans, &settled);
    double change = fabs(solution->report.length - before);
    solution->error = change;
    solution->converged =
        settled && solution->report.converged && change <= allowance(task, solution);
    return status;
}

/* Returns true if a coordinate nearly lies in a pole. */
static bool is_falling(const struct gd_axis *axis, double t)
{
    double near = fallen * (axis->high - axis->low);
    return (axis->pole_low && t - axis->low < near) || (axis->pole_high && axis->high - t < near);
}

/* Returns true if the curve shrank into a pole, because no geodesic exists on this side of the
 * pole. Only ends may lie in a pole, and only their neighbours near it. */
static bool has_fallen(const struct gd__chain *chain)
{
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = chain->surface->axis[k];
        bool at_end = false, inside = false;
        for (uint32_t i = 0; i <= chain->piece_count; i++) {
            struct gd__curve_jet jet;
            gd__joint_jet(&chain->joints[i], chain->joints[i].at, &jet);
            bool end = i == 0 || i == chain->piece_count;
            if (is_falling(axis, jet.at[k])) *(end ? &at_end : &inside) = true;
        }
        for (uint32_t i = 0; i < chain->piece_count; i++)
            for (uint32_t n = 1; n + 1 < gd__piece_points(chain, &chain->pieces[i]); n++)
                inside = inside || is_falling(axis, chain->pieces[i].points[n][k]);
        if (inside && !at_end) return true;
    }
    return false;
}

bool gd__solution_is_bent(const struct gd__task *task, const struct gd__solution *solution)
{
    const struct gd__chain *chain = solution->chain;
    double sum = 0;
    if (has_fallen(chain)) return true;
    if (solution->report.contact || task->control_points) return false;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        for (uint32_t span = 0; span < chain->pieces[i].spans; span++) {
            double bend, length;
            gd__energy_bend(chain, &chain->pieces[i], span, &bend, &length);
            sum += bend;
        }
    }
    return sum * solution->report.length > most_bend;
}

/* Returns by how much a path may be too long: its length without the distance of its ends. */
static double excess_of(const struct gd__solution *solution)
{
    struct gd_jet end[2];
    for (int side = 0; side < 2; side++)
        (void)gd__chain_velocity(solution->chain, side, &end[side]);
    return solution->report.length - gd_vec3_distance(end[0].x, end[1].x);
}

static bool is_astray(const struct gd__solution *solution)
{
    return gd__chain_straying(solution->chain) > astray * solution->report.length;
}

/* Judges the curve after the last refinement. Where pieces stray far, the length is not that of a
 * curve on the surface, and the coarse curve `spare` replaces it. If the curve is no geodesic,
 * changes between refinements say nothing about its error. */
static void solution_judge(const struct gd__task *task, struct gd__solution *solution,
                           struct gd__solution *spare)
{
    if (is_astray(solution)) {
        struct gd__solution strayed = *solution;
        *solution = *spare;
        *spare = strayed;
        solution->iterations = strayed.iterations;
        solution->report.converged = false;
    }
    if (!solution->report.converged || gd__solution_is_bent(task, solution)) {
        solution->converged = false;
        solution->error = fmax(solution->error, excess_of(solution));
    }
    double fixed = gd__chain_rounding(solution->chain) + gd__chain_straying(solution->chain);
    solution->error += fixed;
    if (fixed > task->tolerance * solution->report.length) solution->converged = false;
}

/* Returns a copy of a chain, or NULL if out of memory. */
static struct gd__chain *chain_copy(const struct gd__chain *chain)
{
    bool *unmarked = calloc(gd__chain_spans(chain), sizeof *unmarked);
    struct gd__chain *copy = unmarked ? gd__chain_refine(chain, unmarked) : NULL;
    free(unmarked);
    return copy;
}

enum gd_status gd__solve_fine(const struct gd__task *task, struct gd__solution *solution)
{
    bool settled, done = false;
    struct gd__solution spare = *solution;
    spare.chain = chain_copy(solution->chain);
    if (!spare.chain) return GD_NO_MEMORY;
    solution->converged = false;
    const struct gd__chain *coarse_chain = solution->chain;
    const struct gd__piece *last = &coarse_chain->pieces[coarse_chain->piece_count - 1];
    uint32_t turns = turns_between(task->surface, coarse_chain->pieces[0].points[0],
                                   last->points[gd__piece_points(coarse_chain, last) - 1]);
    enum gd_status status = solve_settle(task, solution, true, FIRST_SPANS * turns, &settled);
    for (int i = 0; i < REFINE_MOST && !status && !done; i++) {
        status = solve_refine(task, solution, &done);
        if (gd__chain_spans(solution->chain) > SPANS_MOST || solution->iterations >= STEPS_MOST)
            break;
        if (has_fallen(solution->chain)) break;
        if (i >= ASTRAY_MOST && is_astray(solution)) break;
        if (i >= PATIENCE && gd__solution_is_bent(task, solution)) break;
    }
    if (!status) solution_judge(task, solution, &spare);
    free(spare.chain);
    return status;
}
