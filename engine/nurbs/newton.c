#include "nurbs/newton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/elimination.h"

enum { HALVINGS_MOST = 24 };

/* Armijo's constant: fraction of the expected descent that must be achieved */
static const double armijo = 1e-4;

struct state {
    struct gd__chain *chain;
    struct gd__part *parts;
    double *diagonal, *beside, *move; /* tridiagonal system of the joints, and its solution */
    /* for each joint, a bound: a pivot with a smaller absolute value counts as 0 */
    double *least;
    double *kept_at;     /* the joints' unknowns before the step */
    double *kept_points; /* the control points before the step */
    double *points_move;
    bool contact, flat;
};

static size_t state_doubles(const struct gd__chain *chain)
{
    size_t width = gd__energy_width(chain), sum = 5 * ((size_t)chain->piece_count + 1);
    for (uint32_t i = 0; i < chain->piece_count; i++)
        sum += gd__piece_unknowns(chain, &chain->pieces[i]) *
               (2 * width + 1 + GD__PART_SOLUTIONS + 2 + 1); /* the last array is `held` */
    return sum;
}

static double *newton_carve(double **at, size_t count)
{
    double *begin = *at;
    *at += count;
    return begin;
}

static enum gd_status state_make(struct gd__chain *chain, struct state *out)
{
    size_t doubles = state_doubles(chain);
    enum gd_status status = gd_control_afford(chain->pace->control, doubles * sizeof(double));
    if (status) return status;
    *out = (struct state){.chain = chain};
    double *at = calloc(doubles, sizeof *at);
    out->parts = calloc(chain->piece_count, sizeof *out->parts);
    if (!at || !out->parts) {
        free(at);
        free(out->parts);
        return GD_NO_MEMORY;
    }
    size_t joints = chain->piece_count + (size_t)1, width = gd__energy_width(chain), all = 0;
    /* the first array begins at the start of the allocated block */
    out->diagonal = newton_carve(&at, joints);
    out->beside = newton_carve(&at, joints);
    out->move = newton_carve(&at, joints);
    out->kept_at = newton_carve(&at, joints);
    out->least = newton_carve(&at, joints);
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        size_t unknowns = gd__piece_unknowns(chain, &chain->pieces[i]);
        struct gd__part *part = &out->parts[i];
        part->energy.gradient = newton_carve(&at, unknowns);
        part->energy.hessian = newton_carve(&at, unknowns * width);
        part->factor = newton_carve(&at, unknowns * width);
        for (int k = 0; k < GD__PART_SOLUTIONS; k++)
            part->solution[k] = newton_carve(&at, unknowns);
        part->held = (bool *)newton_carve(&at, unknowns);
        all += unknowns;
    }
    out->kept_points = newton_carve(&at, all);
    out->points_move = newton_carve(&at, all);
    return GD_OK;
}

static void state_free(struct state *state)
{
    free(state->diagonal);
    free(state->parts);
}

/* --- the joints ------------------------------------------------------------------------------- */

static bool joint_is_held(const struct gd__joint *joint, double slope)
{
    if (joint->kind == GD__JOINT_FIXED) return true;
    return (joint->at <= joint->low && slope > 0) || (joint->at >= joint->high && slope < 0);
}

/* Assembles the joints' system of F = sum sqrt(2 E_k). For each piece, let L be its length, g its
 * reduced gradient and S its matrix `schur`. The piece adds S / L to the matrix, and in Newton's
 * method also -g g^T / L^3. The matrix of the Gauss-Newton method is nearly singular for steps that
 * move the whole path sideways. So a damping term is added to its diagonal: the squared speed of
 * the piece's end, divided by L. */
static void couple(struct state *state, enum gd__hessian kind)
{
    uint32_t joints = state->chain->piece_count + 1;
    memset(state->diagonal, 0, joints * sizeof *state->diagonal);
    memset(state->beside, 0, joints * sizeof *state->beside);
    memset(state->move, 0, joints * sizeof *state->move);
    memset(state->least, 0, joints * sizeof *state->least);
    for (uint32_t i = 0; i < state->chain->piece_count; i++) {
        const struct gd__part *part = &state->parts[i];
        double length = part->length,
               cubic = kind == GD__HESSIAN_NEWTON ? 1 / (length * length * length) : 0;
        for (uint32_t side = 0; side < 2; side++) {
            state->diagonal[i + side] += part->schur[side][side] / length -
                                         part->reduced[side] * part->reduced[side] * cubic;
            state->move[i + side] -= part->reduced[side] / length;
            state->least[i + side] += GD_TOL_DEGENERATE * part->weight[side] / length;
            if (kind == GD__HESSIAN_GAUSS) state->diagonal[i + side] += part->weight[side] / length;
        }
        state->beside[i] = part->schur[1][0] / length - part->reduced[0] * part->reduced[1] * cubic;
    }
}

