#include "nurbs/candidate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/energy.h"

enum { DETOUR = 8 }; /* number of steps of a detour around a pole */

/* If a seed comes nearer to a pole than this fraction of the domain's width, the path may pass
 * through the pole or on its other side. */
static const double near_pole = 0.08;

void gd__candidate_free(struct gd__candidate *candidate)
{
    for (uint32_t i = 0; i < candidate->parts; i++) free(candidate->part[i].chain);
    candidate->parts = 0;
}

double gd__candidate_length(const struct gd__candidate *candidate)
{
    double sum = 0;
    for (uint32_t i = 0; i < candidate->parts; i++) sum += candidate->part[i].report.length;
    return sum;
}

bool gd__candidate_is_minimum(const struct gd__candidate *candidate)
{
    for (uint32_t i = 0; i < candidate->parts; i++)
        if (!candidate->part[i].report.positive || !candidate->part[i].report.converged)
            return false;
    return true;
}

/* Finds the interval of a curve after (step 1) or before (step -1) the parameter *s. Wraps *s if
 * the curve is closed. Returns false if the curve ends there. */
static bool interval_beside(const struct gd_domain_curve *curve, int step, double *s,
                            uint32_t *interval)
{
    uint32_t i = gd__curve_interval(curve, *s), last = curve->break_count - 2;
    if (step > 0 ? *s < curve->breaks[i + 1] : *s > curve->breaks[i]) {
        *interval = i;
        return true;
    }
    bool around = i == (step > 0 ? last : 0);
    if (around && !curve->closed) return false;
    *interval = around ? (step > 0 ? 0 : last) : i + (uint32_t)step;
    *s = step > 0 ? curve->breaks[*interval] : curve->breaks[*interval + 1];
    return true;
}

/* Computes the velocity with which a curve leaves a pole, forwards (step 1) or backwards (step -1).
 * Returns false if the curve stays in the pole. */
static bool leaving(const struct gd_domain_curve *curve, double s, int step, struct gd_vec3 *out)
{
    double still = GD_TOL_COINCIDE * curve->surface->size / (curve->high - curve->low);
    for (uint32_t n = 0, i; n < curve->break_count && interval_beside(curve, step, &s, &i); n++) {
        struct gd__curve_jet c;
        struct gd_jet x;
        gd__curve_jet_in(curve, i, s, &c);
        gd__surface_at(curve->surface, c.at, &x);
        *out = gd_vec3_scale(gd__velocity(&x, c.first), step);
        if (gd_vec3_length(*out) > still) return true;
        s = step > 0 ? curve->breaks[i + 1] : curve->breaks[i];
    }
    return false;
}

/* Returns false if the end of the path is in a pole that a curve passes, and a path to a nearby
 * point of the curve is shorter. Otherwise returns true. */
static bool candidate_is_held(const struct gd__candidate *candidate, int side)
{
    const struct gd__chain *chain = candidate->part[side ? candidate->parts - 1 : 0].chain;
    const struct gd__joint *joint = &chain->joints[side ? chain->piece_count : 0];
    if (joint->kind != GD__JOINT_LINE || !joint->curve) return true;
    struct gd_jet x;
    struct gd_vec3 along, path = gd_vec3_scale(gd__chain_velocity(chain, side, &x), side ? 1 : -1);
    for (int step = -1; step <= 1; step += 2)
        if (leaving(joint->curve, joint->passes, step, &along) &&
            gd_vec3_dot(path, along) < -GD_TOL_END * gd_vec3_length(path) * gd_vec3_length(along))
            return false;
    return true;
}

bool gd__candidate_is_geodesic(const struct gd__task *task, const struct gd__candidate *candidate)
{
    for (uint32_t i = 0; i < candidate->parts; i++)
        if (gd__solution_is_bent(task, &candidate->part[i])) return false;
    if (!candidate_is_held(candidate, 0) || !candidate_is_held(candidate, 1)) return false;
    if (candidate->parts < 2) return true;
    struct gd_jet x;
    struct gd_vec3 in = gd__chain_velocity(candidate->part[0].chain, 1, &x);
    struct gd_vec3 out = gd__chain_velocity(candidate->part[1].chain, 0, &x);
    in = gd_vec3_scale(in, 1 / gd_vec3_length(in));
    out = gd_vec3_scale(out, 1 / gd_vec3_length(out));
    return gd_vec3_distance(in, out) <= GD_TOL_POLE_BEND;
}

