#include "field/close.h"
#include "field/ray.h"

#include <stdlib.h>

#include "mesh/canonical.h"
#include "mesh/segment.h"

/* Back-tracing: from the point along its last leg to the leg's pseudo-source, and on from there by
 * the predecessors, until a seed is reached. */

/* --- from stop to stop ------------------------------------------------------------------------ */

static struct gd__stop go_along_edge(struct gd__trail *trail, uint32_t vertex, uint32_t source)
{
    const struct gd_mesh *mesh = trail->mesh;
    if (source < mesh->vertex_count) {
        gd__trail_append(trail, gd__point_of_vertex(source),
                         mesh->side[gd__side_between(mesh, vertex, source)].length);
        return gd__stop_at_vertex(source);
    }
    if (source == GD_NONE) /* the path leads to a vertex that was not reached */
        return gd__stop_failed(trail, GD_INTERNAL);
    const struct gd_point *seed = &trail->field->seeds[source - mesh->vertex_count].point;
    if (seed->kind == GD_POINT_EDGE) {
        uint32_t side = 2 * seed->element;
        gd__trail_append_in_face(
            trail, *seed, mesh->side_face[gd__side_is_boundary(mesh, side) ? side ^ 1 : side]);
    }
    return gd__stop_at_seed(source - mesh->vertex_count);
}

/* Whether a source is a segment that lies along an edge, or across a face. */
static bool is_along(const struct gd__trail *trail, uint32_t source, uint32_t edge, uint32_t face)
{
    struct gd__home home;
    const struct gd__seed *s = &trail->field->seeds[gd__field_seed_of(trail->field, source)];
    return gd__segment_home(trail->mesh, &s->point, &s->end, &home) && home.edge == edge &&
           home.face == face;
}

/* From a vertex at right angles towards a segment, which may lie in the face that the leg came
 * through. */
static struct gd__stop go_to_segment(struct gd__trail *trail, struct gd__predecessor predecessor)
{
    const struct gd_mesh *mesh = trail->mesh;
    const struct gd_side *s = &mesh->side[predecessor.side];
    uint32_t face = mesh->side_face[predecessor.side];
    if (is_along(trail, predecessor.source, GD_NONE, face))
        return gd__ray_arrive_at_chord(trail, gd__field_seed_of(trail->field, predecessor.source),
                                       face);
    double t =
        s->left_length * s->left_x + predecessor.x * (s->left_length * s->left_y / predecessor.y);
    return gd__ray_follow(trail, (struct gd__ray){.side = predecessor.side,
                                                  .source = predecessor.source,
                                                  .t = t,
                                                  .x = predecessor.x,
                                                  .y = predecessor.y});
}

/* From a vertex by its predecessor. */
static struct gd__stop go_from_vertex(struct gd__trail *trail, uint32_t vertex)
{
    const struct gd_mesh *mesh = trail->mesh;
    struct gd__predecessor predecessor = trail->field->predecessor[vertex];
    if (predecessor.side == GD_NONE) return go_along_edge(trail, vertex, predecessor.source);
    const struct gd_side *s = &mesh->side[predecessor.side];
    if (predecessor.source == GD_NONE) {
        struct gd_point bend = gd__trail_side_point(trail, predecessor.side, predecessor.x);
        gd__trail_append_in_face(trail, bend, mesh->side_face[predecessor.side]);
        return gd__stop_at(bend);
    }
    if (gd__source_is_linear(predecessor.source)) return go_to_segment(trail, predecessor);
    if (gd__ray_has_arrived(trail, predecessor.side, predecessor.x, -predecessor.y,
                            predecessor.source))
        return gd__ray_arrive(trail, mesh->side_face[predecessor.side], predecessor.source);
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y,
           height = predecessor.y + py;
    double across = px - predecessor.x, t = predecessor.x;
    if (height > 0)
        t = predecessor.y < py ? predecessor.x + across * (predecessor.y / height)
                               : px - across * (py / height);
    return gd__ray_follow(trail, (struct gd__ray){.side = predecessor.side,
                                                  .source = predecessor.source,
                                                  .t = t,
                                                  .x = predecessor.x,
                                                  .y = predecessor.y});
}

static struct gd__stop go_to_close_seed(struct gd__trail *trail, const struct gd__leg *leg)
{
    struct gd__close close;
    double weight[3];
    gd__point_weights(trail->mesh, &trail->path.points[trail->path.count - 1], leg->face, weight);
    if (!gd__close_find(trail->field, leg->face, weight, GD__FAR, &close))
        return gd__stop_failed(trail, GD_INTERNAL);
    gd__close_trace(trail, leg->face, &close);
    return gd__stop_at_seed(close.seed);
}

