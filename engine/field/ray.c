#include "field/ray.h"

#include "mesh/canonical.h"
#include "mesh/segment.h"

/* --- where it ends ---------------------------------------------------------------------------- */

bool gd__ray_has_arrived(const struct gd__trail *trail, uint32_t side, double x, double y,
                         uint32_t source)
{
    const struct gd_mesh *mesh = trail->mesh;
    const struct gd_side *s = &mesh->side[side];
    struct gd_point point = source < mesh->vertex_count
                                ? gd__point_of_vertex(source)
                                : trail->field->seeds[source - mesh->vertex_count].point;
    uint32_t face = mesh->side_face[side];
    int k = gd__place_of_side(mesh->face_side[face], side);
    double weight[3];
    if (point.kind == GD_POINT_FACE && point.element != face) return false;
    gd__point_weights(mesh, &point, face, weight);
    if (weight[0] + weight[1] + weight[2] == 0) return false;
    struct gd__local at = gd__face_local(
        mesh, side, (double[3]){weight[k], weight[(k + 1) % 3], weight[(k + 2) % 3]});
    double tolerance = GD_TOL_ARRIVED * (s->length + s->left_length);
    return fabs(at.x - x) <= tolerance && fabs(at.y - y) <= tolerance;
}

struct gd__stop gd__ray_arrive(struct gd__trail *trail, uint32_t face, uint32_t source)
{
    if (source < trail->mesh->vertex_count) {
        gd__trail_append_in_face(trail, gd__point_of_vertex(source), face);
        return gd__stop_at_vertex(source);
    }
    uint32_t seed = source - trail->mesh->vertex_count;
    gd__trail_append_seed(trail, seed, face);
    return gd__stop_at_seed(seed);
}

struct gd__stop gd__ray_arrive_at_chord(struct gd__trail *trail, uint32_t seed, uint32_t face)
{
    const struct gd_mesh *mesh = trail->mesh;
    const struct gd__seed *s = &trail->field->seeds[seed];
    struct gd__chord chord = gd__chord(mesh, face, 0, &s->point, &s->end);
    double weight[3], from[3], to[3];
    gd__point_weights(mesh, &trail->path.points[trail->path.count - 1], face, weight);
    double part = gd__chord_foot(&chord, gd__face_local(mesh, mesh->face_side[face][0], weight)) /
                  chord.length;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    gd__point_weights(mesh, &s->point, face, from);
    gd__point_weights(mesh, &s->end, face, to);
    for (int k = 0; k < 3; k++) weight[k] = (1 - part) * from[k] + part * to[k];
    gd__trail_append_in_face(trail, gd__point_of_face(mesh, face, weight), face);
    return gd__stop_at_seed(seed);
}

/* --- from face to face ------------------------------------------------------------------------ */

/* How a ray left a face: by an edge of that length, on a segment of that length, which is measured
 * in the face's frame. */
struct passage {
    double edge, segment;
};

/* What is done for a ray to a point and to a segment alike. */
#define BOTH_KINDS static inline __attribute__((always_inline))

/* The same ray in the face across its side: there its source is above, at (x, y). */
BOTH_KINDS void enter_face(const struct gd_side *s, struct gd__ray *ray, bool linear)
{
    ray->side ^= 1;
    ray->t = s->length - ray->t;
    ray->x = linear ? -ray->x : s->length - ray->x;
}

/* A ray that has entered the face of its side becomes one of the side by which it leaves: of the
 * edge to the left, from the origin to the apex, or of the one to the right, from the apex to the
 * destination. (ux, uy) runs along it, (rx, ry) from its end to the source. */
BOTH_KINDS void cross_face(const struct gd_side *s, struct gd__ray *ray, struct passage *passage,
                           bool linear)
{
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y; /* apex */
    double t = ray->t, dx = linear ? ray->x : ray->x - t, dy = ray->y, along, ux, uy, rx, ry, sx,
           sy;
    if ((px - t) * dy - py * dx > 0) {
        ux = s->left_x, uy = s->left_y, rx = linear ? dx : ray->x - px,
        ry = linear ? dy : ray->y - py;
        along = dy * t / (dy * ux - dx * uy);
        sx = along * ux - t, sy = along * uy;
        ray->side = s->left ^ 1;
        passage->edge = s->left_length;
    } else {
        ux = s->right_x, uy = s->right_y, rx = linear ? dx : ray->x - s->length, ry = ray->y;
        along = (dx * py - dy * (px - t)) / (dy * ux - dx * uy);
        sx = px + along * ux - t, sy = py + along * uy;
        ray->side = s->right ^ 1;
        passage->edge = s->right_length;
    }
    ray->t = passage->edge - along;
    ray->x = -(rx * ux + ry * uy);
    double y = ux * ry - uy * rx;
    ray->y = y > 0 ? y : 0; /* fmax would be a call, and all of the above put aside for it */
    passage->segment = sqrt(sx * sx + sy * sy);
}

