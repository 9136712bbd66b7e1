#include "field/ray.h"

#include "mesh/canonical.h"
#include "mesh/segment.h"

/* --- arrival ---------------------------------------------------------------------------------- */

bool gd__ray_has_arrived(const struct gd__path_builder *builder, uint32_t side, double x, double y,
                         uint32_t source)
{
    const struct gd_mesh *mesh = builder->mesh;
    const struct gd_side *s = &mesh->side[side];
    struct gd_point point = source < mesh->vertex_count
                                ? gd__point_of_vertex(source)
                                : builder->field->seeds[source - mesh->vertex_count].point;
    uint32_t face = mesh->side_face[side];
    int k = gd__place_of_side(mesh->face_side[face], side);
    double weight[3];
    if (point.kind == GD_POINT_FACE && point.element != face) return false;
    gd__point_weights(mesh, &point, face, weight);
    if (weight[0] + weight[1] + weight[2] == 0) return false;
    struct gd__local at = gd__side_local(s, weight[(k + 1) % 3], weight[(k + 2) % 3]);
    double tolerance = GD_TOL_ARRIVED * (s->length + s->left_length);
    return fabs(at.x - x) <= tolerance && fabs(at.y - y) <= tolerance;
}

struct gd__stop gd__ray_arrive(struct gd__path_builder *builder, uint32_t face, uint32_t source)
{
    if (source < builder->mesh->vertex_count) {
        gd__path_builder_append_in_face(builder, gd__point_of_vertex(source), face);
        return gd__stop_at_vertex(source);
    }
    uint32_t seed = source - builder->mesh->vertex_count;
    gd__path_builder_append_seed(builder, seed, face);
    return gd__stop_at_seed(seed);
}

struct gd__stop gd__ray_arrive_at_chord(struct gd__path_builder *builder, uint32_t seed,
                                        uint32_t face)
{
    const struct gd_mesh *mesh = builder->mesh;
    const struct gd__seed *s = &builder->field->seeds[seed];
    struct gd__chord chord = gd__chord(mesh, face, 0, &s->point, &s->end);
    const struct gd_point *last = &builder->path.points[builder->path.count - 1];
    double weight[3], from[3], to[3],
        part = gd__chord_foot(&chord, gd__point_local(mesh, face, last)) / chord.length;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    gd__point_weights(mesh, &s->point, face, from);
    gd__point_weights(mesh, &s->end, face, to);
    for (int k = 0; k < 3; k++) weight[k] = (1 - part) * from[k] + part * to[k];
    gd__path_builder_append_in_face(builder, gd__point_of_face(mesh, face, weight), face);
    return gd__stop_at_seed(seed);
}

/* --- from face to face ------------------------------------------------------------------------ */

/* Describes how a ray left a face, by the lengths of the crossed edge and of the ray's segment in
 * the face. */
struct passage {
    double edge, segment;
};

/* Marks functions that are compiled twice: for rays to points and for rays to segments. */
#define BOTH_KINDS static inline __attribute__((always_inline))

/* Transforms a ray to the face across its side, where its source is above the side, at (x, y). */
BOTH_KINDS void enter_face(const struct gd_side *s, struct gd__ray *ray, bool linear)
{
    ray->side ^= 1;
    ray->t = s->length - ray->t;
    ray->x = linear ? -ray->x : s->length - ray->x;
}

/* A ray has entered the face of its side. Transforms it to the side where it leaves the face. This
 * is the left edge, from the origin to the apex, or the right edge, from the apex to the
 * destination. The vector (ux, uy) runs along that edge. The vector (rx, ry) runs from the edge's
 * end to the source. */
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
    ray->y = y > 0 ? y : 0; /* not fmax, because a function call would spill all registers */
    passage->segment = sqrt(sx * sx + sy * sy);
}

/* Appends the crossing of a ray into the next face, which it enters by the side `next`. Returns
 * false in three cases: the crossing is so near to an end of the edge that it must be moved there,
 * the edge is on the boundary, or memory is exhausted. */
static inline bool append_crossing(struct gd__path_builder *builder, const struct gd_side *next,
                                   const struct gd__ray *ray, const struct passage *passage)
{
    double snap = builder->snap;
    if (ray->t <= snap * passage->edge || ray->t >= (1 - snap) * passage->edge) return false;
    if (next->left == GD_NONE || !gd__path_builder_reserve(builder)) return false;
    double weight = ray->t / passage->edge;
    /* branchless, because a branch would be mispredicted half of the time */
    const double weights[2] = {weight, 1 - weight};
    struct gd_point *point = &builder->path.points[builder->path.count++];
    point->kind = GD_POINT_EDGE;
    point->element = ray->side >> 1;
    point->weight[0] = weights[ray->side & 1];
    point->weight[1] = weights[~ray->side & 1];
    point->weight[2] = 0;
    builder->path.length += passage->segment;
    return true;
}

