#include "subdiv/tracer.h"

#include <math.h>

#include "base/tolerance.h"
#include "subdiv/domain.h"

/* --- flow ------------------------------------------------------------------------------------- */

/* Gragg's modified midpoint rule, extrapolated: Hairer, Norsett, Wanner, Solving ordinary
 * differential equations I, II.9. The right-hand side is smooth on the whole patch, so a method of
 * high order is efficient: a patch usually takes one or two steps. */

/* A place in the patch's coordinates, and its derivative by the path's arc length (the
 * velocity). */
struct flow_state {
    double s, t, ds, dt;
};

/* Computes the components of a vector's tangential part along the two derivatives of a jet. Returns
 * false if the derivatives are parallel. */
static bool components_of(const struct gd__jet *jet, struct gd_vec3 vector, double out[2])
{
    /* uses cross products, because products of lengths lose more digits if the derivatives are
       nearly parallel */
    struct gd_vec3 normal = gd_vec3_cross(jet->s, jet->t);
    double square = gd_vec3_dot(normal, normal);
    if (!(square > 0)) return false;
    out[0] = gd_vec3_dot(gd_vec3_cross(vector, jet->t), normal) / square;
    out[1] = gd_vec3_dot(gd_vec3_cross(jet->s, vector), normal) / square;
    return true;
}

/* Returns the sine of the angle between the derivatives. Rounding errors are multiplied by its
 * inverse. */
static double jet_sine(const struct gd__jet *jet)
{
    return gd_vec3_length(gd_vec3_cross(jet->s, jet->t)) /
           (gd_vec3_length(jet->s) * gd_vec3_length(jet->t));
}

struct slope {
    double v[4];
    double sine;
};

static struct slope flow_slope_at(const struct gd__scheme *rules, const struct gd__patch *patch,
                                  const double y[4])
{
    struct gd__jet jet;
    double c[2];
    rules->evaluate(patch, y[0], y[1], &jet);
    struct gd_vec3 a = gd_vec3_scale(jet.ss, y[2] * y[2]);
    a = gd_vec3_along(a, 2 * y[2] * y[3], jet.st);
    a = gd_vec3_along(a, y[3] * y[3], jet.tt);
    if (!components_of(&jet, a, c)) c[0] = c[1] = NAN;
    return (struct slope){{y[2], y[3], -c[0], -c[1]}, jet_sine(&jet)};
}

static void midpoint(const struct gd__scheme *rules, const struct gd__patch *patch,
                     const double from[4], const struct slope *first, double step, int parts,
                     double out[4])
{
    double h = step / parts, before[4], now[4];
    for (int i = 0; i < 4; i++) {
        before[i] = from[i];
        now[i] = from[i] + h * first->v[i];
    }
    for (int n = 1; n <= parts; n++) {
        struct slope slope = flow_slope_at(rules, patch, now);
        for (int i = 0; i < 4; i++) {
            double next = n < parts ? before[i] + 2 * h * slope.v[i]
                                    : (before[i] + now[i] + h * slope.v[i]) / 2;
            before[i] = now[i];
            now[i] = next;
        }
    }
    for (int i = 0; i < 4; i++) out[i] = now[i];
}

enum { COLUMNS = 8 };

/* Returns the largest difference of two states: of places relative to the patch, of velocities
 * relative to the speed. */
static double flow_difference(const double a[4], const double b[4])
{
    double speed = fmax(fabs(a[2]), fabs(a[3]));
    double places = fmax(fabs(a[0] - b[0]), fabs(a[1] - b[1]));
    return fmax(places, fmax(fabs(a[2] - b[2]), fabs(a[3] - b[3])) / speed);
}

/* Moves along the geodesic by the arc length `step`. Returns false if the error exceeds
 * GD_TOL_GEODESIC divided by the sine of the angle between the derivatives. The caller must then
 * try a shorter step. */
static bool flow_advance(const struct gd__scheme *rules, const struct gd__patch *patch,
                         const struct flow_state *from, double step, struct flow_state *out)
{
    double start[4] = {from->s, from->t, from->ds, from->dt}, row[COLUMNS][4];
    struct slope first = flow_slope_at(rules, patch, start);
    for (int k = 0; k < COLUMNS; k++) {
        double last[4];
        midpoint(rules, patch, start, &first, step, 2 * (k + 1), row[k]);
        for (int i = 0; i < 4; i++) last[i] = k ? row[0][i] : 0;
        /* Neville's scheme: row[j] becomes the extrapolation of columns j to k */
        for (int j = k - 1; j >= 0; j--) {
            double ratio = (double)(k + 1) / (j + 1), weight = 1 / (ratio * ratio - 1);
            for (int i = 0; i < 4; i++)
                row[j][i] = row[j + 1][i] + weight * (row[j + 1][i] - row[j][i]);
        }
        if (k > 1 && flow_difference(row[0], last) * first.sine <= GD_TOL_GEODESIC) {
            *out = (struct flow_state){row[0][0], row[0][1], row[0][2], row[0][3]};
            return true;
        }
    }
    return false;
}