/* Appends where a ray crosses from face to face; false where that is at the edge's end, up to
 * snapping, or at the border, or without memory. `next` is the side by which it enters. */
static inline bool append_crossing(struct gd__trail *trail, const struct gd_side *next,
                                   const struct gd__ray *ray, const struct passage *passage)
{
    double snap = trail->snap;
    if (ray->t <= snap * passage->edge || ray->t >= (1 - snap) * passage->edge) return false;
    if (next->left == GD_NONE || !gd__trail_reserve(trail)) return false;
    double weight = ray->t / passage->edge;
    const double weights[2] = {weight, 1 - weight}; /* a branch would be wrong half the time */
    struct gd_point *point = &trail->path.points[trail->path.count++];
    point->kind = GD_POINT_EDGE;
    point->element = ray->side >> 1;
    point->weight[0] = weights[ray->side & 1];
    point->weight[1] = weights[~ray->side & 1];
    point->weight[2] = 0;
    trail->path.length += passage->segment;
    return true;
}

/* Where a ray leaves its face by a side. No path leaves the surface: a ray that seems to, passes an
 * end of the boundary edge within rounding. */
static struct gd_point crossing_of(const struct gd__trail *trail, const struct gd__ray *ray)
{
    const struct gd_mesh *mesh = trail->mesh;
    if (!gd__side_is_boundary(mesh, ray->side ^ 1))
        return gd__trail_side_point(trail, ray->side, ray->t);
    bool at_origin = ray->t < 0.5 * mesh->side[ray->side].length;
    return gd__point_of_vertex(mesh->origin[at_origin ? ray->side : ray->side ^ 1]);
}

/* Appends where a ray comes to, be it a vertex. */
static struct gd_point append_end(struct gd__trail *trail, struct gd__ray ray)
{
    struct gd_point point = crossing_of(trail, &ray);
    gd__trail_append_in_face(trail, point, trail->mesh->side_face[ray.side]);
    return point;
}

/* Is the source's image low enough to be in the face, so that it is worth a closer look? */
static inline bool may_have_arrived(const struct gd_side *s, double y)
{
    return y <= s->left_length * s->left_y + GD_TOL_ARRIVED * (s->length + s->left_length);
}

/* Follows a ray from face to face until it reaches its source or passes through a vertex. Of each
 * face it reads one record, which it asks for as soon as the one before is there. */
static struct gd__stop follow_to_point(struct gd__trail *trail, struct gd__ray ray)
{
    const struct gd_mesh *mesh = trail->mesh;
    struct gd_point first = append_end(trail, ray);
    if (trail->status) return gd__stop_failed(trail, trail->status);
    if (first.kind == GD_POINT_VERTEX) return gd__stop_at(first);
    const struct gd_side *s = &mesh->side[ray.side ^ 1];
    while (trail->steps_left--) {
        struct passage passage;
        __builtin_prefetch(&mesh->side[s->left]);
        __builtin_prefetch(&mesh->side[s->right]);
        enter_face(s, &ray, false);
        if (may_have_arrived(s, ray.y) &&
            gd__ray_has_arrived(trail, ray.side, ray.x, ray.y, ray.source))
            return gd__ray_arrive(trail, mesh->side_face[ray.side], ray.source);
        cross_face(s, &ray, &passage, false);
        s = &mesh->side[ray.side ^ 1];
        if (!append_crossing(trail, s, &ray, &passage)) return gd__stop_at(append_end(trail, ray));
    }
    return gd__stop_failed(trail, GD_INTERNAL);
}

/* --- carefully -------------------------------------------------------------------------------- */

/* The error of a ray grows with the length of its leg, not with the size of the face that it
 * crosses. In faces much smaller than the leg, rounding can take the ray past the wrong side of a
 * vertex, or past its source. A careful ray passes through such a vertex instead: the detour is of
 * second order, and the predecessor of the vertex is as exact as the vertex is near to the source. */

/* The vertex within the margin of the crossing at which a ray leaves its face, or GD_NONE. The
 * crossing is `gone` behind the leg's beginning and `rest` before its source. Each vertex must be
 * nearer to the source than the one before: faces can be smaller than the rounding of distances,
 * and there the path would turn in a circle. */
static uint32_t vertex_beside(const struct gd__trail *trail, const struct gd__ray *ray, double gone,
                              double rest)
{
    const struct gd_mesh *mesh = trail->mesh;
    double edge = mesh->side[ray->side].length, aside = trail->aside;
    double margin = aside * fmin(gone, rest) + fmin(aside, GD_TOL_ASIDE_END) * edge +
                    GD_TOL_ASIDE_NOISE * trail->nearest;
    bool at_origin = ray->t < 0.5 * edge;
    uint32_t vertex = mesh->origin[at_origin ? ray->side : ray->side ^ 1];
    if ((at_origin ? ray->t : edge - ray->t) > margin) return GD_NONE;
    return trail->field->distance[vertex] < trail->nearest ? vertex : GD_NONE;
}