/* Returns the point where a ray leaves its face by a side. No path leaves the surface: a ray that
 * seems to do so passes an end of the boundary edge within the rounding error. */
static struct gd_point crossing_of(const struct gd__path_builder *builder,
                                   const struct gd__ray *ray)
{
    const struct gd_mesh *mesh = builder->mesh;
    if (!gd__side_is_boundary(mesh, ray->side ^ 1))
        return gd__path_builder_side_point(builder, ray->side, ray->t);
    bool at_origin = ray->t < 0.5 * mesh->side[ray->side].length;
    return gd__point_of_vertex(mesh->origin[at_origin ? ray->side : ray->side ^ 1]);
}

/* Appends the point that a ray reaches, which may be a vertex. */
static struct gd_point append_end(struct gd__path_builder *builder, struct gd__ray ray)
{
    struct gd_point point = crossing_of(builder, &ray);
    gd__path_builder_append_in_face(builder, point, builder->mesh->side_face[ray.side]);
    return point;
}

/* Returns true if the source's image at height y may lie in the face. */
static inline bool may_have_arrived(const struct gd_side *s, double y)
{
    return y <= s->left_length * s->left_y + GD_TOL_ARRIVED * (s->length + s->left_length);
}

/* Follows a ray from face to face until it reaches its source or passes through a vertex. It reads
 * one record of each face and prefetches the next. */
static struct gd__stop follow_to_point(struct gd__path_builder *builder, struct gd__ray ray)
{
    const struct gd_mesh *mesh = builder->mesh;
    struct gd_point first = append_end(builder, ray);
    if (builder->status) return gd__stop_failed(builder, builder->status);
    if (first.kind == GD_POINT_VERTEX) return gd__stop_at(first);
    const struct gd_side *s = &mesh->side[ray.side ^ 1];
    while (builder->steps_left--) {
        struct passage passage;
        __builtin_prefetch(&mesh->side[s->left]);
        __builtin_prefetch(&mesh->side[s->right]);
        enter_face(s, &ray, false);
        if (may_have_arrived(s, ray.y) &&
            gd__ray_has_arrived(builder, ray.side, ray.x, ray.y, ray.source))
            return gd__ray_arrive(builder, mesh->side_face[ray.side], ray.source);
        cross_face(s, &ray, &passage, false);
        s = &mesh->side[ray.side ^ 1];
        if (!append_crossing(builder, s, &ray, &passage))
            return gd__stop_at(append_end(builder, ray));
    }
    return gd__stop_failed(builder, GD_INTERNAL);
}

/* --- careful rays ----------------------------------------------------------------------------- */

/* The error of a ray grows with the length of its leg, not with the size of the face. In faces much
 * smaller than the leg, rounding can move the ray to the wrong side of a vertex, or past its
 * source. A careful ray goes through every such vertex. The detour is of second order, and the
 * predecessor of the vertex is accurate because the vertex is near to the source. */

/* Returns the vertex within the margin of the crossing where a ray leaves its face, or GD_NONE.
 * `gone` is the length of the leg up to the crossing, `rest` the length from the crossing to the
 * source. Each vertex must be nearer to the source than the previous one; otherwise, in faces
 * smaller than the rounding error of distances, the path would run in a circle. */
static uint32_t vertex_beside(const struct gd__path_builder *builder, const struct gd__ray *ray,
                              double gone, double rest)
{
    const struct gd_mesh *mesh = builder->mesh;
    double edge = mesh->side[ray->side].length, aside = builder->aside;
    double margin = aside * fmin(gone, rest) + fmin(aside, GD_TOL_ASIDE_END) * edge +
                    GD_TOL_ASIDE_NOISE * builder->nearest;
    bool at_origin = ray->t < 0.5 * edge;
    uint32_t vertex = mesh->origin[at_origin ? ray->side : ray->side ^ 1];
    if ((at_origin ? ray->t : edge - ray->t) > margin) return GD_NONE;
    return builder->field->distance[vertex] < builder->nearest ? vertex : GD_NONE;
}

/* Returns true for a vertex that no window reached, or whose distance comes along an edge from the
 * leg's own vertex (field.c). From such a vertex the path would return to the same vertex, or could
 * not continue. */