static const struct gd__scheme *rules_of(const struct gd__tracer *tracer)
{
    return tracer->walker->surface->rules;
}

/* Moves a state that lies on line k up to rounding exactly onto this line. */
static void tracer_settle(uint32_t arity, uint32_t k, struct flow_state *flow)
{
    double at[2], m = gd__along_side(arity, k, flow->s, flow->t);
    gd__place_on_side(arity, k, m, at);
    flow->s = at[0], flow->t = at[1];
}

/* Returns the tracer's state in the piece's coordinates. A place within the slack of the piece's
 * border is moved onto the border. The velocity is computed from the direction in space at the
 * moved place. This matters near vertices: the base face's coordinates are imprecise there, and the
 * derivatives turn within a small piece as much as within a large one. */
static struct flow_state flow_in(const struct gd__tracer *tracer)
{
    const struct gd__scheme *rules = rules_of(tracer);
    const struct gd__cell *piece = &tracer->walker->piece;
    struct gd__jet jet;
    double at[2], move[2] = {NAN, NAN};
    gd__chart_in(&piece->frame, tracer->local.s, tracer->local.t, at);
    struct flow_state flow = {.s = at[0], .t = at[1]};
    for (uint32_t k = 0; k < rules->arity; k++) {
        if (fabs(gd__line_at(rules->arity, k, flow.s, flow.t)) <= piece->slack)
            tracer_settle(rules->arity, k, &flow);
    }
    rules->evaluate(&piece->patch, flow.s, flow.t, &jet);
    (void)components_of(&jet, tracer->direction, move);
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

static void flow_out(struct gd__tracer *tracer, const struct flow_state *flow)
{
    struct gd__chart frame = tracer->walker->piece.frame;
    double at[2], move[2];
    gd__chart_out(&frame, flow->s, flow->t, at);
    frame.origin[0] = frame.origin[1] = 0;
    gd__chart_out(&frame, flow->ds, flow->dt, move);
    tracer->local.s = at[0], tracer->local.t = at[1];
    tracer->ds = move[0], tracer->dt = move[1];
    /* Uses the piece's own coordinates. Near the corners other than (0,0), the coordinates of the
     * base face are too imprecise for derivatives. */
    struct gd__jet jet;
    rules_of(tracer)->evaluate(&tracer->walker->piece.patch, flow->s, flow->t, &jet);
    tracer->position = gd_vec3_add(jet.p, tracer->walker->piece.origin);
    tracer->direction = gd_vec3_along(gd_vec3_scale(jet.s, flow->ds), flow->dt, jet.t);
    double length = gd_vec3_length(tracer->direction);
    tracer->direction = gd_vec3_scale(tracer->direction, 1 / length);
    tracer->ds = move[0] / length, tracer->dt = move[1] / length;
}

/* Ends the path at a place where the derivatives are parallel. There, "straight" is undefined. */
static enum gd_status end_here(struct gd__tracer *tracer)
{
    tracer->ended = true;
    tracer->end = GD_LIMIT_END_SINGULAR;
    return GD_OK;
}

/* Enters the piece at the current place, with the velocity in the direction of the unit vector
 * `direction`. */
static enum gd_status tracer_enter(struct gd__tracer *tracer, struct gd_vec3 direction)
{
    uint32_t corner;
    double c[2];
    if (!gd__cell_at(tracer->walker, &tracer->local, tracer->ds, tracer->dt, &corner))
        return gd__tracer_leave_vertex(tracer, tracer->local.face, corner, direction);
    struct gd__jet jet = gd__cell_jet(tracer->walker, tracer->local.s, tracer->local.t);
    tracer->position = jet.p;
    if (!components_of(&jet, direction, c)) return end_here(tracer);
    tracer->ds = c[0], tracer->dt = c[1];
    struct gd_vec3 vector = gd_vec3_along(gd_vec3_scale(jet.s, c[0]), c[1], jet.t);
    if (!(gd_vec3_length(vector) > GD_TOL_INPUT * gd_vec3_length(direction)))
        return GD_INVALID_ARGUMENT;
    set_direction(tracer, vector);
    return GD_OK;
}

enum gd_status gd__tracer_start(struct gd__tracer *tracer, struct gd__walker *walker,
                                const struct gd__face_place *local, struct gd_vec3 direction)
{
    *tracer = (struct gd__tracer){.walker = walker, .local = *local, .direction = direction};
    enum gd_status status = tracer_enter(tracer, direction);
    /* This second call selects the piece. The velocity decides which of several adjacent pieces the
       path enters, and it is known only now. */
    if (!status && !tracer->ended && walker->piece.face != GD_NONE)
        status = tracer_enter(tracer, tracer->direction);
    tracer->under_way = true;
    return status;
}

/* Returns the side of the base face that the path is about to cross, or GD_NONE if there is
 * none. */
static uint32_t side_ahead(const struct gd__tracer *tracer)
{
    uint32_t arity = rules_of(tracer)->arity, found = GD_NONE;
    double steepest = 0, speed = fmax(fabs(tracer->ds), fabs(tracer->dt));
    for (uint32_t k = 0; k < arity; k++) {
        double slope = gd__line_slope(arity, k, tracer->ds, tracer->dt) / speed;
        if (gd__line_at(arity, k, tracer->local.s, tracer->local.t) > GD_TOL_PATCH ||
            slope >= steepest)
            continue;
        if (slope > -GD_TOL_PATCH) continue;
        steepest = slope;
        found = k;
    }
    return found;
}

/* Computes the unit vector along side k, and the unit normal. */
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

/* Crosses side k into the next face. To select the piece in the next face, uses a velocity that has
 * the same component along the side, and points inwards. */
static enum gd_status cross_side(struct gd__tracer *tracer, uint32_t k)
{
    const struct gd__net *base = &tracer->walker->surface->base;
    uint32_t arity = base->arity, twin = base->twin[arity * tracer->local.face + k];
    if (twin == GD_NONE) {
        tracer->ended = true;
        tracer->end = GD_LIMIT_END_BOUNDARY;
        return GD_OK;
    }
    struct gd_vec3 along, normal, next_along, next_normal;
    struct gd__jet jet = gd__cell_jet(tracer->walker, tracer->local.s, tracer->local.t);
    if (!side_axes(&jet, arity, k, &along, &normal)) return end_here(tracer);
    double x = gd_vec3_dot(tracer->direction, along);
    double y = gd_vec3_dot(tracer->direction, gd_vec3_cross(along, normal));

