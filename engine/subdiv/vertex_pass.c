/* Continues a geodesic from a vertex that no patch contains. */
#include "subdiv/tracer.h"

#include <math.h>

#include "base/tolerance.h"
#include "subdiv/domain.h"

/* Returns the sine of the angle between `direction` and the nearer edge at the corner of a face. It
 * is positive if the direction leads into the face, and negative otherwise. */
static double inside_by(const struct gd__vertex *vertex, struct gd_vec3 direction)
{
    double left = gd_vec3_dot(gd_vec3_cross(vertex->s, direction), vertex->normal);
    double right = gd_vec3_dot(gd_vec3_cross(direction, vertex->t), vertex->normal);
    return fmin(left, right);
}

/* Returns true if the surface is smooth at the vertex: an interior vertex that is not an infinitely
 * sharp corner or on an infinitely sharp crease. */
static bool is_smooth(const struct gd__net *base, const struct gd__fan *fan)
{
    if (!fan->closed || base->corner[base->origin[fan->sides[0]]] == INFINITY) return false;
    for (uint32_t i = 0; i < fan->count; i++) {
        if (gd__spoke_sharpness(base, fan, i) == INFINITY) return false;
    }
    return true;
}

/* Returns the side where the sector of `side` begins, at the next crease clockwise of `side`. If
 * there are no creases, returns `side`. */
static uint32_t sector_begin(const struct gd__net *base, uint32_t side)
{
    uint32_t at = side;
    while (base->sharpness[at] != INFINITY) {
        at = gd__net_next(base, base->twin[at]);
        if (at == side) break;
    }
    return at;
}

/* Among the faces of the side's sector at the vertex, finds the face with the largest inside_by for
 * the direction. Returns the side of this face that begins at the vertex, and sets *best to
 * inside_by. */
static uint32_t side_towards(struct gd__walker *walker, uint32_t side, struct gd_vec3 direction,
                             double *best)
{
    const struct gd__net *base = &walker->surface->base;
    uint32_t begin = sector_begin(base, side), at = begin, found = begin, before;
    *best = -INFINITY;
    do {
        struct gd__vertex vertex;
        gd__corner_limit(walker, at / base->arity, at % base->arity, &vertex);
        double inside = inside_by(&vertex, direction);
        if (inside > *best) *best = inside, found = at;
        before = gd__net_previous(base, at);
        at = base->twin[before];
    } while (at != begin && base->sharpness[before] != INFINITY);
    return found;
}

/* Returns side_towards for a path that continues from the vertex, or GD_NONE if "straight" is
 * undefined. Creases and corners have a tangent plane in each sector, so a path may begin there,
 * but no path passes through them. */
static uint32_t way_on(struct gd__tracer *tracer, uint32_t side, struct gd_vec3 direction)
{
    struct gd__walker *walker = tracer->walker;
    const struct gd__net *base = &walker->surface->base;
    double inside;
    gd__fan_around(base, side, &walker->fan);
    bool smooth = is_smooth(base, &walker->fan), closed = walker->fan.closed;
    tracer->end = tracer->under_way || closed ? GD_LIMIT_END_SINGULAR : GD_LIMIT_END_BOUNDARY;
    if (!smooth && tracer->under_way) return GD_NONE;
    uint32_t towards = side_towards(walker, side, direction, &inside);
    return smooth || inside >= -GD_TOL_INPUT ? towards : GD_NONE;
}

/* Returns the place at the distance `reach` from a corner, in the direction `angle` measured in the
 * corner's own axes. */
static struct gd__face_place spot_near(const struct gd__walker *walker, uint32_t side, double reach,
                                       double angle)
{
    const struct gd__scheme *rules = walker->surface->rules;
    struct gd__chart whole = GD__CHART_WHOLE,
                     frame = gd__chart_child(&whole, &rules->children[side % rules->arity]);
    double at[2], c = cos(angle), s = sin(angle);
    gd__chart_out(&frame, 2 * reach * c / (c + s), 2 * reach * s / (c + s), at);
    return (struct gd__face_place){side / rules->arity, at[0], at[1]};
}

static struct gd_vec3 position_at(struct gd__walker *walker, const struct gd__face_place *local)
{
    uint32_t corner;
    if (!gd__cell_at(walker, local, 0, 0, &corner)) return (struct gd_vec3){NAN, NAN, NAN};
    return gd__cell_jet(walker, local->s, local->t).p;
}

/* Returns the place at the distance `reach` that lies in the given direction from the vertex, by
 * bisection over the angle. */
static struct gd__face_place spot_towards(struct gd__walker *walker, uint32_t side,
                                          const struct gd__vertex *vertex, double reach,
                                          struct gd_vec3 direction)
{
    double low = 0, high = M_PI / 2;
    for (int i = 0; i < 50; i++) {
        double middle = (low + high) / 2;
        struct gd__face_place local = spot_near(walker, side, reach, middle);
        struct gd_vec3 way = gd_vec3_sub(position_at(walker, &local), vertex->position);
        bool before = gd_vec3_dot(gd_vec3_cross(way, direction), vertex->normal) > 0;
        *(before ? &low : &high) = middle;
    }
    return spot_near(walker, side, reach, (low + high) / 2);
}

/* Returns a distance from the vertex within which the surface is nearly flat, at least the
 * resolution of the coordinates. */
static double reach_from(struct gd__walker *walker, uint32_t side, const struct gd__vertex *vertex)
{
    double reach = ldexp(1, -10), far = 0;
    do {
        reach /= 2;
        struct gd__face_place local = spot_near(walker, side, reach, M_PI / 4);
        far = gd_vec3_distance(position_at(walker, &local), vertex->position);
    } while (far > GD_TOL_VERTEX * walker->surface->size && reach > ldexp(1, -40));
    return reach;
}

enum gd_status gd__tracer_leave_vertex(struct gd__tracer *tracer, uint32_t face, uint32_t corner,
                                       struct gd_vec3 direction)
{
    struct gd__walker *walker = tracer->walker;
    uint32_t side = walker->surface->base.arity * face + corner, towards = GD_NONE;
    struct gd__vertex vertex;
    double at[2];
    gd__corner_limit(walker, face, corner, &vertex);
    gd__place_on_side(walker->surface->base.arity, corner, 0, at);
    tracer->local = (struct gd__face_place){face, at[0], at[1]};
    tracer->position = vertex.position;
    tracer->end = GD_LIMIT_END_SINGULAR;
    if (!isnan(vertex.normal.x)) {
        direction = gd_vec3_along(direction, -gd_vec3_dot(direction, vertex.normal), vertex.normal);
        double length = gd_vec3_length(direction);
        if (!(length > GD_TOL_INPUT)) return GD_INVALID_ARGUMENT;
        direction = gd_vec3_scale(direction, 1 / length);
        towards = way_on(tracer, side, direction);
    }
    if (towards == GD_NONE) {
        tracer->ended = true;
        return GD_OK;
    }
    double reach = reach_from(walker, towards, &vertex);
    struct gd__face_place local = spot_towards(walker, towards, &vertex, reach, direction);
    double skipped =
        tracer->skipped + gd_vec3_distance(position_at(walker, &local), vertex.position);
    enum gd_status status = gd__tracer_start(tracer, walker, &local, direction);
    tracer->skipped = skipped;
    return status;
}
