#include "field/layout.h"

#include <stdlib.h>
#include <string.h>

#include "mesh/canonical.h"
#include "mesh/segment.h"

/* Back-tracing: from the point along its last leg to the leg's pseudo-source, and on from there by the births, until a seed is reached. A leg
 * is a straight line through unfolded faces, so one frame at a time suffices: where it crosses the edge, and where the source's image lies. */

enum { CAPACITY = 128 }; /* points that a path has room for to begin with */

struct trace {
    const struct gd_field *field;
    const struct gd_mesh *mesh;
    struct gd_path path;
    uint32_t capacity;
    double snap;         /* part of an edge within which a crossing is at its end */
    uint64_t steps_left; /* a shortest path crosses no face twice: more steps are an error, not a longer walk */
    enum gd_status status;
};

/* Where a leg ended. */
struct stop {
    enum { STOP_VERTEX, STOP_SEED, STOP_BEND, STOP_FAILED } kind;
    uint32_t vertex;       /* STOP_VERTEX */
    uint32_t seed;         /* STOP_SEED */
    struct gd_point point; /* STOP_BEND: a point of an edge */
};

/* A ray in the frame of a side of the face it is in: crosses the side at t, its source's image lies across at (x, -y), or, of a segment, in that
 * direction. */
struct ray {
    uint32_t side, source;
    double t, x, y;
};

/* --- the polyline -------------------------------------------------------------------------------------------------------- */

/* Room for one point more; false, and the status says so, without memory. */
static bool make_room(struct trace *trace)
{
    struct gd_path *path = &trace->path;
    if (path->count < trace->capacity) return true;
    uint32_t capacity = trace->capacity ? 2 * trace->capacity : CAPACITY;
    struct gd_point *points = realloc(path->points, sizeof *points * (size_t)capacity);
    if (!points) {
        trace->status = GD_NO_MEMORY;
        return false;
    }
    path->points = points;
    trace->capacity = capacity;
    return true;
}

/* The same point, or one that rounding made of it: where a ray leaves the edge that it begins on. */
static bool is_same_place(const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind != GD_POINT_EDGE || b->kind != GD_POINT_EDGE || a->element != b->element) return gd_point_equal(a, b);
    return fabs(a->weight[0] - b->weight[0]) <= GD_TOL_ON_BORDER;
}

static void append(struct trace *trace, struct gd_point point, double length)
{
    struct gd_path *path = &trace->path;
    if (trace->status || (path->count && is_same_place(&path->points[path->count - 1], &point))) return;
    if (!make_room(trace)) return;
    path->points[path->count++] = point;
    path->length += length;
}

/* Appends a point of a face in which the last point lies too. The length is that of the segment itself, measured in the face: nothing of the
 * distances that the wedges gave enters it, so that the two can be compared. */
static void append_in_face(struct trace *trace, struct gd_point point, uint32_t face)
{
    if (trace->status) return;
    double from[3], to[3];
    gd__point_weights(trace->mesh, &trace->path.points[trace->path.count - 1], face, from);
    gd__point_weights(trace->mesh, &point, face, to);
    uint32_t side = trace->mesh->face_side[face][0];
    struct gd__local a = gd__face_local(trace->mesh, side, from), b = gd__face_local(trace->mesh, side, to);
    append(trace, point, sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y)));
}

static struct gd_point vertex_point(uint32_t vertex)
{
    return (struct gd_point){.kind = GD_POINT_VERTEX, .element = vertex};
}

/* The point at parameter t of a side; the edge's end when it is within rounding of it. */
static struct gd_point side_point(const struct trace *trace, uint32_t side, double t)
{
    const struct gd_mesh *mesh = trace->mesh;
    double length = mesh->side[side].length;
    if (t <= trace->snap * length) return vertex_point(mesh->origin[side]);
    if (t >= (1 - trace->snap) * length) return vertex_point(mesh->origin[side ^ 1]);
    double weight = t / length;
    return (struct gd_point){.kind = GD_POINT_EDGE, .element = side >> 1, .weight = {side & 1 ? 1 - weight : weight}};
}