    double m = 1 - gd__along_side(arity, k, tracer->local.s, tracer->local.t), a[2], b[2], in[2];
    uint32_t other = twin % arity, corner;
    tracer->local.face = twin / arity;
    gd__place_on_side(arity, other, m, in);
    gd__place_on_side(arity, other, 0, a);
    gd__place_on_side(arity, other, 1, b);
    tracer->local.s = in[0], tracer->local.t = in[1];
    /* (s, t) points along the side; rotated to the left, it points into the face */
    double s = b[0] - a[0], t = b[1] - a[1];
    if (!gd__cell_at(tracer->walker, &tracer->local, -x * s - y * t, -x * t + y * s, &corner))
        return gd__tracer_leave_vertex(tracer, tracer->local.face, corner, tracer->direction);
    /* across a smooth side the direction does not change */
    if (base->sharpness[twin] != INFINITY) return tracer_enter(tracer, tracer->direction);
    jet = gd__cell_jet(tracer->walker, in[0], in[1]);
    if (!side_axes(&jet, arity, other, &next_along, &next_normal)) return end_here(tracer);
    struct gd_vec3 inwards = gd_vec3_cross(next_normal, next_along);
    return tracer_enter(tracer, gd_vec3_along(gd_vec3_scale(next_along, -x), y, inwards));
}

/* Continues after a step that ended on the border of its piece. */
static enum gd_status hand_over(struct gd__tracer *tracer)
{
    uint32_t side = side_ahead(tracer);
    return side == GD_NONE ? tracer_enter(tracer, tracer->direction) : cross_side(tracer, side);
}

/* Returns the number of the side beyond whose line the state lies farthest, or GD_NONE if the state
 * is inside the domain. */
static uint32_t line_beyond(uint32_t arity, const struct flow_state *flow)
{
    uint32_t found = GD_NONE;
    double lowest = -GD_TOL_PATCH;
    for (uint32_t k = 0; k < arity; k++) {
        double height = gd__line_at(arity, k, flow->s, flow->t);
        if (height < lowest) lowest = height, found = k;
    }
    return found;
}

/* Returns true if the path crosses a line during a step and returns before its end. The height
 * above the line is interpolated by the cubic polynomial of its values and slopes at both ends. */
static bool makes_excursion(uint32_t arity, const struct flow_state *from,
                            const struct flow_state *end, double step)
{
    enum { PROBES = 16 };
    for (uint32_t k = 0; k < arity; k++) {
        double a = gd__line_at(arity, k, from->s, from->t),
               b = gd__line_at(arity, k, end->s, end->t),
               down = step * gd__line_slope(arity, k, from->ds, from->dt),
               up = step * gd__line_slope(arity, k, end->ds, end->dt);
        for (int i = 1; i < PROBES && b >= -GD_TOL_PATCH && down < 0 && up > 0; i++) {
            double x = (double)i / PROBES, y = 1 - x;
            if (y * y * (a * (1 + 2 * x) + down * x) + x * x * (b * (1 + 2 * y) - up * y) <
                -GD_TOL_PATCH)
                return true;
        }
    }
    return false;
}

/* Returns the step, in (0, step], at which the path crosses line k, by Newton's method within a
 * bracket. Sets *end to the state there. `from` must be on the inner side of the line. */
static double step_to_line(struct gd__tracer *tracer, const struct flow_state *from, double step,
                           uint32_t k, struct flow_state *end)
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
        if (!flow_advance(rules_of(tracer), &tracer->walker->piece.patch, from, at, end)) break;
    }
    return at;
}