enum gd_status gd__candidate_finish(const struct gd__task *task, struct gd__candidate *candidate)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < candidate->parts && !status; i++)
        status = gd__solve_fine(task, &candidate->part[i]);
    return status;
}

/* Returns the point in space after a fraction of the path's length. */
static struct gd_vec3 point_after(const struct gd_parametric *surface,
                                  const struct gd__candidate *candidate, double part)
{
    double left = part * gd__candidate_length(candidate);
    double at[2] = {0, 0};
    for (uint32_t i = 0; i < candidate->parts; i++) {
        const struct gd__chain *chain = candidate->part[i].chain;
        for (uint32_t k = 0; k < chain->piece_count; k++) {
            const struct gd__piece *piece = &chain->pieces[k];
            double length = sqrt(2 * gd__energy_value(chain, piece)), t = fmin(left / length, 1);
            struct gd__curve_jet c;
            uint32_t span = 0;
            while (span + 1 < piece->spans && piece->knots[chain->degree + span + 1] < t) span++;
            gd__piece_at(chain, piece, span, t, &c);
            memcpy(at, c.at, sizeof at);
            left -= length;
            if (left <= 0) return gd__surface_position(surface, at);
        }
    }
    return gd__surface_position(surface, at);
}

void gd__candidate_identify(const struct gd_parametric *surface, struct gd__candidate *candidate)
{
    candidate->coarse = gd__candidate_length(candidate);
    candidate->quarter = point_after(surface, candidate, 0.25);
    candidate->middle = point_after(surface, candidate, 0.5);
}

double gd__candidate_parameter(const struct gd__candidate *candidate, int side)
{
    const struct gd__chain *chain = candidate->part[side ? candidate->parts - 1 : 0].chain;
    const struct gd__joint *joint = &chain->joints[side ? chain->piece_count : 0];
    double turns;
    if (!joint->curve) return 0;
    return gd__curve_reduce(joint->curve, joint->kind == GD__JOINT_LINE ? joint->passes : joint->at,
                            &turns);
}

void gd__candidate_turns(const struct gd__candidate *candidate,
                         const struct gd_domain_curve *const ends[2], int32_t out[2])
{
    double run[2] = {0, 0};
    for (int side = 0; side < 2; side++) {
        const struct gd__chain *chain = candidate->part[side ? candidate->parts - 1 : 0].chain;
        const struct gd__piece *piece = &chain->pieces[side ? chain->piece_count - 1 : 0];
        const double *place = piece->points[side ? gd__piece_points(chain, piece) - 1 : 0];
        double at[2];
        gd_domain_curve_at(ends[side], gd__candidate_parameter(candidate, side), at);
        for (int k = 0; k < 2; k++) run[k] += (side ? 1 : -1) * (place[k] - at[k]);
    }
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(ends[0]->surface->axis[k]);
        out[k] = period > 0 ? (int32_t)lround(run[k] / period) : 0;
    }
}

/* --- from a seed ------------------------------------------------------------------------------ */

struct gd__joint gd__joint_of_end(const struct gd_domain_curve *curve, double s, const double at[2])
{
    const struct gd_parametric *surface = curve->surface;
    if (curve->is_point) {
        /* all places on the border of a pole are the same point of the surface */
        for (int k = 0; k < 2; k++)
            if (gd__surface_pole(surface, k, at[k])) return gd__joint_on_line(surface, k, at);
        return (struct gd__joint){.kind = GD__JOINT_FIXED, .place = {at[0], at[1]}};
    }
    struct gd__joint joint = {.kind = GD__JOINT_CURVE,
                              .at = s,
                              .low = curve->closed ? -INFINITY : curve->low,
                              .high = curve->closed ? INFINITY : curve->high,
                              .curve = curve,
                              .whole = true};
    double here[2];
    gd_domain_curve_at(curve, s, here);
    for (int k = 0; k < 2; k++) {
        double period = gd__axis_period(surface->axis[k]);
        joint.place[k] = period > 0 ? round((at[k] - here[k]) / period) * period : 0;
    }
    return joint;
}

