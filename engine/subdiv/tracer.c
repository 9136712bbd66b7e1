#include "subdiv/tracer.h"

#include <math.h>

#include "base/tolerance.h"
#include "subdiv/domain.h"

static const struct gd__scheme *rules_of(const struct gd__tracer *tracer)
{
    return tracer->walker->surface->rules;
}

/* Puts a state that is on line k exactly there. */
static void settle(uint32_t arity, uint32_t k, struct gd__flow *flow)
{
    double at[2], m = gd__along_side(arity, k, flow->s, flow->t);
    gd__place_on_side(arity, k, m, at);
    flow->s = at[0], flow->t = at[1];
}

/* The state in the piece's coordinates, on its border where it is within slack of that. In small
 * pieces the base face's coordinates tell places with an error, and axes turn within small pieces
 * as much as within large ones: so it is the direction that is taken apart, at the very place. */
static struct gd__flow flow_in(const struct gd__tracer *tracer)
{
    const struct gd__scheme *rules = rules_of(tracer);
    const struct gd__cell *piece = &tracer->walker->piece;
    struct gd__jet jet;
    double at[2], move[2] = {NAN, NAN};
    gd__chart_in(&piece->frame, tracer->spot.s, tracer->spot.t, at);
    struct gd__flow flow = {.s = at[0], .t = at[1]};
    for (uint32_t k = 0; k < rules->arity; k++) {
        if (fabs(gd__line_at(rules->arity, k, flow.s, flow.t)) <= piece->slack)
            settle(rules->arity, k, &flow);
    }
    rules->evaluate(&piece->patch, flow.s, flow.t, &jet);
    (void)gd__components(&jet, tracer->direction, move);
    flow.ds = move[0], flow.dt = move[1];
    return flow;
}

static void set_direction(struct gd__tracer *tracer, struct gd_vec3 vector)
{
    double length = gd_vec3_length(vector);
    tracer->direction = gd_vec3_scale(vector, 1 / length);
    tracer->ds /= length;
    tracer->dt /= length;
}

static void flow_out(struct gd__tracer *tracer, const struct gd__flow *flow)
{
    struct gd__chart frame = tracer->walker->piece.frame;
    double at[2], move[2];
    gd__chart_out(&frame, flow->s, flow->t, at);
    frame.origin[0] = frame.origin[1] = 0;
    gd__chart_out(&frame, flow->ds, flow->dt, move);
    tracer->spot.s = at[0], tracer->spot.t = at[1];
    tracer->ds = move[0], tracer->dt = move[1];
    /* from the piece's own coordinates: at a distant corner the base face's don't tell places in
     * small pieces well enough for derivatives */
    struct gd__jet jet;
    rules_of(tracer)->evaluate(&tracer->walker->piece.patch, flow->s, flow->t, &jet);
    tracer->position = gd_vec3_add(jet.p, tracer->walker->piece.origin);
    tracer->direction = gd_vec3_along(gd_vec3_scale(jet.s, flow->ds), flow->dt, jet.t);
    double length = gd_vec3_length(tracer->direction);
    tracer->direction = gd_vec3_scale(tracer->direction, 1 / length);
    tracer->ds = move[0] / length, tracer->dt = move[1] / length;
}

/* Where derivatives span no plane nothing is straight. */
static enum gd_status end_here(struct gd__tracer *tracer)
{
    tracer->ended = true;
    tracer->end = GD_LIMIT_END_SINGULAR;
    return GD_OK;
}

/* Enters the piece at the spot; the direction's components are those of `direction` there. */
static enum gd_status enter(struct gd__tracer *tracer, struct gd_vec3 direction)
{
    uint32_t corner;
    double c[2];
    if (!gd__cell_at(tracer->walker, &tracer->spot, tracer->ds, tracer->dt, &corner))
        return gd__tracer_leave_vertex(tracer, tracer->spot.face, corner, direction);
    struct gd__jet jet = gd__cell_jet(tracer->walker, tracer->spot.s, tracer->spot.t);
    tracer->position = jet.p;
    if (!gd__components(&jet, direction, c)) return end_here(tracer);
    tracer->ds = c[0], tracer->dt = c[1];
    struct gd_vec3 vector = gd_vec3_along(gd_vec3_scale(jet.s, c[0]), c[1], jet.t);
    if (!(gd_vec3_length(vector) > GD_TOL_INPUT * gd_vec3_length(direction)))
        return GD_INVALID_ARGUMENT;
    set_direction(tracer, vector);
    return GD_OK;
}

