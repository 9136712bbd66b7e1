#include <stdlib.h>

#include "base/prefetch.h"
#include "field/close_seed.h"
#include "field/path_builder.h"
#include "mesh/canonical.h"
#include "mesh/segment.h"

/* Back-tracing: follows the point's last leg to its pseudo-source, and then the predecessors to a
 * seed. */

/* --- rays ------------------------------------------------------------------------------------- */

/* A leg is a straight line through unfolded faces. In each face a ray is described by its crossing
 * of an edge and the image of its source. */

/* A ray in the frame of a side of its face. The ray crosses the side at t. The image of a point
 * source lies beyond the side, at (x, -y). A segment source lies in the direction (x, -y). */
struct ray {
    uint32_t side, source;
    double t, x, y;
};

/* The position where a leg ended. */
struct stop {
    enum { STOP_VERTEX, STOP_SEED, STOP_BEND, STOP_FAILED } kind;
    uint32_t vertex;       /* STOP_VERTEX */
    uint32_t seed;         /* STOP_SEED */
    struct gd_point point; /* STOP_BEND; a point of an edge */
};

static struct stop stop_at_vertex(uint32_t vertex)
{
    return (struct stop){.kind = STOP_VERTEX, .vertex = vertex};
}

/* Returns a stop at a vertex, or a bend at another point. */
static struct stop stop_at(struct gd_point point)
{
    if (point.kind == GD_POINT_VERTEX) return stop_at_vertex(point.element);
    return (struct stop){.kind = STOP_BEND, .point = point};
}

static struct stop stop_at_seed(uint32_t seed)
{
    return (struct stop){.kind = STOP_SEED, .seed = seed};
}

/* Stores a failure in the builder's status. */
static struct stop stop_failed(struct gd__path_builder *builder, enum gd_status status)
{
    if (!builder->status) builder->status = status;
    return (struct stop){.kind = STOP_FAILED};
}

/* --- arrival ---------------------------------------------------------------------------------- */

/* Returns true if the source, a vertex or a point seed, lies in the face of `side` at (x, y). The
 * leg then ends in this face. */
static bool ray_has_arrived(const struct gd__path_builder *builder, uint32_t side, double x,
                            double y, uint32_t source)
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

/* Appends the source, where the leg ends. */
static struct stop ray_arrive(struct gd__path_builder *builder, uint32_t face, uint32_t source)
{
    if (source < builder->mesh->vertex_count) {
        gd__path_builder_append_in_face(builder, gd__point_of_vertex(source), face);
        return stop_at_vertex(source);
    }
    uint32_t seed = source - builder->mesh->vertex_count;
    gd__path_builder_append_seed(builder, seed, face);
    return stop_at_seed(seed);
}

/* Appends the projection of the last point onto a segment seed. The last point lies in the
 * segment's face. */
static struct stop ray_arrive_at_chord(struct gd__path_builder *builder, uint32_t seed,
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
    return stop_at_seed(seed);
}

/* --- from face to face ------------------------------------------------------------------------ */

/* The course of a ray through the faces, which are unfolded into one plane. There the ray begins at
 * 0 and runs along the x axis. It has just entered a face by a side whose origin is not below the
 * axis and whose destination is not above it. The next side is found without a division: only
 * `part` and `at` need one, and the next step does not depend on them. */
struct course {
    uint32_t side;
    double ux, uy; /* unit vector from the side's origin to its destination */
    double x, y;   /* the side's origin */
    double part;   /* where the ray crosses the side: 0 is its origin, 1 its destination */
    double at;     /* x of the crossing */
    double source; /* x of the source; INFINITY for a segment, which a ray meets perpendicularly */
};

/* Returns the course of a ray that enters the face across its side. */
static struct course course_begin(const struct gd_mesh *mesh, const struct ray *ray)
{
    bool linear = gd__source_is_linear(ray->source);
    double length = mesh->side[ray->side].length, t = length - ray->t;
    double dx = linear ? -ray->x : ray->t - ray->x, dy = fmax(ray->y, 0), far = hypot(dx, dy);
    /* a ray that begins at its source may have any direction */
    double x = far > 0 ? dx / far : 0, y = far > 0 ? dy / far : 1;
    return (struct course){.side = ray->side ^ 1,
                           .ux = x,
                           .uy = -y,
                           .x = -t * x,
                           .y = t * y,
                           .part = t / length,
                           .source = linear ? INFINITY : far};
}