/* If a place on a curve lies in a pole, sets *joint to the pole and returns true. */
static bool tip_joint(const struct gd_domain_curve *curve, double s, const double at[2],
                      struct gd__joint *joint)
{
    for (int k = 0; k < 2 && !curve->is_point; k++) {
        if (!gd__surface_pole(curve->surface, k, at[k])) continue;
        *joint = gd__joint_on_line(curve->surface, k, at);
        joint->curve = curve;
        joint->passes = s;
        return true;
    }
    return false;
}

struct visit {
    int axis;
    double border;
    uint32_t place; /* index of the polyline's place nearest to the pole */
    bool exact;     /* true if the place is in the pole */
};

/* Finds the pole that is nearest to a polyline. Returns false if no pole is near. */
static bool find_visit(const struct gd_parametric *surface, const struct gd__uv_polyline *polyline,
                       struct visit *out)
{
    double least = near_pole;
    bool found = false;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        for (int side = 0; side < 2; side++) {
            double border = side ? axis->high : axis->low, width = axis->high - axis->low;
            if (!(side ? axis->pole_high : axis->pole_low)) continue;
            if (polyline->at[0][k] == border || polyline->at[polyline->count - 1][k] == border)
                continue;
            for (uint32_t i = 1; i + 1 < polyline->count; i++) {
                double apart = fabs(polyline->at[i][k] - border) / width;
                if (apart >= least) continue;
                least = apart;
                found = true;
                *out =
                    (struct visit){k, border, i, gd__surface_pole(surface, k, polyline->at[i][k])};
            }
        }
    }
    return found;
}

static enum gd_status solve_part(const struct gd__task *task, struct gd__uv_polyline *polyline,
                                 const struct gd__joint *from, const struct gd__joint *to,
                                 struct gd__candidate *candidate)
{
    gd__uv_polyline_measure(task->surface, polyline);
    enum gd_status status =
        gd__solve_coarse(task, polyline, from, to, &candidate->part[candidate->parts]);
    if (!status) candidate->parts++;
    return status;
}

/* Computes a path through the pole as two halves, one to the pole and one from the pole. */
static enum gd_status solve_through(const struct gd__task *task, const struct gd__joint ends[2],
                                    const struct gd__uv_polyline *polyline,
                                    const struct visit *visit, struct gd__candidate *out)
{
    struct gd__candidate candidate = {0};
    struct gd__uv_polyline half[2] = {{0}};
    double pole[2][2];
    for (int side = 0; side < 2; side++) {
        uint32_t beside = side ? visit->place + 1 : visit->place - 1;
        pole[side][visit->axis] = visit->border;
        pole[side][1 - visit->axis] = polyline->at[beside][1 - visit->axis];
    }
    enum gd_status status = gd__uv_polyline_append(&half[0], polyline, 0, visit->place);
    if (!status) status = gd__uv_polyline_add(&half[0], pole[0]);
    if (!status) status = gd__uv_polyline_add(&half[1], pole[1]);
    if (!status)
        status = gd__uv_polyline_append(&half[1], polyline, visit->place + 1, polyline->count);
    struct gd__joint joint[2];
    for (int side = 0; side < 2; side++)
        joint[side] = gd__joint_on_line(task->surface, visit->axis, pole[side]);
    if (!status) status = solve_part(task, &half[0], &ends[0], &joint[0], &candidate);
    if (!status) status = solve_part(task, &half[1], &joint[1], &ends[1], &candidate);
    gd__uv_polyline_free(&half[0]);
    gd__uv_polyline_free(&half[1]);
    if (status)
        gd__candidate_free(&candidate);
    else
        *out = candidate;
    return status;
}

/* Computes a path that passes the pole on one side. Its initial polyline consists of the seed's
 * polyline before the pole, a detour, and the seed's polyline after the pole, shifted by `turn`. */