/* Where a ray leaves its face by a side. No path leaves the surface: a ray that seems to, passes an end of the boundary edge within rounding. */
static struct gd_point crossing_of(const struct trace *trace, const struct ray *ray)
{
    const struct gd_mesh *mesh = trace->mesh;
    if (!gd__side_is_boundary(mesh, ray->side ^ 1)) return side_point(trace, ray->side, ray->t);
    bool at_origin = ray->t < 0.5 * mesh->side[ray->side].length;
    return vertex_point(mesh->origin[at_origin ? ray->side : ray->side ^ 1]);
}

/* --- one leg ------------------------------------------------------------------------------------------------------------- */

static struct stop stop_at(struct gd_point point)
{
    if (point.kind == GD_POINT_VERTEX) return (struct stop){.kind = STOP_VERTEX, .vertex = point.element};
    return (struct stop){.kind = STOP_BEND, .point = point};
}

static struct stop stop_at_seed(uint32_t seed)
{
    return (struct stop){.kind = STOP_SEED, .seed = seed};
}

static struct stop fail(struct trace *trace, enum gd_status status)
{
    if (!trace->status) trace->status = status;
    return (struct stop){.kind = STOP_FAILED};
}

/* Is the source in the face of `side`, and there at (x, y)? Then the leg ends. */
static bool arrived(const struct trace *trace, uint32_t side, double x, double y, uint32_t source)
{
    const struct gd_mesh *mesh = trace->mesh;
    const struct gd_side *s = &mesh->side[side];
    struct gd_point point =
        source < mesh->vertex_count ? vertex_point(source) : trace->field->seeds[source - mesh->vertex_count].point;
    uint32_t face = mesh->side_face[side];
    int k = mesh->face_side[face][0] == side ? 0 : mesh->face_side[face][1] == side ? 1 : 2;
    double weight[3];
    if (point.kind == GD_POINT_FACE && point.element != face) return false;
    gd__point_weights(mesh, &point, face, weight);
    if (weight[0] + weight[1] + weight[2] == 0) return false;
    struct gd__local at = gd__face_local(mesh, side, (double[3]){weight[k], weight[(k + 1) % 3], weight[(k + 2) % 3]});
    double tolerance = GD_TOL_ARRIVED * (s->length + s->left_length);
    return fabs(at.x - x) <= tolerance && fabs(at.y - y) <= tolerance;
}

static struct stop arrive(struct trace *trace, uint32_t face, uint32_t source)
{
    if (source < trace->mesh->vertex_count) {
        append_in_face(trace, vertex_point(source), face);
        return (struct stop){.kind = STOP_VERTEX, .vertex = source};
    }
    uint32_t seed = source - trace->mesh->vertex_count;
    append_in_face(trace, trace->field->seeds[seed].point, face);
    return stop_at_seed(seed);
}

/* --- a segment as a leg's source ----------------------------------------------------------------------------------------- */

/* Appends the foot of the perpendicular from the last point, which lies in the segment's face, on the segment. */
static struct stop arrive_at_chord(struct trace *trace, uint32_t seed, uint32_t face)
{
    const struct gd_mesh *mesh = trace->mesh;
    const struct gd__seed *s = &trace->field->seeds[seed];
    struct gd__chord chord = gd__chord(mesh, face, 0, &s->point, &s->end);
    double weight[3], from[3], to[3];
    gd__point_weights(mesh, &trace->path.points[trace->path.count - 1], face, weight);
    double part = gd__chord_foot(&chord, gd__face_local(mesh, mesh->face_side[face][0], weight)) / chord.length;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    gd__point_weights(mesh, &s->point, face, from);
    gd__point_weights(mesh, &s->end, face, to);
    for (int k = 0; k < 3; k++) weight[k] = (1 - part) * from[k] + part * to[k];
    append_in_face(trace, gd__point_of_face(mesh, face, weight), face);
    return stop_at_seed(seed);
}

/* Whether a source is a segment that lies along an edge, or across a face. */
static bool is_along(const struct trace *trace, uint32_t source, uint32_t edge, uint32_t face)
{
    struct gd__home home;
    const struct gd__seed *s = &trace->field->seeds[gd__field_seed_of(trace->field, source)];
    return gd__segment_home(trace->mesh, &s->point, &s->end, &home) && home.edge == edge && home.face == face;
}

