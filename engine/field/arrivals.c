#include "field/arrivals.h"

#include <stdlib.h>

#include "base/array.h"
#include "field/sources.h"

/* The last leg of each shortest path is a straight line from a source (sources.h) through one of
 * the point's faces. A path through a corner where no shortest path bends is longer by more than
 * the tie tolerance. If two paths of nearly equal length arrive from different directions, both are
 * equally long at a nearby point. The distance to that point is the difference of the lengths,
 * divided by twice the sine of half the angle between the directions. */

struct arrival {
    double distance;
    double turn; /* direction from the point back along the path, as a turn around the point */
};

struct arrivals {
    const struct gd_field *field;
    const struct gd_point *point;
    struct gd__sources sources;
    struct arrival *arrival;
    uint32_t count, capacity;
    /* total turn around the point; INFINITY at the boundary, where turns are not periodic */
    double total;
};

/* Returns true if the point is so near to the source that the straight path is the only shortest
 * path. No other path of nearly equal length can then arrive at a distinct angle. */
static bool is_beside(const struct gd__source *source, struct gd__local to, double slack)
{
    double away = hypot(to.x, to.y);
    return !source->linear &&
           away <= fmax(slack, 2 * GD_TOL_CUT / GD_TOL_CUT_ANGLE * (source->sigma + away));
}

static bool source_sees(const struct gd__source *source, struct gd__local at, double slack)
{
    if (!source->has_sector) return true;
    return source->left.x * (at.x - source->left_at.x) +
                   source->left.y * (at.y - source->left_at.y) >=
               -slack &&
           source->right.x * (at.x - source->right_at.x) +
                   source->right.y * (at.y - source->right_at.y) >=
               -slack;
}

static struct gd__local direction_to_source(const struct gd__source *source, struct gd__local at)
{
    if (source->linear) return (struct gd__local){-source->gradient.x, -source->gradient.y};
    return (struct gd__local){source->at.x - at.x, source->at.y - at.y};
}

/* Adds the paths that arrive through a face. The face's directions at the point begin at the
 * direction of side k, whose turn is `begin`, and cover the angle `extent`. */
static enum gd_status add_face(struct arrivals *arrivals, uint32_t face, int k, double begin,
                               double extent)
{
    struct gd__sources *sources = &arrivals->sources;
    enum gd_status status = gd__sources_gather(arrivals->field, face, GD__FAR, sources);
    if (status) return status;
    struct gd__local at = gd__point_local(arrivals->field->mesh, face, arrivals->point),
                     zero = sources->frame.along[k];
    double slack = gd__stored_slack(sources->frame.size);
    for (uint32_t i = 0; i < sources->count && !status; i++) {
        const struct gd__source *source = &sources->source[i];
        struct gd__local to = direction_to_source(source, at);
        double angle = atan2(zero.x * to.y - zero.y * to.x, zero.x * to.x + zero.y * to.y);
        if (angle < -GD_TOL_CUT_ANGLE) angle += 2 * M_PI;
        if (is_beside(source, to, slack) || angle > extent + GD_TOL_CUT_ANGLE ||
            !source_sees(source, at, slack))
            continue;
        struct arrival found = {gd__source_distance(source, at), begin + angle};
        status = gd__array_append(&arrivals->arrival, &arrivals->count, &arrivals->capacity, &found,
                                  sizeof found);
    }
    return status;
}

static enum gd_status add_fan(struct arrivals *arrivals, uint32_t vertex)
{
    const struct gd_mesh *mesh = arrivals->field->mesh;
    enum gd_status status = GD_OK;
    arrivals->total = 0;
    for (uint32_t i = mesh->fan_first[vertex]; i < mesh->fan_first[vertex + 1] && !status; i++) {
        const struct gd_side *s = &mesh->side[mesh->fan[i].side];
        uint32_t face = mesh->side_face[mesh->fan[i].side];
        double extent = atan2(s->left_y, s->left_x);
        int k = gd__place_of_side(mesh->face_side[face], mesh->fan[i].side);
        status = add_face(arrivals, face, k, mesh->fan[i].angle, extent);
        arrivals->total = mesh->fan[i].angle + extent;
    }
    if (mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY) arrivals->total = INFINITY;
    return status;
}

static enum gd_status add_sides(struct arrivals *arrivals, uint32_t edge)
{
    const struct gd_mesh *mesh = arrivals->field->mesh;
    enum gd_status status = GD_OK;
    for (uint32_t side = 2 * edge; side < 2 * edge + 2 && !status; side++) {
        uint32_t face = mesh->side_face[side];
        if (face == GD_NONE)
            arrivals->total = INFINITY;
        else
            status = add_face(arrivals, face, gd__place_of_side(mesh->face_side[face], side),
                              (side & 1) * M_PI, M_PI);
    }
    return status;
}

static enum gd_status gather_arrivals(struct arrivals *arrivals)
{
    const struct gd_point *point = arrivals->point;
    switch (point->kind) {
    case GD_POINT_VERTEX:
        return add_fan(arrivals, point->element);
    case GD_POINT_EDGE:
        return add_sides(arrivals, point->element);
    case GD_POINT_FACE:
        return add_face(arrivals, point->element, 0, 0, 2 * M_PI);
    }
    return GD_OK;
}

static bool is_another(const struct arrivals *arrivals, const struct arrival *a,
                       const struct arrival *b)
{
    double apart = fabs(a->turn - b->turn);
    if (isfinite(arrivals->total)) apart = fabs(remainder(apart, arrivals->total));
    if (apart < GD_TOL_CUT_ANGLE) return false;
    double away = fabs(a->distance - b->distance) / (2 * sin(0.5 * fmin(apart, M_PI)));
    return away <= GD_TOL_CUT * fmin(a->distance, b->distance);
}

/* Returns true if several shortest paths arrive. The shortest path, whose length is `distance`,
 * must be among the arrivals, except at a seed, where this path has no direction. */
static bool are_several(const struct arrivals *arrivals, double distance)
{
    const struct arrival *best = NULL;
    bool several = false;
    for (uint32_t i = 0; i < arrivals->count; i++)
        if (!best || arrivals->arrival[i].distance < best->distance) best = &arrivals->arrival[i];
    if (!best || best->distance > distance * (1 + GD_TOL_CUT)) return false;
    for (uint32_t i = 0; i < arrivals->count; i++)
        several |= is_another(arrivals, best, &arrivals->arrival[i]);
    return several;
}

enum gd_status gd__field_is_cut(const struct gd_field *field, const struct gd_point *point,
                                bool *out)
{
    struct arrivals arrivals = {.field = field, .point = point, .total = 2 * M_PI};
    struct gd__leg_key way;
    gd__field_leg_key(field, point, &way);
    enum gd_status status =
        way.distance > 0 && way.kind != GD__LEG_NONE ? gather_arrivals(&arrivals) : GD_OK;
    *out = !status && are_several(&arrivals, way.distance);
    gd__sources_destroy(&arrivals.sources);
    free(arrivals.arrival);
    return status;
}

enum gd_status gd__field_path_is_cut(const struct gd_field *field, const struct gd_path *path,
                                     bool *out)
{
    enum gd_status status = gd__field_is_cut(field, &path->points[0], out);
    for (uint32_t i = 1; i < path->count && !status && !*out; i++)
        if (path->points[i].kind == GD_POINT_VERTEX)
            status = gd__field_is_cut(field, &path->points[i], out);
    return status;
}
