#include "line/strip.h"

#include "base/array.h"
#include "base/prefetch.h"
#include "mesh/canonical.h"
#include "mesh/segment.h"

#define AHEAD 8 /* records are prefetched this number of portals ahead */

void gd__strip_free(struct gd__strip *strip)
{
    free(strip->portals);
    *strip = (struct gd__strip){0};
}

/* --- portals ---------------------------------------------------------------------------------- */

enum gd_status gd__strip_push(struct gd__strip *strip, uint32_t side,
                              const struct gd_control *control)
{
    if (!strip->keeps_ways_back && strip->count &&
        strip->portals[strip->count - 1].side == (side ^ 1)) {
        strip->count--;
        return GD_OK;
    }
    enum gd_status status = gd__array_extend(&strip->portals, &strip->capacity, strip->count + 1ULL,
                                             sizeof *strip->portals, control);
    if (!status) strip->portals[strip->count++].side = side;
    return status;
}

/* --- around vertices -------------------------------------------------------------------------- */

/* Returns the position of a face in the fan of one of its corners, counted from the fan's first
 * entry. */
static uint32_t entry_of(const struct gd_mesh *mesh, uint32_t vertex, uint32_t face)
{
    int k = 0;
    while (k < 2 && mesh->origin[mesh->face_side[face][k]] != vertex) k++;
    return gd__fan_entry(mesh, mesh->face_side[face][k]) - mesh->fan_first[vertex];
}

/* Returns the number of faces from one face to another around the vertex. If the boundary is in
 * between, the result is larger than the number of faces in the fan. */
static uint32_t faces_between(const struct gd_mesh *mesh, uint32_t vertex, uint32_t from,
                              uint32_t to, bool counter_clockwise)
{
    uint32_t count = mesh->fan_first[vertex + 1] - mesh->fan_first[vertex];
    bool wraps = counter_clockwise ? to < from : from < to;
    if (wraps && mesh->vertex_kind[vertex] == GD_VERTEX_BOUNDARY) return count + 1;
    return (counter_clockwise ? to + count - from : from + count - to) % count;
}

enum gd_status gd__strip_wind(const struct gd_mesh *mesh, struct gd__strip *strip, uint32_t vertex,
                              uint32_t from_face, uint32_t to_face, bool counter_clockwise,
                              const struct gd_control *control)
{
    const struct gd_fan *fan = &mesh->fan[mesh->fan_first[vertex]];
    uint32_t count = mesh->fan_first[vertex + 1] - mesh->fan_first[vertex];
    uint32_t at = entry_of(mesh, vertex, from_face);
    uint32_t left =
        faces_between(mesh, vertex, at, entry_of(mesh, vertex, to_face), counter_clockwise);
    enum gd_status status = left > count ? GD_INTERNAL : GD_OK;
    for (; left && !status; left--) {
        uint32_t side = counter_clockwise ? fan[(at + 1) % count].side : fan[at].side ^ 1;
        at = (counter_clockwise ? at + 1 : at + count - 1) % count;
        status = gd__strip_push(strip, side, control);
    }
    return status;
}

static enum gd_status pass_vertex(const struct gd_mesh *mesh, struct gd__strip *strip,
                                  uint32_t vertex, uint32_t face, uint32_t next,
                                  const struct gd_control *control)
{
    uint32_t from = entry_of(mesh, vertex, face), to = entry_of(mesh, vertex, next);
    bool counter_clockwise =
        faces_between(mesh, vertex, from, to, true) <= faces_between(mesh, vertex, from, to, false);
    return gd__strip_wind(mesh, strip, vertex, face, next, counter_clockwise, control);
}

/* --- along a route ---------------------------------------------------------------------------- */

/* Appends the portals that lead from a face to the next face of the route around their common
 * point. */
static enum gd_status strip_pass(const struct gd_mesh *mesh, struct gd__strip *strip,
                                 const struct gd_point *point, uint32_t face, uint32_t next,
                                 const struct gd_control *control)
{
    uint32_t side = 2 * point->element;
    if (point->kind == GD_POINT_VERTEX)
        return pass_vertex(mesh, strip, point->element, face, next, control);
    if (point->kind == GD_POINT_FACE) return GD_INTERNAL;
    return gd__strip_push(strip, mesh->side_face[side] == next ? side : side ^ 1, control);
}

enum gd_status gd__strip_along(const struct gd_mesh *mesh, const struct gd__route *route,
                               struct gd__strip *strip, const struct gd_control *control)
{
    const struct gd_point *points = route->points;
    uint32_t face = gd__common_face(mesh, &points[0], &points[1]);
    enum gd_status status = face == GD_NONE ? GD_INTERNAL : GD_OK;
    strip->from = points[0];
    strip->to = points[route->count - 1];
    strip->face = face;
    strip->count = 0;
    for (uint32_t i = 1; i + 1 < route->count && !status; i++) {
        if (gd__face_contains(mesh, face, &points[i + 1])) continue;
        uint32_t next = gd__common_face(mesh, &points[i], &points[i + 1]);
        status = next == GD_NONE ? GD_INTERNAL
                                 : strip_pass(mesh, strip, &points[i], face, next, control);
        face = next;
    }
    return status;
}

/* --- in the plane ----------------------------------------------------------------------------- */

static void strip_trim(const struct gd_mesh *mesh, struct gd__strip *strip)
{
    uint32_t skip = 0;
    while (strip->count &&
           gd__point_is_on_edge(mesh, &strip->to, strip->portals[strip->count - 1].side >> 1))
        strip->count--;
    while (skip < strip->count &&
           gd__point_is_on_edge(mesh, &strip->from, strip->portals[skip].side >> 1))
        skip++;
    if (!skip) return;
    strip->face = mesh->side_face[strip->portals[skip - 1].side];
    strip->count -= skip;
    for (uint32_t i = 0; i < strip->count; i++)
        strip->portals[i].side = strip->portals[i + skip].side;
}

