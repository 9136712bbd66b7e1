#include "nurbs/way.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/energy.h"

enum { DETOUR = 8 }; /* places around a pole */

/* part of the domain's width: a seed this near a pole may belong to a path through it, or on its
   other side */
static const double near_pole = 0.08;

void gd__way_free(struct gd__way *way)
{
    for (uint32_t i = 0; i < way->parts; i++) free(way->part[i].chain);
    way->parts = 0;
}

double gd__way_length(const struct gd__way *way)
{
    double sum = 0;
    for (uint32_t i = 0; i < way->parts; i++) sum += way->part[i].report.length;
    return sum;
}

bool gd__way_is_minimum(const struct gd__way *way)
{
    for (uint32_t i = 0; i < way->parts; i++)
        if (!way->part[i].report.positive || !way->part[i].report.converged) return false;
    return true;
}

/* The interval of a curve that begins (step 1) or ends (-1) at, or goes on beyond, a place, which
 * is wrapped. False: the curve ends there. */
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

/* Where a curve goes from a pole, forwards (step 1) or backwards (-1); along the pole it stands
 * still. False: nowhere. */
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

/* At an end in a pole that a curve passes: does the way grow longer when it ends beside it on the
 * curve? */
static bool is_held(const struct gd__way *way, int side)
{
    const struct gd__chain *chain = way->part[side ? way->parts - 1 : 0].chain;
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

bool gd__way_is_geodesic(const struct gd__task *task, const struct gd__way *way)
{
    for (uint32_t i = 0; i < way->parts; i++)
        if (gd__solution_is_bent(task, &way->part[i])) return false;
    if (!is_held(way, 0) || !is_held(way, 1)) return false;
    if (way->parts < 2) return true;
    struct gd_jet x;
    struct gd_vec3 in = gd__chain_velocity(way->part[0].chain, 1, &x);
    struct gd_vec3 out = gd__chain_velocity(way->part[1].chain, 0, &x);
    in = gd_vec3_scale(in, 1 / gd_vec3_length(in));
    out = gd_vec3_scale(out, 1 / gd_vec3_length(out));
    return gd_vec3_distance(in, out) <= GD_TOL_POLE_BEND;
}

enum gd_status gd__way_finish(const struct gd__task *task, struct gd__way *way)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < way->parts && !status; i++)
        status = gd__solve_fine(task, &way->part[i]);
    return status;
}