static void hold_joints(struct state *state)
{
    uint32_t joints = state->chain->piece_count + 1;
    for (uint32_t i = 0; i < joints; i++) {
        const struct gd__joint *joint = &state->chain->joints[i];
        if (!joint_is_held(joint, -state->move[i])) continue;
        state->contact = state->contact || joint->kind == GD__JOINT_LINE;
        state->diagonal[i] = 1;
        state->least[i] = 0;
        state->move[i] = 0;
        state->beside[i] = 0;
        if (i) state->beside[i - 1] = 0;
    }
}

/* Solves the tridiagonal system by L D L^T, in place. Returns false if a pivot is negative. A zero
 * pivot, as for a family of equally long paths, is replaced by a small positive one. */
static bool solve_joints(struct state *state)
{
    uint32_t joints = state->chain->piece_count + 1;
    double *d = state->diagonal, *x = state->move;
    for (uint32_t i = 0; i < joints; i++) {
        if (i) {
            double part = state->beside[i - 1] / d[i - 1];
            d[i] -= part * state->beside[i - 1];
            x[i] -= part * x[i - 1];
        }
        if (!(d[i] >= -state->least[i])) return false;
        state->flat = state->flat || d[i] <= state->least[i];
        d[i] = fmax(d[i], state->least[i]);
        if (!(d[i] > 0)) return false;
    }
    for (uint32_t i = joints; i-- > 0;) {
        if (i + 1 < joints) x[i] -= state->beside[i] * x[i + 1];
        x[i] /= d[i];
    }
    return true;
}

/* --- a step ----------------------------------------------------------------------------------- */

static double newton_expand(struct state *state, enum gd__hessian kind)
{
    const struct gd__chain *chain = state->chain;
    double sum = 0;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        struct gd__part *part = &state->parts[i];
        gd__energy_expand(chain, &chain->pieces[i], kind, &part->energy);
        part->length = sqrt(2 * part->energy.value);
        for (uint32_t side = 0; side < 2; side++)
            gd__joint_jet(&chain->joints[i + side], chain->joints[i + side].at, &part->end[side]);
        sum += part->length;
    }
    return sum;
}

/* Computes the step with the given kind of matrix, and the derivative of F along the step. Returns
 * false if the matrix is not positive definite. */
static bool find_step(struct state *state, enum gd__hessian kind, double *slope)
{
    const struct gd__chain *chain = state->chain;
    state->contact = state->flat = false;
    double *scratch = state->points_move;
    for (uint32_t i = 0; i < chain->piece_count; i++)
        if (!gd__part_eliminate(chain, &chain->pieces[i], kind, scratch, &state->parts[i]))
            return false;
    for (uint32_t i = 0; i < chain->piece_count; i++)
        state->contact = state->contact || state->parts[i].contact;
    couple(state, kind);
    hold_joints(state);
    if (!solve_joints(state)) return false;
    *slope = 0;
    double *move = state->points_move;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        const struct gd__part *part = &state->parts[i];
        uint32_t unknowns = gd__piece_unknowns(chain, &chain->pieces[i]);
        double sum = 0;
        for (uint32_t side = 0; side < 2; side++) sum += part->slope[side] * state->move[i + side];
        for (uint32_t k = 0; k < unknowns; k++) {
            move[k] = part->held[k] ? 0
                                    : -part->solution[GD__PART_GRADIENT][k] -
                                          part->solution[GD__PART_FROM][k] * state->move[i] -
                                          part->solution[GD__PART_TO][k] * state->move[i + 1];
            sum += part->energy.gradient[k] * move[k];
        }
        *slope += sum / part->length;
        move += unknowns;
    }
    return true;
}

static void newton_keep(struct state *state)
{
    const struct gd__chain *chain = state->chain;
    double *to = state->kept_points;
    for (uint32_t i = 0; i <= chain->piece_count; i++) state->kept_at[i] = chain->joints[i].at;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        memcpy(to, chain->pieces[i].points,
               gd__piece_unknowns(chain, &chain->pieces[i]) * sizeof *to);
        to += gd__piece_unknowns(chain, &chain->pieces[i]);
    }
}

/* Sets the chain to the stored chain plus a fraction of the step, and clamps it to the domain. */
static void move_by(struct state *state, double part)
{
    struct gd__chain *chain = state->chain;
    const double *from = state->kept_points, *move = state->points_move;
    for (uint32_t i = 0; i <= chain->piece_count; i++) {
        struct gd__joint *joint = &chain->joints[i];
        if (joint->kind != GD__JOINT_FIXED)
            joint->at =
                fmin(fmax(state->kept_at[i] + part * state->move[i], joint->low), joint->high);
    }
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        uint32_t unknowns = gd__piece_unknowns(chain, &chain->pieces[i]);
        for (uint32_t k = 0; k < unknowns; k++) {
            const struct gd_axis *axis = chain->surface->axis[k % 2];
            double t = from[k] + part * move[k];
            chain->pieces[i].points[k / 2][k % 2] =
                axis->closed ? t : fmin(fmax(t, axis->low), axis->high);
        }
        from += unknowns;
        move += unknowns;
    }
    gd__chain_attach(chain);
}