/* Turns a course that rounding has moved past its source: it then runs along its side, towards the
 * end that is nearer to the source. */
static void course_turn(struct course *course, double length)
{
    course->ux = course->ux > 0 ? -1 : 1;
    course->uy = 0;
    course->x = course->at - course->part * length * course->ux;
    course->y = 0;
    course->source = course->at;
}

/* Moves a course across its face to the next. `s` is the record of the side by which it entered. It
 * leaves by the left edge, from the origin to the apex, or by the right edge, from the apex to the
 * destination. */
static inline void course_advance(struct course *course, const struct gd_side *s)
{
    if (course->at >= course->source) course_turn(course, s->length);
    double ux = course->ux, uy = course->uy, lx = ux * s->left_x - uy * s->left_y,
           ly = ux * s->left_y + uy * s->left_x, apex = course->y + s->left_length * ly, length;
    if (apex > 0) {
        course->x += s->left_length * lx;
        course->y = apex;
        course->ux = ux * s->right_x - uy * s->right_y;
        course->uy = ux * s->right_y + uy * s->right_x;
        course->side = s->right;
        length = s->right_length;
    } else {
        course->ux = lx;
        course->uy = ly;
        course->side = s->left;
        length = s->left_length;
    }
    course->part = course->y / (length * -course->uy);
    course->at = course->x + course->part * length * course->ux;
}

/* Returns true if the source of a course lies in the face of its side `s`. */
static inline bool course_has_arrived(const struct gd__path_builder *builder,
                                      const struct course *course, const struct gd_side *s,
                                      uint32_t source)
{
    double ux = course->ux, uy = course->uy, dx = course->source - course->x, dy = -course->y,
           height = ux * dy - uy * dx;
    double reach = s->left_length * s->left_y + GD_TOL_ARRIVED * (s->length + s->left_length);
    return height <= reach &&
           ray_has_arrived(builder, course->side, ux * dx + uy * dy, height, source);
}

/* Appends the crossing of a course into the next face, s. Returns false in three cases: the
 * crossing is so near to an end of the edge that it must be moved there, the edge is on the
 * boundary, or memory is exhausted. */
static inline bool append_crossing(struct gd__path_builder *builder, const struct gd_side *s,
                                   const struct course *course)
{
    double snap = builder->snap, part = course->part;
    if (!(part > snap && part < 1 - snap)) return false;
    if (s->left == GD_NONE || !gd__path_builder_reserve(builder)) return false;
    uint32_t side = course->side;
    /* branchless, because a branch would be mispredicted half of the time */
    const double weights[2] = {part, 1 - part};
    struct gd_point *point = &builder->path.points[builder->path.count++];
    point->kind = GD_POINT_EDGE;
    point->element = side >> 1;
    point->weight[0] = weights[side & 1];
    point->weight[1] = weights[~side & 1];
    point->weight[2] = 0;
    return true;
}

/* Returns the point where a course enters its face. No path leaves the surface: a ray that seems to
 * do so passes an end of the boundary edge within the rounding error. */
static struct gd_point crossing_of(const struct gd__path_builder *builder,
                                   const struct course *course)
{
    const struct gd_mesh *mesh = builder->mesh;
    uint32_t side = course->side;
    if (!gd__side_is_boundary(mesh, side))
        return gd__path_builder_side_point(builder, side, course->part * mesh->side[side].length);
    return gd__point_of_vertex(mesh->origin[course->part < 0.5 ? side : side ^ 1]);
}

/* Appends the point where a course enters its face, which may be a vertex. */
static struct gd_point append_end(struct gd__path_builder *builder, const struct course *course)
{
    struct gd_point point = crossing_of(builder, course);
    gd__path_builder_append_in_face(builder, point, builder->mesh->side_face[course->side ^ 1]);
    return point;
}

/* Prefetches the records by which a course leaves the face of `side`. */
GD__PREFETCH prefetch_across(const struct gd_mesh *mesh, uint32_t side)
{
    uint32_t face = mesh->side_face[side];
    if (face == GD_NONE) return;
    for (int k = 0; k < 3; k++) __builtin_prefetch(&mesh->side[mesh->face_side[face][k] ^ 1]);
}