static bool leads_back(const struct gd__path_builder *builder, const struct gd_point *at)
{
    if (at->kind != GD_POINT_VERTEX) return false;
    if (builder->field->distance[at->element] >= GD__FAR) return true;
    if (builder->vertex == GD_NONE) return false;
    const struct gd__predecessor *predecessor = &builder->field->predecessor[at->element];
    return at->element == builder->vertex ||
           (predecessor->side == GD_NONE && predecessor->source == builder->vertex);
}

/* Appends the point where a careful ray leaves its face. Sets *is_end if the leg ends there: at a
 * vertex, or so close to the source that a new leg from there is more accurate. */
static struct gd_point append_carefully(struct gd__path_builder *builder, const struct gd__ray *ray,
                                        double begun, bool *is_end)
{
    uint32_t face = builder->mesh->side_face[ray->side];
    struct gd_point at = crossing_of(builder, ray);
    if (leads_back(builder, &at) && !gd__side_is_boundary(builder->mesh, ray->side ^ 1)) {
        double part = ray->t / builder->mesh->side[ray->side].length;
        at = gd__point_within_side(ray->side, fmin(fmax(part, GD_TOL_WIDTH), 1 - GD_TOL_WIDTH));
    }
    double gone = builder->path.length - begun + gd__path_builder_run(builder, &at, face),
           rest = hypot(ray->x - ray->t, ray->y);
    if (gd__source_is_linear(ray->source))
        rest = builder->nearest -
               builder->field->seeds[gd__field_seed_of(builder->field, ray->source)].offset - gone;
    uint32_t vertex = vertex_beside(builder, ray, gone, rest);
    if (vertex != GD_NONE) at = gd__point_of_vertex(vertex);
    gd__path_builder_append_in_face(builder, at, face);
    *is_end = at.kind == GD_POINT_VERTEX || rest < GD_TOL_ANEW * gone;
    return at;
}

/* Finds the edge or the face that contains the source if the source is a segment; both are GD_NONE
 * for a point source. */
static bool find_home(const struct gd__path_builder *builder, uint32_t source,
                      struct gd__segment_location *location)
{
    *location = (struct gd__segment_location){.edge = GD_NONE, .face = GD_NONE};
    if (!gd__source_is_linear(source)) return true;
    const struct gd__seed *s = &builder->field->seeds[gd__field_seed_of(builder->field, source)];
    return gd__segment_locate(builder->mesh, &s->point, &s->end, location);
}

/* Follows a careful ray, or any ray to a segment. A ray meets its segment perpendicularly, on an
 * edge that the ray reaches or in a face that it enters. */
static struct gd__stop follow_slowly(struct gd__path_builder *builder, struct gd__ray ray)
{
    const struct gd_mesh *mesh = builder->mesh;
    double begun = builder->path.length;
    bool linear = gd__source_is_linear(ray.source);
    struct gd__segment_location location;
    if (!find_home(builder, ray.source, &location)) return gd__stop_failed(builder, GD_INTERNAL);
    uint32_t seed = linear ? gd__field_seed_of(builder->field, ray.source) : GD_NONE;
    while (builder->steps_left-- && !builder->status) {
        const struct gd_side *across = &mesh->side[ray.side ^ 1];
        struct passage passage;
        bool is_end = false;
        if (ray.side >> 1 == location.edge)
            return gd__ray_arrive_at_chord(builder, seed, mesh->side_face[ray.side]);
        struct gd_point at = builder->aside > 0 ? append_carefully(builder, &ray, begun, &is_end)
                                                : append_end(builder, ray);
        if (is_end || at.kind == GD_POINT_VERTEX) return gd__stop_at(at);
        enter_face(across, &ray, linear);
        if (linear && mesh->side_face[ray.side] == location.face)
            return gd__ray_arrive_at_chord(builder, seed, location.face);
        if (!linear && gd__ray_has_arrived(builder, ray.side, ray.x, ray.y, ray.source))
            return gd__ray_arrive(builder, mesh->side_face[ray.side], ray.source);
        cross_face(across, &ray, &passage, linear);
    }
    return gd__stop_failed(builder, GD_INTERNAL);
}

struct gd__stop gd__ray_follow(struct gd__path_builder *builder, struct gd__ray ray)
{
    bool slowly = builder->aside > 0 || gd__source_is_linear(ray.source);
    return slowly ? follow_slowly(builder, ray) : follow_to_point(builder, ray);
}