/* How a ray left a face: by an edge of that length, on a segment of that length, which is measured in the face's frame. */
struct passage {
    double edge, segment;
};

/* What is done for a ray to a point and to a segment alike. */
#define BOTH_KINDS static inline __attribute__((always_inline))

/* The same ray in the face across its side: there its source is above, at (x, y). */
BOTH_KINDS void enter_face(const struct gd_side *s, struct ray *ray, bool linear)
{
    ray->side ^= 1;
    ray->t = s->length - ray->t;
    ray->x = linear ? -ray->x : s->length - ray->x;
}

/* A ray that has entered the face of its side becomes one of the side by which it leaves: of the edge to the left, from the origin to the apex,
 * or of the one to the right, from the apex to the destination. (ux, uy) runs along it, (rx, ry) from its end to the source. */
BOTH_KINDS void cross_face(const struct gd_side *s, struct ray *ray, struct passage *passage, bool linear)
{
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y; /* apex */
    double t = ray->t, dx = linear ? ray->x : ray->x - t, dy = ray->y, along, ux, uy, rx, ry, sx, sy;
    if ((px - t) * dy - py * dx > 0) {
        ux = s->left_x, uy = s->left_y, rx = linear ? dx : ray->x - px, ry = linear ? dy : ray->y - py;
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

/* Appends where a ray crosses from face to face; false where that is at the edge's end, up to snapping, or at the border, or without memory. */
static inline bool append_crossing(struct trace *trace, const struct ray *ray, const struct passage *passage)
{
    if (ray->t <= trace->snap * passage->edge || ray->t >= (1 - trace->snap) * passage->edge) return false;
    if (gd__side_is_boundary(trace->mesh, ray->side ^ 1) || !make_room(trace)) return false;
    double weight = ray->t / passage->edge;
    struct gd_point *point = &trace->path.points[trace->path.count++];
    point->kind = GD_POINT_EDGE;
    point->element = ray->side >> 1;
    point->weight[0] = ray->side & 1 ? 1 - weight : weight;
    point->weight[1] = point->weight[2] = 0;
    trace->path.length += passage->segment;
    return true;
}

/* Appends where a ray comes to, be it a vertex. */
static struct gd_point append_end(struct trace *trace, const struct ray *ray)
{
    struct gd_point point = crossing_of(trace, ray);
    append_in_face(trace, point, trace->mesh->side_face[ray->side]);
    return point;
}

/* Is the source's image low enough to be in the face, so that it is worth a closer look? */
static inline bool may_have_arrived(const struct gd_side *s, double y)
{
    return y <= s->left_length * s->left_y + GD_TOL_ARRIVED * (s->length + s->left_length);
}

/* Follows a ray from face to face until it reaches its source or passes through a vertex. Of each face it reads one record, which it asks for as
 * soon as the one before is there. */
static struct stop follow_to_point(struct trace *trace, struct ray ray)
{
    const struct gd_mesh *mesh = trace->mesh;
    struct gd_point first = append_end(trace, &ray);
    if (first.kind == GD_POINT_VERTEX) return stop_at(first);
    while (trace->steps_left-- && !trace->status) {
        const struct gd_side *s = &mesh->side[ray.side ^ 1];
        struct passage passage;
        __builtin_prefetch(&mesh->side[s->left]);
        __builtin_prefetch(&mesh->side[s->right]);
        enter_face(s, &ray, false);
        if (may_have_arrived(s, ray.y) && arrived(trace, ray.side, ray.x, ray.y, ray.source))
            return arrive(trace, mesh->side_face[ray.side], ray.source);
        cross_face(s, &ray, &passage, false);
        if (!append_crossing(trace, &ray, &passage)) return stop_at(append_end(trace, &ray));
    }
    return fail(trace, GD_INTERNAL);
}

/* The same to a segment, which the ray meets at right angles: on an edge that it comes to, or in a face that it enters. */
static struct stop follow_to_segment(struct trace *trace, struct ray ray)
{
    const struct gd_mesh *mesh = trace->mesh;
    uint32_t seed = gd__field_seed_of(trace->field, ray.source);
    const struct gd__seed *s = &trace->field->seeds[seed];
    struct gd__home home;
    if (!gd__segment_home(mesh, &s->point, &s->end, &home)) return fail(trace, GD_INTERNAL);
    while (trace->steps_left-- && !trace->status) {
        const struct gd_side *across = &mesh->side[ray.side ^ 1];
        struct passage passage;
        if (ray.side >> 1 == home.edge) return arrive_at_chord(trace, seed, mesh->side_face[ray.side]);
        struct gd_point at = append_end(trace, &ray);
        if (at.kind == GD_POINT_VERTEX) return stop_at(at);
        enter_face(across, &ray, true);
        if (mesh->side_face[ray.side] == home.face) return arrive_at_chord(trace, seed, home.face);
        cross_face(across, &ray, &passage, true);
    }
    return fail(trace, GD_INTERNAL);
}

static struct stop follow(struct trace *trace, struct ray ray)
{
    return gd__source_is_linear(ray.source) ? follow_to_segment(trace, ray) : follow_to_point(trace, ray);
}

/* --- from stop to stop --------------------------------------------------------------------------------------------------- */

static struct stop go_along_edge(struct trace *trace, uint32_t vertex, uint32_t source)
{
    const struct gd_mesh *mesh = trace->mesh;
    if (source < mesh->vertex_count) {
        append(trace, vertex_point(source), mesh->side[gd__side_between(mesh, vertex, source)].length);
        return (struct stop){.kind = STOP_VERTEX, .vertex = source};
    }
    if (source == GD_NONE) return fail(trace, GD_INTERNAL); /* the path leads to a vertex that was not reached */
    const struct gd_point *seed = &trace->field->seeds[source - mesh->vertex_count].point;
    if (seed->kind == GD_POINT_EDGE) {
        uint32_t side = 2 * seed->element;
        append_in_face(trace, *seed, mesh->side_face[gd__side_is_boundary(mesh, side) ? side ^ 1 : side]);
    }
    return stop_at_seed(source - mesh->vertex_count);
}

/* From a vertex at right angles towards a segment, which may lie in the face that the leg came through. */
static struct stop go_to_segment(struct trace *trace, struct gd__birth birth)
{
    const struct gd_mesh *mesh = trace->mesh;
    const struct gd_side *s = &mesh->side[birth.side];
    uint32_t face = mesh->side_face[birth.side];
    if (is_along(trace, birth.source, GD_NONE, face))
        return arrive_at_chord(trace, gd__field_seed_of(trace->field, birth.source), face);
    double t = s->left_length * s->left_x + birth.x * (s->left_length * s->left_y / birth.y);
    return follow(trace, (struct ray){.side = birth.side, .source = birth.source, .t = t, .x = birth.x, .y = birth.y});
}

/* From a vertex by its birth. */
static struct stop go_from_vertex(struct trace *trace, uint32_t vertex)
{
    const struct gd_mesh *mesh = trace->mesh;
    struct gd__birth birth = trace->field->birth[vertex];
    if (birth.side == GD_NONE) return go_along_edge(trace, vertex, birth.source);
    const struct gd_side *s = &mesh->side[birth.side];
    if (birth.source == GD_NONE) {
        struct gd_point bend = side_point(trace, birth.side, birth.x);
        append_in_face(trace, bend, mesh->side_face[birth.side]);
        return stop_at(bend);
    }
    if (gd__source_is_linear(birth.source)) return go_to_segment(trace, birth);
    if (arrived(trace, birth.side, birth.x, -birth.y, birth.source))
        return arrive(trace, mesh->side_face[birth.side], birth.source);
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y, height = birth.y + py;
    double t = height > 0 ? birth.x + (px - birth.x) * (birth.y / height) : birth.x;
    return follow(trace, (struct ray){.side = birth.side, .source = birth.source, .t = t, .x = birth.x, .y = birth.y});
}

/* From a point of an edge or a face by its leg. */
static struct stop go_by_leg(struct trace *trace, const struct gd__leg *leg)
{
    switch (leg->kind) {
    case GD__LEG_VERTEX:
        append_in_face(trace, vertex_point(leg->from), leg->face);
        break;
    case GD__LEG_SEED:
        if (trace->field->seeds[leg->from].is_segment) return arrive_at_chord(trace, leg->from, leg->face);
        append_in_face(trace, trace->field->seeds[leg->from].point, leg->face);
        return stop_at_seed(leg->from);
    case GD__LEG_WEDGE:
        return follow(
            trace,
            (struct ray){.side = leg->side, .source = leg->source, .t = leg->parameter, .x = leg->x, .y = leg->y});
    case GD__LEG_NONE:
        return fail(trace, GD_INTERNAL);
    }
    return (struct stop){.kind = STOP_VERTEX, .vertex = leg->from};
}

/* *seed: the one in which the path ends. */
static void trace_back(struct trace *trace, const struct gd_point *point, const struct gd__leg *first, uint32_t *seed)
{
    append(trace, *point, 0);
    if (trace->status) return; /* what follows looks at the last point */
    struct stop stop = point->kind == GD_POINT_VERTEX ? stop_at(*point) : go_by_leg(trace, first);
    while (stop.kind != STOP_SEED && !trace->status) {
        if (!trace->steps_left--) {
            fail(trace, GD_INTERNAL);
        } else if (stop.kind == STOP_VERTEX) {
            stop = go_from_vertex(trace, stop.vertex);
        } else {
            struct gd__leg leg = gd__field_leg(trace->field, &stop.point);
            stop = go_by_leg(trace, &leg);
        }
    }
    if (!trace->status) *seed = stop.seed;
}

/* One attempt; on success the path is the caller's, its length and the distance agree. */
static enum gd_status try_path(const struct gd_field *field, const struct gd_point *point, const struct gd__leg *leg,
                               double snap, struct gd_path *out, uint32_t *seed)
{
    const struct gd_mesh *mesh = field->mesh;
    struct trace trace = {.field = field,
                          .mesh = mesh,
                          .snap = snap,
                          .steps_left = 2 * ((uint64_t)mesh->edge_count + mesh->vertex_count) + 16};
    uint32_t end = 0;
    trace_back(&trace, point, leg, &end);
    double offset = field->seeds[end].offset, slack = GD_TOL_CHECK * leg->distance + GD_TOL_BETTER;
    if (!trace.status && !(fabs(trace.path.length + offset - leg->distance) <= slack)) trace.status = GD_INTERNAL;
    if (trace.status) {
        gd_path_free(&trace.path);
        return trace.status;
    }
    trace.path.length *= mesh->unit;
    *out = trace.path;
    *seed = end;
    return GD_OK;
}

/* The path whose first leg is known. */
static enum gd_status path_by_leg(const struct gd_field *field, const struct gd_point *point, const struct gd__leg *leg,
                                  struct gd_path *out, uint32_t *seed)
{
    enum gd_status status = GD_INTERNAL;
    for (double snap = GD_TOL_SNAP; status == GD_INTERNAL && snap <= GD_TOL_SNAP_MOST; snap *= 10)
        status = try_path(field, point, leg, snap, out, seed);
    for (double snap = 0.01 * GD_TOL_SNAP; status == GD_INTERNAL && snap >= GD_TOL_SNAP_LEAST; snap *= 0.01)
        status = try_path(field, point, leg, snap, out, seed);
    return status;
}

enum gd_status gd_field_path_to_seed(const struct gd_field *field, const struct gd_point *point, struct gd_path *out,
                                     uint32_t *seed)
{
    struct gd__leg leg = gd__field_leg(field, point);
    if (leg.distance > field->reach) return GD_BEYOND_REACH;
    if (leg.kind == GD__LEG_NONE) return GD_NOT_ON_SURFACE;
    return path_by_leg(field, point, &leg, out, seed);
}

enum gd_status gd__field_distance_and_path(const struct gd_field *field, const struct gd_point *point, double *distance,
                                           struct gd_path *out)
{
    struct gd__leg leg = gd__field_leg(field, point);
    uint32_t seed;
    if (leg.distance > field->reach) return GD_BEYOND_REACH;
    *distance = leg.kind == GD__LEG_NONE ? INFINITY : leg.distance * field->mesh->unit;
    return leg.kind == GD__LEG_NONE ? GD_OK : path_by_leg(field, point, &leg, out, &seed);
}

enum gd_status gd_field_path(const struct gd_field *field, const struct gd_point *point, struct gd_path *out)
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