enum gd_status gd__tracer_start(struct gd__tracer *tracer, struct gd__walker *walker,
                                const struct gd__spot *spot, struct gd_vec3 direction)
{
    *tracer = (struct gd__tracer){.walker = walker, .spot = *spot, .direction = direction};
    enum gd_status status = enter(tracer, direction);
    /* once more: now it is known which of the pieces that meet here it leads into */
    if (!status && !tracer->ended && walker->piece.face != GD_NONE)
        status = enter(tracer, tracer->direction);
    tracer->under_way = true;
    return status;
}

/* The side of the base face over which the path is about to go, GD_NONE: it is not. */
static uint32_t side_ahead(const struct gd__tracer *tracer)
{
    uint32_t arity = rules_of(tracer)->arity, found = GD_NONE;
    double steepest = 0, speed = fmax(fabs(tracer->ds), fabs(tracer->dt));
    for (uint32_t k = 0; k < arity; k++) {
        double slope = gd__line_slope(arity, k, tracer->ds, tracer->dt) / speed;
        if (gd__line_at(arity, k, tracer->spot.s, tracer->spot.t) > GD_TOL_PATCH ||
            slope >= steepest)
            continue;
        if (slope > -GD_TOL_PATCH) continue;
        steepest = slope;
        found = k;
    }
    return found;
}

/* Unit vector along side k, and the unit normal. */
static bool side_axes(const struct gd__jet *jet, uint32_t arity, uint32_t k, struct gd_vec3 *along,
                      struct gd_vec3 *normal)
{
    double a[2], b[2];
    gd__place_on_side(arity, k, 0, a);
    gd__place_on_side(arity, k, 1, b);
    *along = gd_vec3_along(gd_vec3_scale(jet->s, b[0] - a[0]), b[1] - a[1], jet->t);
    *normal = gd_vec3_cross(jet->s, jet->t);
    double length = gd_vec3_length(*along), area = gd_vec3_length(*normal);
    if (!(length > 0 && area > 0)) return false;
    *along = gd_vec3_scale(*along, 1 / length);
    *normal = gd_vec3_scale(*normal, 1 / area);
    return true;
}

/* Over side k into the face behind it. Movements for the choice of a piece there: along the side as
 * here, and inwards. */
static enum gd_status cross_side(struct gd__tracer *tracer, uint32_t k)
{
    const struct gd__net *base = &tracer->walker->surface->base;
    uint32_t arity = base->arity, twin = base->twin[arity * tracer->spot.face + k];
    if (twin == GD_NONE) {
        tracer->ended = true;
        tracer->end = GD_LIMIT_END_BOUNDARY;
        return GD_OK;
    }
    struct gd_vec3 along, normal, next_along, next_normal;
    struct gd__jet jet = gd__cell_jet(tracer->walker, tracer->spot.s, tracer->spot.t);
    if (!side_axes(&jet, arity, k, &along, &normal)) return end_here(tracer);
    double x = gd_vec3_dot(tracer->direction, along);
    double y = gd_vec3_dot(tracer->direction, gd_vec3_cross(along, normal));

    double m = 1 - gd__along_side(arity, k, tracer->spot.s, tracer->spot.t), a[2], b[2], in[2];
    uint32_t other = twin % arity, corner;
    tracer->spot.face = twin / arity;
    gd__place_on_side(arity, other, m, in);
    gd__place_on_side(arity, other, 0, a);
    gd__place_on_side(arity, other, 1, b);
    tracer->spot.s = in[0], tracer->spot.t = in[1];
    /* along the side; turned to the left it leads inwards */
    double s = b[0] - a[0], t = b[1] - a[1];
    if (!gd__cell_at(tracer->walker, &tracer->spot, -x * s - y * t, -x * t + y * s, &corner))
        return gd__tracer_leave_vertex(tracer, tracer->spot.face, corner, tracer->direction);
    /* smooth: the same vector */
    if (base->sharpness[twin] != INFINITY) return enter(tracer, tracer->direction);
    jet = gd__cell_jet(tracer->walker, in[0], in[1]);
    if (!side_axes(&jet, arity, other, &next_along, &next_normal)) return end_here(tracer);
    struct gd_vec3 inwards = gd_vec3_cross(next_normal, next_along);
    return enter(tracer, gd_vec3_along(gd_vec3_scale(next_along, -x), y, inwards));
}

/* Where the path goes from the end of a step on a border of its piece. */
static enum gd_status hand_over(struct gd__tracer *tracer)
{
    uint32_t side = side_ahead(tracer);
    return side == GD_NONE ? enter(tracer, tracer->direction) : cross_side(tracer, side);
}

/* The lowest line that a state is beyond, GD_NONE: it is inside. */
static uint32_t line_beyond(uint32_t arity, const struct gd__flow *flow)
{
    uint32_t found = GD_NONE;
    double lowest = -GD_TOL_PATCH;
    for (uint32_t k = 0; k < arity; k++) {
        double height = gd__line_at(arity, k, flow->s, flow->t);
        if (height < lowest) lowest = height, found = k;
    }
    return found;
}

