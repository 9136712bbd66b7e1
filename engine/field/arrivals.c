#include "field/arrivals.h"

#include <stdlib.h>

#include "field/array.h"
#include "field/sources.h"

/* Each shortest path's last leg is a source (sources.h) that sees the point through the face that
 * the leg lies in; a way over a corner at which no path bends is longer by more than a tie. Two
 * that are nearly as long and come from directions an angle apart are as long at a place that is
 * their difference over twice the sine of half of that angle away. */

struct arrival {
    double distance;
    double turn; /* of the direction that it comes from, round the point */
};

struct arrivals {
    const struct gd_field *field;
    const struct gd_point *point;
    struct gd__sources sources;
    struct arrival *arrival;
    uint32_t count, capacity;
    double total; /* the turn all around; at the boundary no turn is the same as another */
};

/* Next to a source the way round by it is as short as any, and no other: so near that the angle
 * between them can't make up for it. */
static bool is_beside(const struct gd__source *source, struct gd__local to, double slack)
{
    double away = hypot(to.x, to.y);
    return !source->linear &&
           away <= fmax(slack, 2 * GD_TOL_CUT / GD_TOL_CUT_ANGLE * (source->sigma + away));
}

static bool sees(const struct gd__source *source, struct gd__local at, double slack)
{
    if (!source->has_sector) return true;
    return source->left.x * (at.x - source->left_at.x) +
                   source->left.y * (at.y - source->left_at.y) >=
               -slack &&
           source->right.x * (at.x - source->right_at.x) +
                   source->right.y * (at.y - source->right_at.y) >=
               -slack;
}

/* The direction from the point to where the source is. */
static struct gd__local towards(const struct gd__source *source, struct gd__local at)
{
    if (source->linear) return (struct gd__local){-source->gradient.x, -source->gradient.y};
    return (struct gd__local){source->at.x - at.x, source->at.y - at.y};
}

/* What comes through a face, whose directions at the point are `extent` wide from its side k, which
 * has the turn `begin`. */
static enum gd_status add_face(struct arrivals *arrivals, uint32_t face, int k, double begin,
                               double extent)
{
    struct gd__sources *sources = &arrivals->sources;
    double weight[3];
    enum gd_status status = gd__sources_gather(arrivals->field, face, GD__FAR, sources);
    if (status) return status;
    gd__point_weights(arrivals->field->mesh, arrivals->point, face, weight);
    struct gd__local at = gd__face_local(arrivals->field->mesh,
                                         arrivals->field->mesh->face_side[face][0], weight),
                     zero = sources->frame.along[k];
    double slack = gd__stored_slack(sources->frame.size);
    for (uint32_t i = 0; i < sources->count; i++) {
        const struct gd__source *source = &sources->source[i];
        struct gd__local to = towards(source, at);
        double angle = atan2(zero.x * to.y - zero.y * to.x, zero.x * to.x + zero.y * to.y);
        if (angle < -GD_TOL_CUT_ANGLE) angle += 2 * M_PI;
        if (is_beside(source, to, slack) || angle > extent + GD_TOL_CUT_ANGLE ||
            !sees(source, at, slack))
            continue;
        struct arrival *grown = gd__array_reserve(arrivals->arrival, &arrivals->capacity,
                                                  arrivals->count + 1, sizeof *grown);
        if (!grown) return GD_NO_MEMORY;
        arrivals->arrival = grown;
        grown[arrivals->count++] = (struct arrival){gd__source_distance(source, at), begin + angle};
    }
    return GD_OK;
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
        int k = 0;
        while (mesh->face_side[face][k] != mesh->fan[i].side) k++;
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
        int k = 0;
        if (gd__side_is_boundary(mesh, side)) {
            arrivals->total = INFINITY;
            continue;
        }
        while (mesh->face_side[mesh->side_face[side]][k] != side) k++;
        status = add_face(arrivals, mesh->side_face[side], k, (side & 1) * M_PI, M_PI);
    }
    return status;
}

static enum gd_status gather(struct arrivals *arrivals)
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

/* The shortest one has to be among them: at the seed it has no direction. */
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
    struct gd__way way;
    gd__field_way(field, point, &way);
    enum gd_status status =
        way.distance > 0 && way.kind != GD__LEG_NONE ? gather(&arrivals) : GD_OK;
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