struct gd_vec3 gd__way_middle(const struct gd_parametric *surface, const struct gd__way *way)
{
    double left = 0.5 * gd__way_length(way);
    double at[2] = {0, 0};
    for (uint32_t i = 0; i < way->parts; i++) {
        const struct gd__chain *chain = way->part[i].chain;
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

/* --- from a seed ------------------------------------------------------------------------------ */

/* An end in a pole slides along it: its place in the domain is any of the border. */
static struct gd__joint pole_joint(const struct gd_parametric *surface, int k, const double at[2])
{
    const struct gd_axis *along = surface->axis[1 - k];
    return (struct gd__joint){.kind = GD__JOINT_LINE,
                              .at = at[1 - k],
                              .low = along->closed ? -INFINITY : along->low,
                              .high = along->closed ? INFINITY : along->high,
                              .axis = k,
                              .value = at[k]};
}

static struct gd__joint joint_of(const struct gd_domain_curve *curve, double s, const double at[2])
{
    const struct gd_parametric *surface = curve->surface;
    if (curve->is_point) {
        for (int k = 0; k < 2; k++)
            if (gd__surface_pole(surface, k, at[k])) return pole_joint(surface, k, at);
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

/* Where the place on the curve is a pole: the pole itself, in place of the curve. True: it is. */
static bool tip_joint(const struct gd_domain_curve *curve, double s, const double at[2],
                      struct gd__joint *joint)
{
    for (int k = 0; k < 2 && !curve->is_point; k++) {
        if (!gd__surface_pole(curve->surface, k, at[k])) continue;
        *joint = pole_joint(curve->surface, k, at);
        joint->curve = curve;
        joint->passes = s;
        return true;
    }
    return false;
}

struct visit {
    int axis;
    double border;
    uint32_t place; /* of the trail, nearest to the pole */
    bool exact;     /* it is the pole */
};

/* The pole that a trail comes nearest to on its way, if that is near. */
static bool find_visit(const struct gd_parametric *surface, const struct gd__trail *trail,
                       struct visit *out)
{
    double least = near_pole;
    bool found = false;
    for (int k = 0; k < 2; k++) {
        const struct gd_axis *axis = surface->axis[k];
        for (int side = 0; side < 2; side++) {
            double border = side ? axis->high : axis->low, width = axis->high - axis->low;
            if (!(side ? axis->pole_high : axis->pole_low)) continue;
            if (trail->at[0][k] == border || trail->at[trail->count - 1][k] == border) continue;
            for (uint32_t i = 1; i + 1 < trail->count; i++) {
                double apart = fabs(trail->at[i][k] - border) / width;
                if (apart >= least) continue;
                least = apart;
                found = true;
                *out = (struct visit){k, border, i, gd__surface_pole(surface, k, trail->at[i][k])};
            }
        }
    }
    return found;
}

static enum gd_status add_range(struct gd__trail *trail, const struct gd__trail *from,
                                uint32_t begin, uint32_t end)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = begin; i < end && !status; i++) status = gd__trail_add(trail, from->at[i]);
    return status;
}

static enum gd_status solve_part(const struct gd__task *task, struct gd__trail *trail,
                                 const struct gd__joint *from, const struct gd__joint *to,
                                 struct gd__way *way)
{
    gd__trail_measure(task->surface, trail);
    enum gd_status status = gd__solve_coarse(task, trail, from, to, &way->part[way->parts]);
    if (!status) way->parts++;
    return status;
}

/* Both halves to the pole and from it. */
static enum gd_status solve_through(const struct gd__task *task, const struct gd__joint ends[2],
                                    const struct gd__trail *trail, const struct visit *visit,
                                    struct gd__way *out)
{
    struct gd__way way = {0};
    struct gd__trail half[2] = {{0}};
    double pole[2][2];
    for (int side = 0; side < 2; side++) {
        uint32_t beside = side ? visit->place + 1 : visit->place - 1;
        pole[side][visit->axis] = visit->border;
        pole[side][1 - visit->axis] = trail->at[beside][1 - visit->axis];
    }
    enum gd_status status = add_range(&half[0], trail, 0, visit->place);
    if (!status) status = gd__trail_add(&half[0], pole[0]);
    if (!status) status = gd__trail_add(&half[1], pole[1]);
    if (!status) status = add_range(&half[1], trail, visit->place + 1, trail->count);
    struct gd__joint joint[2];
    for (int side = 0; side < 2; side++)
        joint[side] = pole_joint(task->surface, visit->axis, pole[side]);
    if (!status) status = solve_part(task, &half[0], &ends[0], &joint[0], &way);
    if (!status) status = solve_part(task, &half[1], &joint[1], &ends[1], &way);
    gd__trail_free(&half[0]);
    gd__trail_free(&half[1]);
    if (status)
        gd__way_free(&way);
    else
        *out = way;
    return status;
}

/* Around the pole on one side: from the place before it to the one behind it, which is `turn`
 * periods on. */
static enum gd_status solve_beside(const struct gd__task *task, const struct gd__joint ends[2],
                                   const struct gd__trail *trail, const struct visit *visit,
                                   double turn, struct gd__way *out)
{
    struct gd__way way = {0};
    struct gd__trail around = {0};
    int k = visit->axis;
    const double *before = trail->at[visit->place - 1], *after = trail->at[visit->place + 1];
    double radius = 0.5 * fmin(fabs(before[k] - visit->border), fabs(after[k] - visit->border));
    double side = before[k] > visit->border ? 1 : -1;
    enum gd_status status = add_range(&around, trail, 0, visit->place);
    for (int i = 0; i <= DETOUR && !status; i++) {
        double at[2];
        at[k] = visit->border + side * radius;
        at[1 - k] = before[1 - k] + (after[1 - k] + turn - before[1 - k]) * i / DETOUR;
        status = gd__trail_add(&around, at);
    }
    for (uint32_t i = visit->place + 1; i < trail->count && !status; i++) {
        double at[2] = {trail->at[i][0], trail->at[i][1]};
        at[1 - k] += turn;
        status = gd__trail_add(&around, at);
    }
    struct gd__joint to = ends[1];
    to.place[1 - k] += turn;
    if (to.kind == GD__JOINT_LINE) to.at += turn;
    if (!status) status = solve_part(task, &around, &ends[0], &to, &way);
    gd__trail_free(&around);
    if (!status) *out = way;
    return status;
}

static enum gd_status solve_ways(const struct gd__task *task, const struct gd__joint joint[2],
                                 const struct gd__trail *trail, struct gd__way *out,
                                 uint32_t *count)
{
    struct visit visit;
    bool visits = find_visit(task->surface, trail, &visit);
    enum gd_status status = GD_OK;
    uint32_t made = 0;
    if (visits) status = solve_through(task, joint, trail, &visit, &out[made]), made += !status;
    if (visits && visit.exact && !status) {
        double apart =
            trail->at[visit.place + 1][1 - visit.axis] - trail->at[visit.place - 1][1 - visit.axis];
        double period = gd__axis_period(task->surface->axis[1 - visit.axis]);
        status = solve_beside(task, joint, trail, &visit, 0, &out[made]), made += !status;
        if (!status && period > 0)
            status =
                solve_beside(task, joint, trail, &visit, apart > 0 ? -period : period, &out[made]),
            made += !status;
    } else if (!status) {
        double period = visits ? gd__axis_period(task->surface->axis[1 - visit.axis]) : 0;
        if (period > 0) {
            double apart =
                trail->at[trail->count - 1][1 - visit.axis] - trail->at[0][1 - visit.axis];
            status =
                solve_beside(task, joint, trail, &visit, apart > 0 ? -period : period, &out[made]);
            made += !status;
        }
    }
    if (!status && !(visits && visit.exact)) {
        out[made] = (struct gd__way){.parts = 1};
        status = gd__solve_coarse(task, trail, &joint[0], &joint[1], &out[made].part[0]);
        made += !status;
    }
    for (uint32_t i = 0; i < made && status; i++) gd__way_free(&out[i]);
    for (uint32_t i = 0; i < made; i++) out[i].by_pole = visits;
    if (!status) *count = made;
    return status;
}

enum gd_status gd__ways_of_seed(const struct gd__task *task,
                                const struct gd_domain_curve *const ends[2],
                                const struct gd__seed *seed, struct gd__way *out, uint32_t *count)
{
    const struct gd__trail *trail = &seed->trail;
    struct gd__joint joint[2], tip[2];
    bool tips = false;
    for (int side = 0; side < 2; side++) {
        const double *at = trail->at[side ? trail->count - 1 : 0];
        tip[side] = joint[side] = joint_of(ends[side], seed->s[side], at);
        tips = tip_joint(ends[side], seed->s[side], at, &tip[side]) || tips;
    }
    uint32_t made;
    enum gd_status status = solve_ways(task, joint, trail, out, &made);
    if (!status && tips) {
        out[made] = (struct gd__way){.parts = 1, .tip = true};
        status = gd__solve_coarse(task, trail, &tip[0], &tip[1], &out[made].part[0]);
        for (uint32_t i = 0; i < made && status; i++) gd__way_free(&out[i]);
        made++;
    }
    if (!status) *count = made;
    return status;
}
