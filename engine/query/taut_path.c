#include "query/taut_path.h"

#include "base/tolerance.h"
#include "line/straighten.h"
#include "mesh/canonical.h"

/* Converts the guide's path to a route. A step of the path runs along an edge or straight across an
 * edge. For a step across an edge, any point of the edge can be added to the route, because
 * straightening depends only on the strip of faces. */
static enum gd_status taut_path_walk(const struct gd__guide *guide, const struct gd_point *from,
                                     const struct gd_point *to, const struct gd_control *control,
                                     struct gd__route *route)
{
    enum gd_status status = gd__route_add(route, from, 0, control);
    for (uint32_t v = gd__guide_first(guide, from); v != GD_NONE && !status;
         v = guide->node[v].parent) {
        const struct gd_point vertex = gd__point_of_vertex(v);
        status = gd__route_add(route, &vertex, 0, control);
        if (guide->node[v].across == GD_NONE || status) continue;
        const struct gd_side *s = &guide->mesh->side[guide->mesh->fan[guide->node[v].across].side];
        const struct gd_point middle = gd__point_of_edge(guide->mesh, s->right >> 1, 0.5);
        status = gd__route_add(route, &middle, 0, control);
    }
    return status ? status : gd__route_add(route, to, 0, control);
}

enum gd_status gd__taut_path_length(const struct gd__guide *guide, const struct gd_point *from,
                                    const struct gd_point *to, const struct gd_control *control,
                                    double *out)
{
    struct gd__straightener straightener = {.mesh = guide->mesh, .control = control};
    struct gd__route route = {0};
    double length;
    enum gd_status status = taut_path_walk(guide, from, to, control, &route);
    if (!status) status = gd__straighten_length(&straightener, &route, GD_TOL_TETHER, &length);
    gd__route_free(&route);
    gd__straightener_free(&straightener);
    if (!status) *out = length;
    return status;
}
