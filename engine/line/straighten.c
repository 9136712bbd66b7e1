#include "line/straighten.h"

#include <stdlib.h>

#include "base/array.h"
#include "base/tolerance.h"
#include "mesh/canonical.h"
#include "line/turn.h"

/* Number of portals that are unfolded between two checks of the control. This takes well under a
 * millisecond. */
enum { LOOK = 16384 };

void gd__straightener_free(struct gd__straightener *straightener)
{
    gd__strip_free(&straightener->strip);
    gd__strip_free(&straightener->other);
    gd__route_free(&straightener->line);
    free(straightener->corners);
    *straightener = (struct gd__straightener){0};
}

/* --- bends ------------------------------------------------------------------------------------ */

struct gd__bend gd__bend_of_turns(const struct gd_mesh *mesh, const struct gd_point *at,
                                  double back, double ahead)
{
    double total = gd__turn_total(mesh, at), right = ahead - back;
    if (!gd__turn_is_closed(mesh, at))
        return right < 0 ? (struct gd__bend){INFINITY, -right} : (struct gd__bend){right, INFINITY};
    right = right < 0 ? right + total : right;
    return (struct gd__bend){right, total - right};
}

/* --- corners ---------------------------------------------------------------------------------- */

/* The row of a corner: consecutive portals that all have the corner's vertex as their left end, or
 * all as their right end. */
struct row {
    uint32_t vertex, first, last;
};

static uint32_t straighten_end_of(const struct gd_mesh *mesh, const struct gd__portal *portal,
                                  bool is_left)
{
    return mesh->origin[is_left ? portal->side : portal->side ^ 1];
}

static struct row straighten_row_of(const struct gd_mesh *mesh, const struct gd__strip *strip,
                                    const struct gd__corner *corner)
{
    struct row row = {straighten_end_of(mesh, &strip->portals[corner->portal], corner->is_left),
                      corner->portal, corner->portal};
    while (row.first > 0 &&
           straighten_end_of(mesh, &strip->portals[row.first - 1], corner->is_left) == row.vertex)
        row.first--;
    while (row.last + 1 < strip->count &&
           straighten_end_of(mesh, &strip->portals[row.last + 1], corner->is_left) == row.vertex)
        row.last++;
    return row;
}

/* Returns the portal before a portal. Before the first portal, this is side 0 of the strip's first
 * face. */
static struct gd__portal gate_before(const struct gd_mesh *mesh, const struct gd__strip *strip,
                                     uint32_t portal)
{
    return portal > 0 ? strip->portals[portal - 1] : gd__strip_entrance(mesh, strip);
}

/* Returns the turn of a direction at a vertex. The direction is given in the plane of the strip,
 * and leads into the portal's face. */
static double turn_of(const struct gd_mesh *mesh, uint32_t vertex, const struct gd__portal *portal,
                      struct gd__local way)
{
    const struct gd_point at = gd__point_of_vertex(vertex);
    struct gd__local u = portal->along;
    return gd__turn_in_face(mesh, &at, portal->side, way.x * u.x + way.y * u.y,
                            way.y * u.x - way.x * u.y);
}

/* The state of a corner. TAUT: the line cannot be shortened there. LOOSE: the line would be shorter
 * on the other side of the vertex. WOUND: the strip winds around the vertex more than once. */
enum hold { HOLD_TAUT, HOLD_LOOSE, HOLD_WOUND };

/* Returns the state of a corner. `from` and `to` are the corner's neighbours on the line. The angle
 * of the line at the vertex, measured within the strip, is at least pi. But this angle is computed
 * only up to whole revolutions around the vertex. So if the computed angle is less than pi, the
 * strip contains a whole revolution. */
static enum hold hold_of(const struct gd_mesh *mesh, const struct gd__strip *strip,
                         const struct gd__corner *corner, const struct row *row,
                         struct gd__local from, struct gd__local to)
{
    struct gd__portal in = gate_before(mesh, strip, row->first);
    struct gd__local at = corner->at;
    const struct gd_point vertex = gd__point_of_vertex(row->vertex);
    if (!gd__turn_is_closed(mesh, &vertex)) return HOLD_TAUT;
    double back = turn_of(mesh, row->vertex, &in, (struct gd__local){from.x - at.x, from.y - at.y}),
           ahead = turn_of(mesh, row->vertex, &strip->portals[row->last],
                           (struct gd__local){to.x - at.x, to.y - at.y});
    struct gd__bend bend = gd__bend_of_turns(mesh, &vertex, back, ahead);
    double inside = corner->is_left ? bend.right : bend.left,
           other = corner->is_left ? bend.left : bend.right;
    uint32_t faces = mesh->fan_first[row->vertex + 1] - mesh->fan_first[row->vertex],
             portals = row->last - row->first + 1;
    /* a whole revolution has one portal less if the line runs along an edge to the vertex and
       back */
    bool is_whole_turn = inside < M_PI - GD_TOL_BEND && portals + 1 >= faces;
    if (is_whole_turn && portals >= faces) return HOLD_WOUND;
    return is_whole_turn || other < M_PI - GD_TOL_BEND ? HOLD_LOOSE : HOLD_TAUT;
}

/* --- rounds ----------------------------------------------------------------------------------- */

/* Copies portals [begin, end). */
static enum gd_status copy_gates(struct gd__straightener *s, uint32_t begin, uint32_t end)
{
    enum gd_status status = GD_OK;
    for (uint32_t i = begin; i < end && !status; i++)
        status = gd__strip_push(&s->other, s->strip.portals[i].side, s->control);
    return status;
}

