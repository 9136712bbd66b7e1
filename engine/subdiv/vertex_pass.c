/* A geodesic from a vertex that no patch contains. */
#include "subdiv/tracer.h"

#include <math.h>

#include "base/tolerance.h"

/* How far `direction` is inside of the corner of a face, by the sine of the angle to the nearer edge; below 0: outside. */
static double inside_by(const struct gd__vertex *vertex, struct gd_vec3 direction)
{
    double left = gd_vec3_dot(gd_vec3_cross(vertex->s, direction), vertex->normal);
    double right = gd_vec3_dot(gd_vec3_cross(direction, vertex->t), vertex->normal);
    return fmin(left, right);
}

/* Whether the surface is smooth at the vertex: inside, and no crease meets it. */
static bool is_smooth(const struct gd__net *base, const struct gd__fan *fan)
{
    if (!fan->closed || base->corner[base->origin[fan->sides[0]]] > 0) return false;
    for (uint32_t i = 0; i < fan->count; i++) {
        if (gd__spoke_sharpness(base, fan, i) > 0) return false;
    }
    return true;
}

/* The side that begins at the vertex, in the face into which the direction leads. */
static enum gd_status side_towards(struct gd__walker *walker, uint32_t side, struct gd_vec3 direction, uint32_t *found)
{
    const struct gd__net *base = &walker->surface->base;
    double best = -INFINITY;
    uint32_t at = side;
    do {
        struct gd__vertex vertex;
        enum gd_status status = gd__corner_limit(walker, at / base->arity, at % base->arity, &vertex);
        if (status) return status;
        double inside = inside_by(&vertex, direction);
        if (inside > best) best = inside, *found = at;
        at = base->twin[gd__side_previous(base, at)];
    } while (at != side);
    return GD_OK;
}

/* The spot at `reach` and `angle` from a corner, in the corner's own axes. */
static struct gd__spot spot_near(const struct gd__walker *walker, uint32_t side, double reach, double angle)
{
    const struct gd__scheme *rules = walker->surface->rules;
    struct gd__chart whole = GD__CHART_WHOLE, frame = gd__chart_child(&whole, &rules->children[side % rules->arity]);
    double at[2], c = cos(angle), s = sin(angle);
    gd__chart_out(&frame, 2 * reach * c / (c + s), 2 * reach * s / (c + s), at);
    return (struct gd__spot){side / rules->arity, at[0], at[1]};
}

static struct gd_vec3 position_at(struct gd__walker *walker, const struct gd__spot *spot)
{
    uint32_t corner;
    if (!gd__cell_at(walker, spot, 0, 0, &corner)) return (struct gd_vec3){NAN, NAN, NAN};
    return gd__cell_jet(walker, spot->s, spot->t).p;
}

/* The spot at `reach` that is seen from the vertex in the direction: bisection over the angle. */
static struct gd__spot spot_towards(struct gd__walker *walker, uint32_t side, const struct gd__vertex *vertex,
                                    double reach, struct gd_vec3 direction)
{
    double low = 0, high = M_PI / 2;
    for (int i = 0; i < 50; i++) {
        double middle = (low + high) / 2;
        struct gd__spot spot = spot_near(walker, side, reach, middle);
        struct gd_vec3 way = gd_vec3_sub(position_at(walker, &spot), vertex->position);
        bool before = gd_vec3_dot(gd_vec3_cross(way, direction), vertex->normal) > 0;
        *(before ? &low : &high) = middle;
    }
    return spot_near(walker, side, reach, (low + high) / 2);
}

enum gd_status gd__tracer_leave_vertex(struct gd__tracer *tracer, uint32_t face, uint32_t corner,
                                       struct gd_vec3 direction)
{
    struct gd__walker *walker = tracer->walker;
    const struct gd__net *base = &walker->surface->base;
    uint32_t side = base->arity * face + corner, towards = side;
    struct gd__vertex vertex;
    enum gd_status status = gd__corner_limit(walker, face, corner, &vertex);
    if (status) return status;
    tracer->position = vertex.position;
    gd__fan_around(base, side, &walker->fan);
    if (!is_smooth(base, &walker->fan)) {
        tracer->ended = true;
        tracer->end = GD_LIMIT_END_SINGULAR;
        return GD_OK;
    }
    direction = gd_vec3_along(direction, -gd_vec3_dot(direction, vertex.normal), vertex.normal);
    double length = gd_vec3_length(direction);
    if (!(length > 0)) return GD_INVALID_ARGUMENT;
    direction = gd_vec3_scale(direction, 1 / length);
    status = side_towards(walker, side, direction, &towards);
    if (status) return status;
    /* so near that the surface is flat, but no nearer than coordinates can tell */
    double reach = ldexp(1, -10), far = 0;
    do {
        reach /= 2;
        struct gd__spot spot = spot_near(walker, towards, reach, M_PI / 4);
        far = gd_vec3_distance(position_at(walker, &spot), vertex.position);
    } while (far > GD_TOL_VERTEX * walker->surface->size && reach > ldexp(1, -40));
    struct gd__spot spot = spot_towards(walker, towards, &vertex, reach, direction);
    double skipped = tracer->skipped + gd_vec3_distance(position_at(walker, &spot), vertex.position);
    status = gd__tracer_start(tracer, walker, &spot, direction);
    tracer->skipped = skipped;
    return status;
}