GD__PREFETCH prefetch_side(const struct gd_mesh *mesh, uint32_t side)
{
    __builtin_prefetch(&mesh->side[side]);
    __builtin_prefetch(&mesh->side_face[side]);
}

enum gd_status gd__strip_lay(const struct gd_mesh *mesh, struct gd__strip *strip)
{
    strip_trim(mesh, strip);
    struct gd__portal last = gd__strip_entrance(mesh, strip);
    strip->begin = gd__portal_place(mesh, &last, &strip->from);
    for (uint32_t i = 0; i < strip->count; i++) {
        if (i + AHEAD < strip->count) prefetch_side(mesh, strip->portals[i + AHEAD].side);
        if (!gd__portal_next(mesh, &last, &strip->portals[i])) return GD_INTERNAL;
        last = strip->portals[i];
    }
    if (!gd__face_contains(mesh, mesh->side_face[last.side], &strip->to)) return GD_INTERNAL;
    strip->end = gd__portal_place(mesh, &last, &strip->to);
    return GD_OK;
}

/* --- the funnel ------------------------------------------------------------------------------- */

/* Returns twice the area of abc: > 0 if c lies to the left of ab. */
static double strip_area(struct gd__local a, struct gd__local b, struct gd__local c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool is_same(struct gd__local a, struct gd__local b)
{
    return a.x == b.x && a.y == b.y;
}

/* The funnel: the points that are visible from the apex through all portals so far. It lies between
 * the rays from the apex through `left` and `right`, which are ends of portals. */
struct funnel {
    struct gd__local apex, left, right;
    uint32_t left_gate, right_gate;
};

/* Moves the funnel's right end to the right end of portal i, if that narrows the funnel. Returns
 * false if the new end would cross the left end. If the right end is the apex, the funnel has no
 * right bound. */
static bool tighten_right(struct funnel *f, struct gd__local to, uint32_t i)
{
    bool is_apex = is_same(f->right, f->apex), stays = is_same(to, f->apex);
    if (!is_apex && strip_area(f->apex, f->right, to) < 0) return true;
    if (!stays && !is_same(f->left, f->apex) && strip_area(f->apex, f->left, to) >= 0) return false;
    f->right = to;
    f->right_gate = i;
    return true;
}

static bool tighten_left(struct funnel *f, struct gd__local to, uint32_t i)
{
    bool is_apex = is_same(f->left, f->apex), stays = is_same(to, f->apex);
    if (!is_apex && strip_area(f->apex, f->left, to) > 0) return true;
    if (!stays && !is_same(f->right, f->apex) && strip_area(f->apex, f->right, to) <= 0)
        return false;
    f->left = to;
    f->left_gate = i;
    return true;
}

uint32_t gd__strip_corners(const struct gd__strip *strip, struct gd__corner *out)
{
    struct funnel f = {strip->begin, strip->begin, strip->begin, 0, 0};
    uint32_t count = 0;
    for (uint32_t i = 0; i <= strip->count; i++) {
        struct gd__local right = i < strip->count ? strip->portals[i].right : strip->end,
                         left = i < strip->count ? strip->portals[i].left : strip->end;
        struct gd__corner corner;
        if (!tighten_right(&f, right, i))
            corner = (struct gd__corner){f.left_gate, true, f.left};
        else if (!tighten_left(&f, left, i))
            corner = (struct gd__corner){f.right_gate, false, f.right};
        else
            continue;
        if (corner.portal == strip->count) break; /* this corner is the end of the line */
        out[count++] = corner;
        i = corner.portal;
        f = (struct funnel){corner.at, corner.at, corner.at, i, i};
    }
    return count;
}

/* --- the line --------------------------------------------------------------------------------- */

/* Returns the point where the line from a to b crosses a portal. */
static struct gd_point strip_crossing(const struct gd_mesh *mesh, const struct gd__portal *portal,
                                      struct gd__local a, struct gd__local b)
{
    double left = strip_area(a, b, portal->left), right = strip_area(a, b, portal->right);
    double part = left > 0 && right < 0 ? left / (left - right) : fabs(right) < fabs(left) ? 1 : 0;
    return gd__point_of_edge(mesh, portal->side >> 1, portal->side & 1 ? 1 - part : part);
}

static struct gd_point strip_point_of(const struct gd_mesh *mesh, const struct gd__strip *strip,
                                      const struct gd__corner *corner)
{
    uint32_t side = strip->portals[corner->portal].side;
    return gd__point_of_vertex(mesh->origin[corner->is_left ? side : side ^ 1]);
}

enum gd_status gd__strip_line(const struct gd_mesh *mesh, const struct gd__strip *strip,
                              const struct gd__corner *corners, uint32_t corner_count,
                              struct gd__route *out, const struct gd_control *control)
{
    enum gd_status status = gd__route_add(out, &strip->from, 0, control);
    struct gd__local a = strip->begin;
    for (uint32_t k = 0, i = 0; k <= corner_count && !status; k++) {
        bool is_end = k == corner_count;
        struct gd__local b = is_end ? strip->end : corners[k].at;
        uint32_t stop = is_end ? strip->count : corners[k].portal;
        for (; i < stop && !status; i++) {
            struct gd_point point = strip_crossing(mesh, &strip->portals[i], a, b);
            status = gd__route_add(out, &point, 0, control);
        }
        struct gd_point point = is_end ? strip->to : strip_point_of(mesh, strip, &corners[k]);
        if (!status) status = gd__route_add(out, &point, hypot(b.x - a.x, b.y - a.y), control);
        a = b;
        i = stop + 1;
    }
    return status;
}
