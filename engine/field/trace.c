#include "field/close_seed.h"
#include "field/ray.h"

#include <stdlib.h>

#include "mesh/canonical.h"
#include "mesh/segment.h"

/* Back-tracing: follows the point's last leg to its pseudo-source, and then the predecessors to a
 * seed. */

/* --- from stop to stop ------------------------------------------------------------------------ */

static struct gd__stop go_along_edge(struct gd__path_builder *builder, uint32_t vertex,
                                     uint32_t source)
{
    const struct gd_mesh *mesh = builder->mesh;
    if (source < mesh->vertex_count) {
        gd__path_builder_append(builder, gd__point_of_vertex(source),
                                mesh->side[gd__side_between(mesh, vertex, source)].length);
        return gd__stop_at_vertex(source);
    }
    if (source == GD_NONE) /* the vertex is unreached */
        return gd__stop_failed(builder, GD_INTERNAL);
    const struct gd_point *seed = &builder->field->seeds[source - mesh->vertex_count].point;
    if (seed->kind == GD_POINT_EDGE) {
        uint32_t side = 2 * seed->element;
        gd__path_builder_append_in_face(
            builder, *seed, mesh->side_face[gd__side_is_boundary(mesh, side) ? side ^ 1 : side]);
    }
    return gd__stop_at_seed(source - mesh->vertex_count);
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
static struct gd__stop go_to_segment(struct gd__path_builder *builder,
                                     struct gd__predecessor predecessor)
{
    const struct gd_mesh *mesh = builder->mesh;
    const struct gd_side *s = &mesh->side[predecessor.side];
    uint32_t face = mesh->side_face[predecessor.side];
    if (is_along(builder, predecessor.source, GD_NONE, face))
        return gd__ray_arrive_at_chord(builder,
                                       gd__field_seed_of(builder->field, predecessor.source), face);
    double t =
        s->left_length * s->left_x + predecessor.x * (s->left_length * s->left_y / predecessor.y);
    return gd__ray_follow(builder, (struct gd__ray){predecessor.side, predecessor.source, t,
                                                    predecessor.x, predecessor.y});
}

/* Follows the leg from a vertex to its predecessor. */
static struct gd__stop go_from_vertex(struct gd__path_builder *builder, uint32_t vertex)
{
    const struct gd_mesh *mesh = builder->mesh;
    struct gd__predecessor predecessor = builder->field->predecessor[vertex];
    if (predecessor.side == GD_NONE) return go_along_edge(builder, vertex, predecessor.source);
    const struct gd_side *s = &mesh->side[predecessor.side];
    if (predecessor.source == GD_NONE) {
        struct gd_point bend =
            gd__path_builder_side_point(builder, predecessor.side, predecessor.x);
        gd__path_builder_append_in_face(builder, bend, mesh->side_face[predecessor.side]);
        return gd__stop_at(bend);
    }
    if (gd__source_is_linear(predecessor.source)) return go_to_segment(builder, predecessor);
    if (gd__ray_has_arrived(builder, predecessor.side, predecessor.x, -predecessor.y,
                            predecessor.source))
        return gd__ray_arrive(builder, mesh->side_face[predecessor.side], predecessor.source);
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y,
           height = predecessor.y + py;
    double across = px - predecessor.x, t = predecessor.x;
    if (height > 0)
        t = predecessor.y < py ? predecessor.x + across * (predecessor.y / height)
                               : px - across * (py / height);
    return gd__ray_follow(builder, (struct gd__ray){predecessor.side, predecessor.source, t,
                                                    predecessor.x, predecessor.y});
}

static struct gd__stop go_to_close_seed(struct gd__path_builder *builder, const struct gd__leg *leg)
{
    struct gd__close_seed close;
    double weight[3];
    gd__point_weights(builder->mesh, &builder->path.points[builder->path.count - 1], leg->face,
                      weight);
    if (!gd__close_seed_find(builder->field, leg->face, weight, GD__FAR, &close))
        return gd__stop_failed(builder, GD_INTERNAL);
    gd__close_seed_trace(builder, leg->face, &close);
    return gd__stop_at_seed(close.seed);
}

/* Follows the leg from a point of an edge or a face. */
static struct gd__stop go_by_leg(struct gd__path_builder *builder, const struct gd__leg *leg)
{
    switch (leg->kind) {
    case GD__LEG_VERTEX:
        gd__path_builder_append_in_face(builder, gd__point_of_vertex(leg->from), leg->face);
        break;
    case GD__LEG_SEED:
        if (builder->field->seeds[leg->from].is_segment)
            return gd__ray_arrive_at_chord(builder, leg->from, leg->face);
        gd__path_builder_append_seed(builder, leg->from, leg->face);
        return gd__stop_at_seed(leg->from);
    case GD__LEG_CLOSE:
        return go_to_close_seed(builder, leg);
    case GD__LEG_WEDGE:
        return gd__ray_follow(
            builder, (struct gd__ray){leg->side, leg->source, leg->parameter, leg->x, leg->y});
    case GD__LEG_NONE:
        return gd__stop_failed(builder, GD_INTERNAL);
    }
    return gd__stop_at_vertex(leg->from);
}

/* Parameters of one attempt to trace a path. */
struct beginning {
    double aside; /* gd__path_builder.aside */
    /* the path first goes to this vertex of `face`; GD_NONE means that it follows its leg */
    uint32_t via;
    uint32_t face;
};

static struct gd__stop go_from_beginning(struct gd__path_builder *builder,
                                         const struct gd_point *point, const struct gd__leg *first,
                                         const struct beginning *beginning)
{
    if (beginning->via != GD_NONE) {
        gd__path_builder_append_in_face(builder, gd__point_of_vertex(beginning->via),
                                        beginning->face);
        return gd__stop_at_vertex(beginning->via);
    }
    return point->kind == GD_POINT_VERTEX ? gd__stop_at(*point) : go_by_leg(builder, first);
}

/* Traces a path back to a seed, whose number becomes *seed. */
static void trace_back(struct gd__path_builder *builder, const struct gd_point *point,
                       const struct gd__leg *first, const struct beginning *beginning,
                       uint32_t *seed)
{
    gd__path_builder_append(builder, *point, 0);
    if (builder->status) return; /* the next leg starts from the last point */
    struct gd__stop stop = go_from_beginning(builder, point, first, beginning);
    while (stop.kind != GD__STOP_SEED && !builder->status) {
        if (!builder->steps_left--) {
            gd__stop_failed(builder, GD_INTERNAL);
        } else if (stop.kind == GD__STOP_VERTEX) {
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