static double newton_length_of(const struct gd__chain *chain)
{
    double sum = 0;
    for (uint32_t i = 0; i < chain->piece_count; i++)
        sum += sqrt(2 * gd__energy_value(chain, &chain->pieces[i]));
    return sum;
}

/* A step may move a control point by at most this fraction of its distance to a pole. In a pole,
 * all places of the border are the same point of the surface, so a control point there has no
 * unique position. */
static const double towards_pole = 0.8;

/* Returns the movement of a coordinate divided by the largest allowed movement. */
static double newton_excess(const struct gd_axis *axis, double t, double move)
{
    double part = 2 * fabs(move) / (axis->high - axis->low);
    if (move < 0 && axis->pole_low && t > axis->low)
        part = fmax(part, -move / (towards_pole * (t - axis->low)));
    if (move > 0 && axis->pole_high && t < axis->high)
        part = fmax(part, move / (towards_pole * (axis->high - t)));
    return part;
}

/* Returns the largest fraction of a step that moves no control point by more than half of the
 * domain, and none into a pole. */
static double longest(const struct state *state)
{
    const struct gd__chain *chain = state->chain;
    const double *move = state->points_move;
    double most = 0;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        for (uint32_t k = 0; k < gd__piece_unknowns(chain, &chain->pieces[i]); k++)
            most = fmax(most, newton_excess(chain->surface->axis[k % 2],
                                            chain->pieces[i].points[k / 2][k % 2], move[k]));
        move += gd__piece_unknowns(chain, &chain->pieces[i]);
    }
    return most > 1 ? 1 / most : 1;
}

/* Searches along the step by Armijo's rule. If no fraction of the step decreases F, restores the
 * chain and returns false. */
static bool newton_search(struct state *state, double length, double slope)
{
    double part = longest(state);
    bool blind = -slope <= GD_TOL_BLIND * length;
    newton_keep(state);
    for (int i = 0; i < HALVINGS_MOST; i++, part *= 0.5) {
        move_by(state, part);
        if (blind || newton_length_of(state->chain) <= length + armijo * part * slope) return true;
    }
    move_by(state, 0);
    return false;
}

static void report_pull(const struct state *state, struct gd__newton_report *report)
{
    const struct gd__part *first = &state->parts[0],
                          *last = &state->parts[state->chain->piece_count - 1];
    uint32_t unknowns =
        gd__piece_unknowns(state->chain, &state->chain->pieces[state->chain->piece_count - 1]);
    for (int k = 0; k < 2; k++) {
        report->pull[0][k] = first->energy.gradient[k] / first->length;
        report->pull[1][k] = last->energy.gradient[unknowns - 2 + (uint32_t)k] / last->length;
    }
}

/* Computes a step with the matrix of the Gauss-Newton method. This step always decreases F. */
static bool fall_back(struct state *state, struct gd__newton_report *report, double *slope)
{
    report->positive = false;
    newton_expand(state, GD__HESSIAN_GAUSS);
    return find_step(state, GD__HESSIAN_GAUSS, slope) && *slope <= 0;
}

/* Makes one iteration. Returns true if another one is needed. */
static bool iterate(struct state *state, double stop, struct gd__newton_report *report)
{
    double slope, before = report->iterations ? report->decrement : INFINITY;
    report->length = newton_expand(state, GD__HESSIAN_NEWTON);
    report->positive = find_step(state, GD__HESSIAN_NEWTON, &slope) && slope <= 0;
    if (!report->positive && !fall_back(state, report, &slope)) return false;
    report->contact = state->contact;
    report->flat = report->positive && state->flat;
    report->decrement = -slope / report->length;
    report_pull(state, report);
    bool blind = report->decrement <= GD_TOL_BLIND;
    report->converged = report->decrement <= stop || (blind && report->decrement > 0.5 * before);
    if (report->converged) return false;
    if (newton_search(state, report->length, slope)) return true;
    return report->positive && fall_back(state, report, &slope) &&
           newton_search(state, report->length, slope);
}

enum gd_status gd__newton(struct gd__chain *chain, const struct gd__newton_limits *limits,
                          struct gd__newton_report *out)
{
    struct state state;
    enum gd_status status = state_make(chain, &state);
    if (status) return status;
    struct gd__newton_report report = {0};
    gd__chain_attach(chain);
    while (report.iterations < limits->most && gd__pace(chain->pace, GD__STEP)) {
        if (!iterate(&state, limits->stop, &report)) break;
        report.iterations++;
    }
    state_free(&state);
    if (!chain->pace->status) *out = report;
    return chain->pace->status;
}