/* Shortens a step that ends beyond the piece to its first crossing of the border. */
static double step_to_border(struct gd__tracer *tracer, const struct flow_state *from, double step,
                             struct flow_state *end, bool *at_border)
{
    uint32_t arity = rules_of(tracer)->arity, k;
    double least = GD_TOL_PATCH * step;
    *at_border = false;
    while ((k = line_beyond(arity, end)) != GD_NONE) {
        double height = gd__line_at(arity, k, from->s, from->t);
        *at_border = true;
        bool ahead = gd__line_slope(arity, k, from->ds, from->dt) > 0;
        /* the path leaves the piece at once */
        if (height <= GD_TOL_PATCH && !(ahead && step > least)) {
            *end = *from;
            tracer_settle(arity, k, end);
            return 0;
        }
        /* the path left the line and returned to it, so half of the step may still be inside */
        if (height <= GD_TOL_PATCH) {
            step /= 2;
            if (!flow_advance(rules_of(tracer), &tracer->walker->piece.patch, from, step, end))
                return 0;
            *at_border = false;
            continue;
        }
        step = step_to_line(tracer, from, step, k, end);
        tracer_settle(arity, k, end);
    }
    return step;
}

/* Continues through the vertex at the nearest corner of the base face, if the piece is small and
 * the path meets the vertex within `most`. Sets *met in that case. */
static enum gd_status meet_vertex(struct gd__tracer *tracer, double most, bool *met)
{
    const struct gd__cell *piece = &tracer->walker->piece;
    double scale = fabs(piece->frame.s[0]) + fabs(piece->frame.s[1]);
    *met = false;
    if (scale > ldexp(1, -10)) return GD_OK;
    uint32_t face = tracer->local.face;
    uint32_t corner = gd__nearest_corner(rules_of(tracer)->arity, tracer->local.s, tracer->local.t);
    struct gd__vertex vertex;
    gd__corner_limit(tracer->walker, face, corner, &vertex);
    struct gd_vec3 way = gd_vec3_sub(vertex.position, tracer->position);
    double length = gd_vec3_length(way), width = length;
    /* the surface near the tip of a spike is thin, so a path there counts as a path along the
     * spike's axis, which meets the tip */
    if (isnan(vertex.normal.x)) {
        struct gd__jet jet = gd__cell_jet(tracer->walker, tracer->local.s, tracer->local.t);
        width *= jet_sine(&jet);
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
    struct flow_state from = flow_in(tracer), end;
    double speed = fmax(fabs(from.ds), fabs(from.dt)), step = fmin(most, 1 / speed);
    while (!flow_advance(rules, &tracer->walker->piece.patch, &from, step, &end) ||
           makes_excursion(rules->arity, &from, &end, step)) {
        step /= 2;
        if (!(step * speed > GD_TOL_PATCH)) return GD_INTERNAL;
    }
    step = step_to_border(tracer, &from, step, &end, &at_border);
    flow_out(tracer, &end);
    *length += step;
    return at_border ? hand_over(tracer) : GD_OK;
}
