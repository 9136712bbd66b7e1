#include "line/route.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/canonical.h"
#include "mesh/segment.h"
#include "line/unfold.h"

void gd__route_free(struct gd__route *route)
{
    free(route->points);
    *route = (struct gd__route){0};
}

static enum gd_status route_reserve(struct gd__route *route, uint32_t more,
                                    const struct gd_control *control)
{
    return gd__array_extend(&route->points, &route->capacity, (uint64_t)route->count + more,
                            sizeof *route->points, control);
}

static void route_append(struct gd__route *route, const struct gd_point *point)
{
    if (route->count && gd_point_equal(&route->points[route->count - 1], point)) return;
    route->points[route->count++] = *point;
}

enum gd_status gd__route_add(struct gd__route *route, const struct gd_point *point, double run,
                             const struct gd_control *control)
{
    enum gd_status status = route_reserve(route, 1, control);
    if (status) return status;
    route_append(route, point);
    route->length += run;
    return GD_OK;
}

enum gd_status gd__route_join(struct gd__route *route, const struct gd_point *points,
                              uint32_t count, double length, bool backwards,
                              const struct gd_control *control)
{
    enum gd_status status = route_reserve(route, count, control);
    if (status) return status;
    for (uint32_t i = 0; i < count; i++)
        route_append(route, &points[backwards ? count - 1 - i : i]);
    route->length += length;
    return GD_OK;
}

bool gd__point_follows(const struct gd_point *a, const struct gd_point *b)
{
    if (a->kind != b->kind) return a->kind > b->kind;
    if (a->element != b->element) return a->element > b->element;
    for (int k = 0; k < 3; k++)
        if (a->weight[k] != b->weight[k]) return a->weight[k] > b->weight[k];
    return false;
}

void gd__points_reverse(struct gd_point *points, uint32_t count)
{
    for (uint32_t i = 0, j = count; i + 1 < j--; i++) {
        struct gd_point point = points[i];
        points[i] = points[j];
        points[j] = point;
    }
}

double gd__route_run(const struct gd_mesh *mesh, const struct gd_point *a, const struct gd_point *b)
{
    uint32_t face = gd__common_face(mesh, a, b);
    return face == GD_NONE || gd_point_equal(a, b) ? 0 : gd__chord(mesh, face, 0, a, b).length;
}

struct gd_point gd__route_between(const struct gd_mesh *mesh, const struct gd_point *a,
                                  const struct gd_point *b, double part)
{
    uint32_t face = gd__common_face(mesh, a, b);
    double from[3], to[3], at[3];
    gd__point_weights(mesh, a, face, from);
    gd__point_weights(mesh, b, face, to);
    for (int k = 0; k < 3; k++) at[k] = from[k] + part * (to[k] - from[k]);
    return gd__point_of_face(mesh, face, at);
}

enum gd_status gd__route_split(const struct gd_mesh *mesh, struct gd__route *route, double part,
                               const struct gd_control *control, uint32_t *out)
{
    double left = part * route->length, run = 0;
    uint32_t i = 0;
    *out = part < 0.5 ? 0 : route->count - 1;
    if (route->count < 2) return GD_OK;
    for (; i + 1 < route->count; i++, left -= run) {
        run = gd__route_run(mesh, &route->points[i], &route->points[i + 1]);
        if (left <= run) break;
    }
    if (i + 1 == route->count) return GD_OK; /* due to rounding, the length can be beyond the end */
    struct gd_point point = gd__route_between(mesh, &route->points[i], &route->points[i + 1],
                                              left > 0 ? left / run : 0);
    bool is_first = gd_point_equal(&point, &route->points[i]);
    *out = is_first ? i : i + 1;
    if (is_first || gd_point_equal(&point, &route->points[i + 1])) return GD_OK;
    enum gd_status status = route_reserve(route, 1, control);
    if (status) return status;
    memmove(route->points + i + 2, route->points + i + 1,
            (route->count - i - 1) * sizeof *route->points);
    route->points[i + 1] = point;
    route->count++;
    return GD_OK;
}

enum gd_status gd__route_ahead(const struct gd_mesh *mesh, const struct gd_point *points,
                               uint32_t count, double *out)
{
    struct gd__straight part;
    enum gd_status status = gd__unfold(mesh, points, gd__route_bend(points, count, 0) + 1, &part);
    if (!status) *out = part.ahead;
    return status;
}

enum gd_status gd__route_back(const struct gd_mesh *mesh, const struct gd_point *points,
                              uint32_t count, double *out)
{
    struct gd__straight part;
    uint32_t begin = count - 2;
    while (begin > 0 && points[begin].kind == GD_POINT_EDGE) begin--;
    enum gd_status status = gd__unfold(mesh, points + begin, count - begin, &part);
    if (!status) *out = part.back;
    return status;
}

struct gd_path gd__route_take(const struct gd_mesh *mesh, struct gd__route *route)
{
    struct gd_path path = {route->length * mesh->unit, route->count, route->points};
    *route = (struct gd__route){0};
    return path;
}
