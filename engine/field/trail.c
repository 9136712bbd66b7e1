#include "field/trail.h"

#include <stdlib.h>

#include "mesh/canonical.h"

enum { CAPACITY = 128 }; /* points that there is room for to begin with */

bool gd__trail_grow(struct gd__trail *trail)
{
    uint32_t capacity = trail->capacity ? 2 * trail->capacity : CAPACITY;
    struct gd_point *points = realloc(trail->path.points, sizeof *points * (size_t)capacity);
    if (!points) {
        trail->status = GD_NO_MEMORY;
        return false;
    }
    trail->path.points = points;
    trail->capacity = capacity;
    return true;
}

/* The same point, or one that rounding made of it: where a ray leaves the edge that it begins
 * on. */
static bool is_same_place(const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind != GD_POINT_EDGE || b->kind != GD_POINT_EDGE || a->element != b->element)
        return gd_point_equal(a, b);
    return fabs(a->weight[0] - b->weight[0]) <= GD_TOL_ON_BORDER;
}

static void push(struct gd__trail *trail, struct gd_point point, double length)
{
    if (!gd__trail_reserve(trail)) return;
    trail->path.points[trail->path.count++] = point;
    trail->path.length += length;
}

void gd__trail_append(struct gd__trail *trail, struct gd_point point, double length)
{
    struct gd_path *path = &trail->path;
    if (trail->status || (path->count && is_same_place(&path->points[path->count - 1], &point)))
        return;
    push(trail, point, length);
}

/* Differences of weights, in the frame of the nearest corner, keep short segments exact. */
double gd__trail_run(const struct gd__trail *trail, const struct gd_point *point, uint32_t face)
{
    double from[3], to[3];
    gd__point_weights(trail->mesh, &trail->path.points[trail->path.count - 1], face, from);
    gd__point_weights(trail->mesh, point, face, to);
    return gd__local_length(gd__way_in_face(trail->mesh, face, gd__main_corner(from), from, to));
}

void gd__trail_append_in_face(struct gd__trail *trail, struct gd_point point, uint32_t face)
{
    if (!trail->status) gd__trail_append(trail, point, gd__trail_run(trail, &point, face));
}

void gd__trail_append_seed(struct gd__trail *trail, uint32_t seed, uint32_t face)
{
    struct gd_point point = trail->field->seeds[seed].point;
    if (trail->status || gd_point_equal(&trail->path.points[trail->path.count - 1], &point)) return;
    push(trail, point, gd__trail_run(trail, &point, face));
}

struct gd_point gd__trail_side_point(const struct gd__trail *trail, uint32_t side, double t)
{
    const struct gd_mesh *mesh = trail->mesh;
    double length = mesh->side[side].length;
    if (t <= trail->snap * length) return gd__point_of_vertex(mesh->origin[side]);
    if (t >= (1 - trail->snap) * length) return gd__point_of_vertex(mesh->origin[side ^ 1]);
    return gd__point_within_side(side, t / length);
}