/* Moves the strip to the other side of a corner. A strip that winds around the vertex stays on its
 * side, but one revolution is removed. */
static enum gd_status go_round(struct gd__straightener *s, const struct gd__corner *corner,
                               const struct row *row, enum hold hold)
{
    uint32_t from = s->mesh->side_face[s->strip.portals[row->first].side ^ 1],
             to = s->mesh->side_face[s->strip.portals[row->last].side];
    bool counter_clockwise = corner->is_left == (hold == HOLD_WOUND);
    return gd__strip_wind(s->mesh, &s->other, row->vertex, from, to, counter_clockwise, s->control);
}

/* Moves the strip to the other side of its loose corners, and writes the new strip to s->other. If
 * the rows of two corners overlap, only the first corner is moved in this round. */
static enum gd_status straighten_relax(struct gd__straightener *s, uint32_t corner_count,
                                       bool *has_moved)
{
    const struct gd__strip *strip = &s->strip;
    const struct gd__corner *corners = s->corners;
    enum gd_status status = GD_OK;
    uint32_t done = 0;
    *has_moved = false;
    s->other.count = 0;
    s->other.from = strip->from, s->other.to = strip->to, s->other.face = strip->face;
    for (uint32_t k = 0; k < corner_count && !status; k++) {
        struct row row = straighten_row_of(s->mesh, strip, &corners[k]);
        struct gd__local from = k ? corners[k - 1].at : strip->begin,
                         to = k + 1 < corner_count ? corners[k + 1].at : strip->end;
        if (row.first < done) continue;
        enum hold hold = hold_of(s->mesh, strip, &corners[k], &row, from, to);
        if (hold == HOLD_TAUT) continue;
        status = copy_gates(s, done, row.first);
        if (!status) status = go_round(s, &corners[k], &row, hold);
        done = row.last + 1;
        *has_moved = true;
    }
    if (!status && *has_moved) status = copy_gates(s, done, strip->count);
    return status;
}

static double straighten_length_of(const struct gd__strip *strip, const struct gd__corner *corners,
                                   uint32_t count)
{
    struct gd__local a = strip->begin;
    double length = 0;
    for (uint32_t k = 0; k <= count; k++) {
        struct gd__local b = k < count ? corners[k].at : strip->end;
        length += hypot(b.x - a.x, b.y - a.y);
        a = b;
    }
    return length;
}

static enum gd_status straighten_measure(struct gd__straightener *s, uint32_t *corner_count,
                                         double *length)
{
    enum gd_status status = gd__strip_lay(s->mesh, &s->strip);
    if (!status)
        status = gd__array_extend(&s->corners, &s->corner_capacity, s->strip.capacity + 1ULL,
                                  sizeof *s->corners, s->control);
    if (status) return status;
    *corner_count = gd__strip_corners(&s->strip, s->corners);
    *length = straighten_length_of(&s->strip, s->corners, *corner_count);
    return GD_OK;
}

static enum gd_status straighten_check_control(struct gd__straightener *s)
{
    s->laid += s->strip.count;
    if (s->laid < LOOK) return GD_OK;
    s->laid = 0;
    return gd_control_check(s->control, s->progress);
}

/* Repeats rounds as long as a round shortens the line by more than `least_gain` times its length.
 * Sets *out to the final length. */
static enum gd_status tighten(struct gd__straightener *s, double least_gain, uint32_t *corner_count,
                              double *out)
{
    double length, before = INFINITY;
    bool has_moved = true;
    enum gd_status status = straighten_measure(s, corner_count, &length);
    while (!status && length < before) {
        before = length * (1 - least_gain);
        status = straighten_relax(s, *corner_count, &has_moved);
        if (status || !has_moved) break;
        struct gd__strip moved = s->other;
        s->other = s->strip;
        s->strip = moved;
        status = straighten_measure(s, corner_count, &length);
        if (!status) status = straighten_check_control(s);
    }
    if (!status) *out = length;
    return status;
}

/* --- straightening ---------------------------------------------------------------------------- */

static enum gd_status straighten(struct gd__straightener *s, const struct gd__route *route,
                                 bool backwards, struct gd__route *out)
{
    uint32_t corner_count;
    double length;
    gd__route_clear(&s->line);
    enum gd_status status =
        gd__route_join(&s->line, route->points, route->count, route->length, backwards, s->control);
    gd__route_clear(out);
    if (status) return status;
    if (s->line.count < 2)
        return gd__route_join(out, s->line.points, s->line.count, 0, false, s->control);
    status = gd__strip_along(s->mesh, &s->line, &s->strip, s->control);
    if (!status) status = tighten(s, GD_TOL_BETTER, &corner_count, &length);
    if (!status)
        status = gd__strip_line(s->mesh, &s->strip, s->corners, corner_count, out, s->control);
    if (!status && backwards) gd__points_reverse(out->points, out->count);
    return status;
}

enum gd_status gd__straighten(struct gd__straightener *straightener, const struct gd__route *route,
                              struct gd__route *out)
{
    bool backwards =
        route->count > 1 && gd__point_follows(&route->points[0], &route->points[route->count - 1]);
    return straighten(straightener, route, backwards, out);
}

enum gd_status gd__straighten_length(struct gd__straightener *s, const struct gd__route *route,
                                     double least_gain, double *out)
{
    uint32_t corner_count;
    *out = 0;
    if (route->count < 2) return GD_OK;
    enum gd_status status = gd__strip_along(s->mesh, route, &s->strip, s->control);
    return status ? status : tighten(s, least_gain, &corner_count, out);
}