static enum gd_status solve_beside(const struct gd__task *task, const struct gd__joint ends[2],
                                   const struct gd__uv_polyline *polyline,
                                   const struct visit *visit, double turn,
                                   struct gd__candidate *out)
{
    struct gd__candidate candidate = {0};
    struct gd__uv_polyline around = {0};
    int k = visit->axis;
    const double *before = polyline->at[visit->place - 1], *after = polyline->at[visit->place + 1];
    double radius = 0.5 * fmin(fabs(before[k] - visit->border), fabs(after[k] - visit->border));
    double side = before[k] > visit->border ? 1 : -1;
    enum gd_status status = gd__uv_polyline_append(&around, polyline, 0, visit->place);
    for (int i = 0; i <= DETOUR && !status; i++) {
        double at[2];
        at[k] = visit->border + side * radius;
        at[1 - k] = before[1 - k] + (after[1 - k] + turn - before[1 - k]) * i / DETOUR;
        status = gd__uv_polyline_add(&around, at);
    }
    for (uint32_t i = visit->place + 1; i < polyline->count && !status; i++) {
        double at[2] = {polyline->at[i][0], polyline->at[i][1]};
        at[1 - k] += turn;
        status = gd__uv_polyline_add(&around, at);
    }
    struct gd__joint to = ends[1];
    to.place[1 - k] += turn;
    if (to.kind == GD__JOINT_LINE) to.at += turn;
    if (!status) status = solve_part(task, &around, &ends[0], &to, &candidate);
    gd__uv_polyline_free(&around);
    if (!status) *out = candidate;
    return status;
}

static enum gd_status solve_candidates(const struct gd__task *task, const struct gd__joint joint[2],
                                       const struct gd__uv_polyline *polyline,
                                       struct gd__candidate *out, uint32_t *count)
{
    struct visit visit = {0};
    bool visits = find_visit(task->surface, polyline, &visit), exact = visits && visit.exact;
    double period = visits ? gd__axis_period(task->surface->axis[1 - visit.axis]) : 0;
    uint32_t from = exact ? visit.place - 1 : 0, to = exact ? visit.place + 1 : polyline->count - 1,
             made = 0;
    double apart = polyline->at[to][1 - visit.axis] - polyline->at[from][1 - visit.axis];
    enum gd_status status = GD_OK;
    if (visits) status = solve_through(task, joint, polyline, &visit, &out[made]), made += !status;
    if (exact && !status)
        status = solve_beside(task, joint, polyline, &visit, 0, &out[made]), made += !status;
    if (period > 0 && !status)
        status =
            solve_beside(task, joint, polyline, &visit, apart > 0 ? -period : period, &out[made]),
        made += !status;
    if (!exact && !status) {
        out[made] = (struct gd__candidate){.parts = 1};
        status = gd__solve_coarse(task, polyline, &joint[0], &joint[1], &out[made].part[0]);
        made += !status;
    }
    for (uint32_t i = 0; i < made && status; i++) gd__candidate_free(&out[i]);
    for (uint32_t i = 0; i < made; i++) out[i].by_pole = visits;
    if (!status) *count = made;
    return status;
}

enum gd_status gd__candidates_of_seed(const struct gd__task *task,
                                      const struct gd_domain_curve *const ends[2],
                                      const struct gd__path_seed *seed, struct gd__candidate *out,
                                      uint32_t *count)
{
    const struct gd__uv_polyline *polyline = &seed->polyline;
    struct gd__joint joint[2], tip[2];
    bool tips = false;
    for (int side = 0; side < 2; side++) {
        const double *at = polyline->at[side ? polyline->count - 1 : 0];
        tip[side] = joint[side] = gd__joint_of_end(ends[side], seed->s[side], at);
        tips = tip_joint(ends[side], seed->s[side], at, &tip[side]) || tips;
    }
    uint32_t made;
    enum gd_status status = solve_candidates(task, joint, polyline, out, &made);
    if (!status && tips) {
        out[made] = (struct gd__candidate){.parts = 1, .tip = true};
        status = gd__solve_coarse(task, polyline, &tip[0], &tip[1], &out[made].part[0]);
        for (uint32_t i = 0; i < made && status; i++) gd__candidate_free(&out[i]);
        made++;
    }
    if (!status) *count = made;
    return status;
}