/* Follows a ray from face to face until it reaches its source or passes through a vertex. It reads
 * one record of each face and prefetches those of the faces after the next. */
static struct stop follow_to_point(struct gd__path_builder *builder, const struct ray *ray)
{
    const struct gd_mesh *mesh = builder->mesh;
    struct course course = course_begin(mesh, ray);
    struct gd_point first = append_end(builder, &course);
    if (builder->status) return stop_failed(builder, builder->status);
    if (first.kind == GD_POINT_VERTEX) return stop_at(first);
    const struct gd_side *s = &mesh->side[course.side];
    while (builder->steps_left--) {
        double last = course.at;
        prefetch_across(mesh, s->left);
        prefetch_across(mesh, s->right);
        if (course_has_arrived(builder, &course, s, ray->source)) {
            builder->path.length += last;
            return ray_arrive(builder, mesh->side_face[course.side], ray->source);
        }
        course_advance(&course, s);
        s = &mesh->side[course.side];
        if (append_crossing(builder, s, &course)) continue;
        builder->path.length += last;
        return stop_at(append_end(builder, &course));
    }
    return stop_failed(builder, GD_INTERNAL);
}

/* --- careful rays ----------------------------------------------------------------------------- */

/* The error of a ray grows with the length of its leg, not with the size of the face. In faces much
 * smaller than the leg, rounding can move the ray to the wrong side of a vertex, or past its
 * source. A careful ray goes through every such vertex. The detour is of second order, and the
 * predecessor of the vertex is accurate because the vertex is near to the source. */

/* Returns the vertex within the margin of the crossing where a ray enters its face, or GD_NONE.
 * `gone` is the length of the leg up to the crossing, `rest` the length from the crossing to the
 * source. Each vertex must be nearer to the source than the previous one; otherwise, in faces
 * smaller than the rounding error of distances, the path would run in a circle. */