/* A vertex that no window has reached, or that the leg's own vertex has given its distance along
 * their edge (field.c): a leg that ends there would turn in a circle, or not go on. */
static bool leads_back(const struct gd__trail *trail, const struct gd_point *at)
{
    if (at->kind != GD_POINT_VERTEX) return false;
    if (trail->field->distance[at->element] >= GD__FAR) return true;
    if (trail->vertex == GD_NONE) return false;
    const struct gd__predecessor *predecessor = &trail->field->predecessor[at->element];
    return at->element == trail->vertex ||
           (predecessor->side == GD_NONE && predecessor->source == trail->vertex);
}

/* Appends the point at which a careful ray leaves its face. *is_end: the leg ends there, at a
 * vertex or so close to the source that a new leg from there is more exact. */
static struct gd_point append_carefully(struct gd__trail *trail, const struct gd__ray *ray,
                                        double begun, bool *is_end)
{
    uint32_t face = trail->mesh->side_face[ray->side];
    struct gd_point at = crossing_of(trail, ray);
    if (leads_back(trail, &at) && !gd__side_is_boundary(trail->mesh, ray->side ^ 1)) {
        double part = ray->t / trail->mesh->side[ray->side].length;
        at = gd__point_within_side(ray->side, fmin(fmax(part, GD_TOL_WIDTH), 1 - GD_TOL_WIDTH));
    }
    double gone = trail->path.length - begun + gd__trail_run(trail, &at, face),
           rest = hypot(ray->x - ray->t, ray->y);
    if (gd__source_is_linear(ray->source))
        rest = trail->nearest -
               trail->field->seeds[gd__field_seed_of(trail->field, ray->source)].offset - gone;
    uint32_t vertex = vertex_beside(trail, ray, gone, rest);
    if (vertex != GD_NONE) at = gd__point_of_vertex(vertex);
    gd__trail_append_in_face(trail, at, face);
    *is_end = at.kind == GD_POINT_VERTEX || rest < GD_TOL_ANEW * gone;
    return at;
}

/* The edge or the face of the segment that is the source; both GD_NONE of a point. */
static bool find_home(const struct gd__trail *trail, uint32_t source, struct gd__home *home)
{
    *home = (struct gd__home){.edge = GD_NONE, .face = GD_NONE};
    if (!gd__source_is_linear(source)) return true;
    const struct gd__seed *s = &trail->field->seeds[gd__field_seed_of(trail->field, source)];
    return gd__segment_home(trail->mesh, &s->point, &s->end, home);
}

/* Follows a careful ray, or any ray to a segment. A ray meets its segment at right angles, on an
 * edge that it reaches or in a face that it enters. */
static struct gd__stop follow_slowly(struct gd__trail *trail, struct gd__ray ray)
{
    const struct gd_mesh *mesh = trail->mesh;
    double begun = trail->path.length;
    bool linear = gd__source_is_linear(ray.source);
    struct gd__home home;
    if (!find_home(trail, ray.source, &home)) return gd__stop_failed(trail, GD_INTERNAL);
    uint32_t seed = linear ? gd__field_seed_of(trail->field, ray.source) : GD_NONE;
    while (trail->steps_left-- && !trail->status) {
        const struct gd_side *across = &mesh->side[ray.side ^ 1];
        struct passage passage;
        bool is_end = false;
        if (ray.side >> 1 == home.edge)
            return gd__ray_arrive_at_chord(trail, seed, mesh->side_face[ray.side]);
        struct gd_point at = trail->aside > 0 ? append_carefully(trail, &ray, begun, &is_end)
                                              : append_end(trail, ray);
        if (is_end || at.kind == GD_POINT_VERTEX) return gd__stop_at(at);
        enter_face(across, &ray, linear);
        if (linear && mesh->side_face[ray.side] == home.face)
            return gd__ray_arrive_at_chord(trail, seed, home.face);
        if (!linear && gd__ray_has_arrived(trail, ray.side, ray.x, ray.y, ray.source))
            return gd__ray_arrive(trail, mesh->side_face[ray.side], ray.source);
        cross_face(across, &ray, &passage, linear);
    }
    return gd__stop_failed(trail, GD_INTERNAL);
}

struct gd__stop gd__ray_follow(struct gd__trail *trail, struct gd__ray ray)
{
    bool slowly = trail->aside > 0 || gd__source_is_linear(ray.source);
    return slowly ? follow_slowly(trail, ray) : follow_to_point(trail, ray);
}