/* The step in (0, step] to where line k is crossed: Newton's iteration within a bracket. Leaves
 * `*end` there. `from` is on the inner side. */
static double step_to_line(struct gd__tracer *tracer, const struct gd__flow *from, double step,
                           uint32_t k, struct gd__flow *end)
{
    uint32_t arity = rules_of(tracer)->arity;
    double low = 0, high = step, at = step;
    for (int i = 0; i < 60; i++) {
        double height = gd__line_at(arity, k, end->s, end->t),
               slope = gd__line_slope(arity, k, end->ds, end->dt);
        if (fabs(height) <= GD_TOL_FOOT) break;
        *(height > 0 ? &low : &high) = at;
        at -= height / slope;
        if (!(at > low && at < high)) at = low + (high - low) / 2;
        if (!gd__flow_advance(rules_of(tracer), &tracer->walker->piece.patch, from, at, end)) break;
    }
    return at;
}

/* Shortens a step that ends beyond the piece to where it leaves it first. */
static double step_to_border(struct gd__tracer *tracer, const struct gd__flow *from, double step,
                             struct gd__flow *end, bool *at_border)
{
    uint32_t arity = rules_of(tracer)->arity, k;
    double least = GD_TOL_PATCH * step;
    *at_border = false;
    while ((k = line_beyond(arity, end)) != GD_NONE) {
        double height = gd__line_at(arity, k, from->s, from->t);
        *at_border = true;
        bool ahead = gd__line_slope(arity, k, from->ds, from->dt) > 0;
        if (height <= GD_TOL_PATCH && !(ahead && step > least)) { /* it leaves at once */
            *end = *from;
            settle(arity, k, end);
            return 0;
        }
        /* it left the line and came back: half as far it may still be inside */
        if (height <= GD_TOL_PATCH) {
            step /= 2;
            if (!gd__flow_advance(rules_of(tracer), &tracer->walker->piece.patch, from, step, end))
                return 0;
            *at_border = false;
            continue;
        }
        step = step_to_line(tracer, from, step, k, end);
        settle(arity, k, end);
    }
    return step;
}

/* The vertex at the nearest corner of the base face, if the piece is small and the path about to
 * meet it within `most`. */
static enum gd_status meet_vertex(struct gd__tracer *tracer, double most, bool *met)
{
    const struct gd__cell *piece = &tracer->walker->piece;
    double scale = fabs(piece->frame.s[0]) + fabs(piece->frame.s[1]);
    *met = false;
    if (scale > ldexp(1, -10)) return GD_OK;
    uint32_t face = tracer->spot.face;
    uint32_t corner = gd__nearest_corner(rules_of(tracer)->arity, tracer->spot.s, tracer->spot.t);
    struct gd__vertex vertex;
    gd__corner_limit(tracer->walker, face, corner, &vertex);
    struct gd_vec3 way = gd_vec3_sub(vertex.position, tracer->position);
    double length = gd_vec3_length(way), width = length;
    /* a spike that thin is its axis, and on it the path goes to the tip */
    if (isnan(vertex.normal.x)) {
        struct gd__jet jet = gd__cell_jet(tracer->walker, tracer->spot.s, tracer->spot.t);
        width *= gd__sine(&jet);
    }
    bool near = width <= GD_TOL_VERTEX * tracer->walker->surface->size || scale < ldexp(1, -40);
    if (!near || length > most || gd_vec3_dot(way, tracer->direction) <= 0) return GD_OK;
    *met = true;
    tracer->skipped += length;
    return gd__tracer_leave_vertex(tracer, face, corner, tracer->direction);
}

enum gd_status gd__tracer_step(struct gd__tracer *tracer, double most, double *length)
{
    const struct gd__scheme *rules = rules_of(tracer);
    bool met = false, at_border;
    enum gd_status status = meet_vertex(tracer, most, &met);
    if (!met || tracer->ended) {
        *length += tracer->skipped;
        tracer->skipped = 0;
    }
    if (status || met) return status;
    struct gd__flow from = flow_in(tracer), end;
    double speed = fmax(fabs(from.ds), fabs(from.dt)), step = fmin(most, 1 / speed);
    while (!gd__flow_advance(rules, &tracer->walker->piece.patch, &from, step, &end)) {
        step /= 2;
        if (!(step * speed > GD_TOL_PATCH)) return GD_INTERNAL;
    }
    step = step_to_border(tracer, &from, step, &end, &at_border);
    flow_out(tracer, &end);
    *length += step;
    return at_border ? hand_over(tracer) : GD_OK;
}