static uint32_t vertex_beside(const struct gd__path_builder *builder, const struct course *course,
                              double gone, double rest)
{
    const struct gd_mesh *mesh = builder->mesh;
    uint32_t side = course->side;
    double edge = mesh->side[side].length, aside = builder->aside;
    double margin = aside * fmin(gone, rest) + fmin(aside, GD_TOL_ASIDE_END) * edge +
                    GD_TOL_ASIDE_NOISE * builder->nearest;
    bool at_origin = course->part < 0.5;
    uint32_t vertex = mesh->origin[at_origin ? side : side ^ 1];
    if ((at_origin ? course->part : 1 - course->part) * edge > margin) return GD_NONE;
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

/* Appends the point where a careful ray enters its face. Sets *is_end if the leg ends there: at a
 * vertex, or so close to the source that a new leg from there is more accurate. */
static struct gd_point append_carefully(struct gd__path_builder *builder,
                                        const struct course *course, uint32_t source, double begun,
                                        bool *is_end)
{
    uint32_t side = course->side, face = builder->mesh->side_face[side ^ 1];
    struct gd_point at = crossing_of(builder, course);
    if (leads_back(builder, &at) && !gd__side_is_boundary(builder->mesh, side))
        at = gd__point_within_side(side, fmin(fmax(course->part, GD_TOL_WIDTH), 1 - GD_TOL_WIDTH));
    double gone = builder->path.length - begun + gd__path_builder_run(builder, &at, face),
           rest = course->source - course->at;
    if (gd__source_is_linear(source))
        rest = builder->nearest -
               builder->field->seeds[gd__field_seed_of(builder->field, source)].offset - gone;
    uint32_t vertex = vertex_beside(builder, course, gone, rest);
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
static struct stop follow_slowly(struct gd__path_builder *builder, const struct ray *ray)
{
    const struct gd_mesh *mesh = builder->mesh;
    double begun = builder->path.length;
    bool linear = gd__source_is_linear(ray->source);
    struct gd__segment_location location;
    if (!find_home(builder, ray->source, &location)) return stop_failed(builder, GD_INTERNAL);
    uint32_t seed = linear ? gd__field_seed_of(builder->field, ray->source) : GD_NONE;
    struct course course = course_begin(mesh, ray);
    while (builder->steps_left-- && !builder->status) {
        uint32_t side = course.side;
        bool is_end = false;
        if (side >> 1 == location.edge)
            return ray_arrive_at_chord(builder, seed, mesh->side_face[side ^ 1]);
        struct gd_point at = builder->aside > 0
                                 ? append_carefully(builder, &course, ray->source, begun, &is_end)
                                 : append_end(builder, &course);
        if (is_end || at.kind == GD_POINT_VERTEX) return stop_at(at);
        if (linear && mesh->side_face[side] == location.face)
            return ray_arrive_at_chord(builder, seed, location.face);
        if (!linear && course_has_arrived(builder, &course, &mesh->side[side], ray->source))
            return ray_arrive(builder, mesh->side_face[side], ray->source);
        course_advance(&course, &mesh->side[side]);
    }
    return stop_failed(builder, GD_INTERNAL);
}

/* Appends the crossings of the ray with edges until it reaches its source or passes through a
 * vertex. */
static struct stop ray_follow(struct gd__path_builder *builder, struct ray ray)
{
    bool slowly = builder->aside > 0 || gd__source_is_linear(ray.source);
    return slowly ? follow_slowly(builder, &ray) : follow_to_point(builder, &ray);
}

/* --- from stop to stop ------------------------------------------------------------------------ */

static struct stop go_along_edge(struct gd__path_builder *builder, uint32_t vertex, uint32_t source)
{
    const struct gd_mesh *mesh = builder->mesh;
    if (source < mesh->vertex_count) {
        gd__path_builder_append(builder, gd__point_of_vertex(source),
                                mesh->side[gd__side_between(mesh, vertex, source)].length);
        return stop_at_vertex(source);
    }
    if (source == GD_NONE) /* the vertex is unreached */
        return stop_failed(builder, GD_INTERNAL);
    const struct gd_point *seed = &builder->field->seeds[source - mesh->vertex_count].point;
    if (seed->kind == GD_POINT_EDGE) {
        uint32_t side = 2 * seed->element;
        gd__path_builder_append_in_face(
            builder, *seed, mesh->side_face[gd__side_is_boundary(mesh, side) ? side ^ 1 : side]);
    }
    return stop_at_seed(source - mesh->vertex_count);
}

/* Returns true if a source is a segment that lies on `edge` or in `face`. */
static bool is_along(const struct gd__path_builder *builder, uint32_t source, uint32_t edge,
                     uint32_t face)
{
    struct gd__segment_location location;
    const struct gd__seed *s = &builder->field->seeds[gd__field_seed_of(builder->field, source)];
    return gd__segment_locate(builder->mesh, &s->point, &s->end, &location) &&
           location.edge == edge && location.face == face;
}

/* Follows the leg from a vertex perpendicularly to a segment, which may lie in the leg's face. */
static struct stop go_to_segment(struct gd__path_builder *builder,
                                 struct gd__predecessor predecessor)
{
    const struct gd_mesh *mesh = builder->mesh;
    const struct gd_side *s = &mesh->side[predecessor.side];
    uint32_t face = mesh->side_face[predecessor.side];
    if (is_along(builder, predecessor.source, GD_NONE, face))
        return ray_arrive_at_chord(builder, gd__field_seed_of(builder->field, predecessor.source),
                                   face);
    double t =
        s->left_length * s->left_x + predecessor.x * (s->left_length * s->left_y / predecessor.y);
    return ray_follow(builder, (struct ray){predecessor.side, predecessor.source, t, predecessor.x,
                                            predecessor.y});
}

/* Follows the leg from a vertex to its predecessor. */
static struct stop go_from_vertex(struct gd__path_builder *builder, uint32_t vertex)
{
    const struct gd_mesh *mesh = builder->mesh;
    struct gd__predecessor predecessor = builder->field->predecessor[vertex];
    if (predecessor.side == GD_NONE) return go_along_edge(builder, vertex, predecessor.source);
    const struct gd_side *s = &mesh->side[predecessor.side];
    if (predecessor.source == GD_NONE) {
        struct gd_point bend =
            gd__path_builder_side_point(builder, predecessor.side, predecessor.x);
        gd__path_builder_append_in_face(builder, bend, mesh->side_face[predecessor.side]);
        return stop_at(bend);
    }
    if (gd__source_is_linear(predecessor.source)) return go_to_segment(builder, predecessor);
    if (ray_has_arrived(builder, predecessor.side, predecessor.x, -predecessor.y,
                        predecessor.source))
        return ray_arrive(builder, mesh->side_face[predecessor.side], predecessor.source);
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y,
           height = predecessor.y + py;
    double across = px - predecessor.x, t = predecessor.x;
    if (height > 0)
        t = predecessor.y < py ? predecessor.x + across * (predecessor.y / height)
                               : px - across * (py / height);
    return ray_follow(builder, (struct ray){predecessor.side, predecessor.source, t, predecessor.x,
                                            predecessor.y});
}

static struct stop go_to_close_seed(struct gd__path_builder *builder, const struct gd__leg *leg)
{
    struct gd__close_seed close;
    double weight[3];
    gd__point_weights(builder->mesh, &builder->path.points[builder->path.count - 1], leg->face,
                      weight);
    if (!gd__close_seed_find(builder->field, leg->face, weight, GD__FAR, &close))
        return stop_failed(builder, GD_INTERNAL);
    gd__close_seed_trace(builder, leg->face, &close);
    return stop_at_seed(close.seed);
}

/* Follows the leg from a point of an edge or a face. */
static struct stop go_by_leg(struct gd__path_builder *builder, const struct gd__leg *leg)
{
    switch (leg->kind) {
    case GD__LEG_VERTEX:
        gd__path_builder_append_in_face(builder, gd__point_of_vertex(leg->from), leg->face);
        break;
    case GD__LEG_SEED:
        if (builder->field->seeds[leg->from].is_segment)
            return ray_arrive_at_chord(builder, leg->from, leg->face);
        gd__path_builder_append_seed(builder, leg->from, leg->face);
        return stop_at_seed(leg->from);
    case GD__LEG_CLOSE:
        return go_to_close_seed(builder, leg);
    case GD__LEG_WEDGE:
        return ray_follow(builder,
                          (struct ray){leg->side, leg->source, leg->parameter, leg->x, leg->y});
    case GD__LEG_NONE:
        return stop_failed(builder, GD_INTERNAL);
    }
    return stop_at_vertex(leg->from);
}

/* Parameters of one attempt to trace a path. */
struct beginning {
    double aside; /* gd__path_builder.aside */
    /* the path first goes to this vertex of `face`; GD_NONE means that it follows its leg */
    uint32_t via;
    uint32_t face;
};

static struct stop go_from_beginning(struct gd__path_builder *builder, const struct gd_point *point,
                                     const struct gd__leg *first, const struct beginning *beginning)
{
    if (beginning->via != GD_NONE) {
        gd__path_builder_append_in_face(builder, gd__point_of_vertex(beginning->via),
                                        beginning->face);
        return stop_at_vertex(beginning->via);
    }
    return point->kind == GD_POINT_VERTEX ? stop_at(*point) : go_by_leg(builder, first);
}

/* Traces a path back to a seed, whose number becomes *seed. */
static void trace_back(struct gd__path_builder *builder, const struct gd_point *point,
                       const struct gd__leg *first, const struct beginning *beginning,
                       uint32_t *seed)
{
    gd__path_builder_append(builder, *point, 0);
    if (builder->status) return; /* the next leg starts from the last point */
    struct stop stop = go_from_beginning(builder, point, first, beginning);
    while (stop.kind != STOP_SEED && !builder->status) {
        if (!builder->steps_left--) {
            stop_failed(builder, GD_INTERNAL);
        } else if (stop.kind == STOP_VERTEX) {
            builder->vertex = stop.vertex;
            builder->nearest = builder->field->distance[stop.vertex];
            stop = go_from_vertex(builder, stop.vertex);
        } else {
            struct gd__leg leg = gd__field_leg_onward(builder->field, &stop.point, builder->vertex);
            builder->nearest = leg.distance;
            stop = go_by_leg(builder, &leg);
        }
    }
    if (!builder->status) *seed = stop.seed;
}

/* --- the path --------------------------------------------------------------------------------- */

/* Makes one attempt. On success the caller owns the path, whose length agrees with the distance. */
static enum gd_status try_path(const struct gd_field *field, const struct gd_point *point,
                               const struct gd__leg *leg, const struct beginning *beginning,
                               struct gd_path *out, uint32_t *seed)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__path_builder builder = {
        .field = field,
        .mesh = mesh,
        .snap = beginning->aside > 0 ? 0 : GD_TOL_SNAP,
        .aside = beginning->aside,
        .vertex = GD_NONE,
        .nearest = leg->distance,
        .steps_left = 2 * ((uint64_t)mesh->edge_count + mesh->vertex_count) + 16};
    uint32_t end = 0;
    trace_back(&builder, point, leg, beginning, &end);
    double offset = field->seeds[end].offset, slack = GD_TOL_CHECK * leg->distance + GD_TOL_BETTER;
    if (!builder.status && !(fabs(builder.path.length + offset - leg->distance) <= slack))
        builder.status = GD_INTERNAL;
    if (builder.status) {
        gd_path_free(&builder.path);
        return builder.status;
    }
    /* The distance is more precise than the sum of the lengths of the path's segments. */
    builder.path.length = (leg->distance - offset) * mesh->unit;
    *out = builder.path;
    *seed = end;
    return GD_OK;
}

enum { CAREFUL_ATTEMPTS = 7 };

/* Retries with a path via a neighbouring vertex. If faces are not larger than the rounding error, a
 * ray may run in a circle. A path via a neighbouring vertex is then equally short. The check of the
 * length rejects a longer path. */
static enum gd_status path_by_neighbours(const struct gd_field *field, const struct gd_point *point,
                                         const struct gd__leg *leg, struct gd_path *out,
                                         uint32_t *seed)
{
    const struct gd_mesh *mesh = field->mesh;
    enum gd_status status = GD_INTERNAL;
    bool is_vertex = point->kind == GD_POINT_VERTEX;
    uint32_t first = is_vertex ? mesh->fan_first[point->element] : 0,
             end = is_vertex ? mesh->fan_first[point->element + 1] : 1;
    for (uint32_t i = first; i < end && status == GD_INTERNAL; i++) {
        struct beginning beginning = {.face = is_vertex ? mesh->side_face[mesh->fan[i].side]
                                                        : leg->face};
        for (int k = 0; k < 3 && status == GD_INTERNAL; k++) {
            beginning.via = mesh->origin[mesh->face_side[beginning.face][k]];
            bool is_far = field->distance[beginning.via] > leg->distance * (1 + GD_TOL_CHECK);
            if (is_far || (is_vertex && beginning.via == point->element)) continue;
            status = try_path(field, point, leg, &beginning, out, seed);
        }
    }
    return status;
}

/* Traces the path whose first leg is known. */
static enum gd_status path_by_leg(const struct gd_field *field, const struct gd_point *point,
                                  const struct gd__leg *leg, struct gd_path *out, uint32_t *seed)
{
    struct beginning beginning = {.via = GD_NONE};
    enum gd_status status = try_path(field, point, leg, &beginning, out, seed);
    beginning.aside = GD_TOL_ASIDE_LEAST;
    for (int i = 0; i < CAREFUL_ATTEMPTS && status == GD_INTERNAL;
         i++, beginning.aside *= GD_TOL_ASIDE_STEP)
        status = try_path(field, point, leg, &beginning, out, seed);
    return status == GD_INTERNAL ? path_by_neighbours(field, point, leg, out, seed) : status;
}

enum gd_status gd_field_path_to_seed(const struct gd_field *field, const struct gd_point *point,
                                     struct gd_path *out, uint32_t *seed)
{
    struct gd__leg leg = gd__field_leg(field, point);
    if (leg.distance > field->reach) return GD_BEYOND_REACH;
    if (leg.kind == GD__LEG_NONE) return GD_NOT_ON_SURFACE;
    return path_by_leg(field, point, &leg, out, seed);
}

enum gd_status gd__field_distance_and_path(const struct gd_field *field,
                                           const struct gd_point *point, double *distance,
                                           struct gd_path *out)
{
    struct gd__leg leg = gd__field_leg(field, point);
    uint32_t seed;
    if (leg.distance > field->reach) return GD_BEYOND_REACH;
    *distance = leg.kind == GD__LEG_NONE ? INFINITY : leg.distance * field->mesh->unit;
    return leg.kind == GD__LEG_NONE ? GD_OK : path_by_leg(field, point, &leg, out, &seed);
}

enum gd_status gd_field_path(const struct gd_field *field, const struct gd_point *point,
                             struct gd_path *out)
{
    uint32_t seed;
    return gd_field_path_to_seed(field, point, out, &seed);
}

void gd_path_free(struct gd_path *path)
{
    if (!path) return;
    free(path->points);
    *path = (struct gd_path){0};
}