/* From a point of an edge or a face by its leg. */
static struct gd__stop go_by_leg(struct gd__trail *trail, const struct gd__leg *leg)
{
    switch (leg->kind) {
    case GD__LEG_VERTEX:
        gd__trail_append_in_face(trail, gd__point_of_vertex(leg->from), leg->face);
        break;
    case GD__LEG_SEED:
        if (trail->field->seeds[leg->from].is_segment)
            return gd__ray_arrive_at_chord(trail, leg->from, leg->face);
        gd__trail_append_seed(trail, leg->from, leg->face);
        return gd__stop_at_seed(leg->from);
    case GD__LEG_CLOSE:
        return go_to_close_seed(trail, leg);
    case GD__LEG_WEDGE:
        return gd__ray_follow(trail, (struct gd__ray){.side = leg->side,
                                                      .source = leg->source,
                                                      .t = leg->parameter,
                                                      .x = leg->x,
                                                      .y = leg->y});
    case GD__LEG_NONE:
        return gd__stop_failed(trail, GD_INTERNAL);
    }
    return gd__stop_at_vertex(leg->from);
}

/* How an attempt at a path begins. */
struct beginning {
    double aside; /* of careful rays, see trail.h; 0: plain ones */
    uint32_t via; /* first to this vertex of `face`; GD_NONE: by the leg */
    uint32_t face;
};

static struct gd__stop go_from_beginning(struct gd__trail *trail, const struct gd_point *point,
                                         const struct gd__leg *first,
                                         const struct beginning *beginning)
{
    if (beginning->via != GD_NONE) {
        gd__trail_append_in_face(trail, gd__point_of_vertex(beginning->via), beginning->face);
        return gd__stop_at_vertex(beginning->via);
    }
    return point->kind == GD_POINT_VERTEX ? gd__stop_at(*point) : go_by_leg(trail, first);
}

/* *seed: the one in which the path ends. */
static void trace_back(struct gd__trail *trail, const struct gd_point *point,
                       const struct gd__leg *first, const struct beginning *beginning,
                       uint32_t *seed)
{
    gd__trail_append(trail, *point, 0);
    if (trail->status) return; /* what follows looks at the last point */
    struct gd__stop stop = go_from_beginning(trail, point, first, beginning);
    while (stop.kind != GD__STOP_SEED && !trail->status) {
        if (!trail->steps_left--) {
            gd__stop_failed(trail, GD_INTERNAL);
        } else if (stop.kind == GD__STOP_VERTEX) {
            trail->vertex = stop.vertex;
            trail->nearest = trail->field->distance[stop.vertex];
            stop = go_from_vertex(trail, stop.vertex);
        } else {
            struct gd__leg leg = gd__field_leg_onward(trail->field, &stop.point, trail->vertex);
            trail->nearest = leg.distance;
            stop = go_by_leg(trail, &leg);
        }
    }
    if (!trail->status) *seed = stop.seed;
}

/* --- the path --------------------------------------------------------------------------------- */

/* One attempt; on success the path is the caller's, its length and the distance agree. */
static enum gd_status try_path(const struct gd_field *field, const struct gd_point *point,
                               const struct gd__leg *leg, const struct beginning *beginning,
                               struct gd_path *out, uint32_t *seed)
{
    const struct gd_mesh *mesh = field->mesh;
    struct gd__trail trail = {.field = field,
                              .mesh = mesh,
                              .snap = beginning->aside > 0 ? 0 : GD_TOL_SNAP,
                              .aside = beginning->aside,
                              .vertex = GD_NONE,
                              .nearest = leg->distance,
                              .steps_left =
                                  2 * ((uint64_t)mesh->edge_count + mesh->vertex_count) + 16};
    uint32_t end = 0;
    trace_back(&trail, point, leg, beginning, &end);
    double offset = field->seeds[end].offset, slack = GD_TOL_CHECK * leg->distance + GD_TOL_BETTER;
    if (!trail.status && !(fabs(trail.path.length + offset - leg->distance) <= slack))
        trail.status = GD_INTERNAL;
    if (trail.status) {
        gd_path_free(&trail.path);
        return trail.status;
    }
    /* has digits that the sum has lost */
    trail.path.length = (leg->distance - offset) * mesh->unit;
    *out = trail.path;
    *seed = end;
    return GD_OK;
}

enum { CAREFUL_ATTEMPTS = 7 };

/* In faces as small as rounding a ray may turn in a circle. The way by a neighbour is as short
 * there, if the length passes the check; a longer one does not. */
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

/* The path whose first leg is known. */
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
