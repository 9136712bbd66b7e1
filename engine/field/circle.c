#include "field/circle.h"

#include <stdlib.h>

#include "field/array.h"

/* All that bounds an arc is a disk or a half-plane, and meets the circle where cos(angle - phi) >= q for some phi and q. */

/* --- the circle ---------------------------------------------------------------------------------------------------------- */

static double angle_of(const struct gd__circle *circle, double dx, double dy)
{
    struct gd__local z = circle->towards;
    return atan2(z.x * dy - z.y * dx, z.x * dx + z.y * dy);
}

struct gd__circle gd__circle_of(const struct gd__sources *sources, uint32_t i, double level)
{
    const struct gd__local *corner = sources->frame.corner;
    struct gd__local at = sources->source[i].at;
    double dx = (corner[0].x + corner[1].x + corner[2].x) / 3 - at.x,
           dy = (corner[0].y + corner[1].y + corner[2].y) / 3 - at.y;
    double zero = atan2(dy, dx);
    return (struct gd__circle){at, level - sources->source[i].sigma, zero, {cos(zero), sin(zero)}};
}

struct gd__local gd__circle_place(const struct gd__circle *circle, double angle)
{
    double a = circle->zero + angle;
    return (struct gd__local){circle->centre.x + circle->radius * cos(a), circle->centre.y + circle->radius * sin(a)};
}

double gd__circle_angle(const struct gd__circle *circle, struct gd__local at)
{
    return angle_of(circle, at.x - circle->centre.x, at.y - circle->centre.y);
}

/* --- what bounds its arcs ------------------------------------------------------------------------------------------------ */

/* How far the centre lies on the side of a line to which its unit normal points; the line passes `through`. */
static double height_over(const struct gd__circle *circle, struct gd__local normal, struct gd__local through)
{
    return normal.x * (circle->centre.x - through.x) + normal.y * (circle->centre.y - through.y);
}

/* On the side of a line to which its normal points. */
static struct gd__turn in_half_plane(const struct gd__circle *circle, struct gd__local normal, struct gd__local through)
{
    return gd__turn_around(angle_of(circle, normal.x, normal.y),
                           -height_over(circle, normal, through) / circle->radius);
}

/* On the other side. A circle that touches the line up to `slack` stays on its centre's side. */
static struct gd__turn beyond_line(const struct gd__circle *circle, struct gd__local normal, struct gd__local through,
                                   double slack)
{
    double height = height_over(circle, normal, through);
    if (fabs(fabs(height) - circle->radius) <= slack) return height > 0 ? (struct gd__turn){0} : gd__turn_all;
    return gd__turn_around(angle_of(circle, -normal.x, -normal.y), height / circle->radius);
}

static struct gd__turn in_disk(const struct gd__circle *circle, struct gd__local centre, double radius)
{
    double dx = centre.x - circle->centre.x, dy = centre.y - circle->centre.y, apart = sqrt(dx * dx + dy * dy);
    double excess = (circle->radius - radius) * (circle->radius + radius);
    if (radius <= 0) return (struct gd__turn){0};
    if (apart == 0) return excess <= 0 ? gd__turn_all : (struct gd__turn){0};
    return gd__turn_around(angle_of(circle, dx, dy), (apart * apart + excess) / (2 * apart * circle->radius));
}

/* Where a source gives no more than a distance of that radius beyond its sigma. */
static struct gd__turn seen_by(const struct gd__circle *circle, const struct gd__source *source, double radius)
{
    struct gd__turn parts = in_disk(circle, source->at, radius);
    if (!source->has_sector || !parts.count) return parts;
    struct gd__turn right_of = in_half_plane(circle, source->left, source->at);
    parts = gd__turn_both(&parts, &right_of);
    struct gd__turn left_of = in_half_plane(circle, source->right, source->at);
    return gd__turn_both(&parts, &left_of);
}

static enum gd_status cover_outside_face(const struct gd__circle *circle, const struct gd__frame *frame, double slack,
                                         struct gd__spans *covered)
{
    enum gd_status status = GD_OK;
    for (int k = 0; k < 3 && !status; k++) {
        struct gd__local inwards = {-frame->along[k].y, frame->along[k].x};
        struct gd__turn outside = beyond_line(circle, inwards, frame->corner[k], slack);
        status = gd__spans_put(covered, &outside, 0);
    }
    return status;
}

static enum gd_status cover_outside_sector(const struct gd__circle *circle, const struct gd__source *source,
                                           struct gd__spans *covered)
{
    if (!source->has_sector) return GD_OK;
    struct gd__turn beyond_left = beyond_line(circle, source->left, source->at, 0),
                    beyond_right = beyond_line(circle, source->right, source->at, 0);
    enum gd_status status = gd__spans_put(covered, &beyond_left, 0);
    return status ? status : gd__spans_put(covered, &beyond_right, 0);
}

/* A span as the disk about its middle that holds it. */
struct probe {
    struct gd__local at;
    double reach;
};

static struct probe probe_of(const struct gd__circle *circle, const struct gd__span *span)
{
    return (struct probe){gd__circle_place(circle, 0.5 * (span->from + span->to)),
                          0.5 * circle->radius * (span->to - span->from)};
}

/* Might the source be as near as `radius` to a point of the probe that it sees? Most are not, and need no angles. */
static bool may_cover(const struct gd__source *source, double radius, const struct probe *probe)
{
    double dx = probe->at.x - source->at.x, dy = probe->at.y - source->at.y, far = radius + probe->reach;
    if (far <= 0 || dx * dx + dy * dy >= far * far) return false;
    return !source->has_sector || (source->left.x * dx + source->left.y * dy >= -probe->reach &&
                                   source->right.x * dx + source->right.y * dy >= -probe->reach);
}

/* Covers what others see of the span. Ties go to the source that comes first. */
static enum gd_status cover_by_others(const struct gd__sources *sources, uint32_t i, const struct gd__circle *circle,
                                      double slack, const struct gd__span *span, struct gd__spans *covered)
{
    struct probe probe = probe_of(circle, span);
    double level = circle->radius + sources->source[i].sigma;
    enum gd_status status = GD_OK;
    for (uint32_t k = 0; k < sources->count && !status; k++) {
        const struct gd__source *other = &sources->source[k];
        double radius = level - other->sigma + (k < i ? slack : -slack);
        if (k == i || !may_cover(other, radius, &probe)) continue;
        struct gd__turn seen = seen_by(circle, other, radius);
        status = gd__spans_put(covered, &seen, 0);
    }
    return status;
}

/* --- its arcs ------------------------------------------------------------------------------------------------------------ */

/* Does the circle enclose the face? Then no point of it is in the face. */
static bool encloses_face(const struct gd__circle *circle, const struct gd__frame *frame)
{
    for (int k = 0; k < 3; k++) {
        double dx = frame->corner[k].x - circle->centre.x, dy = frame->corner[k].y - circle->centre.y;
        if (dx * dx + dy * dy >= circle->radius * circle->radius) return false;
    }
    return true;
}

enum gd_status gd__circle_arcs(const struct gd__sources *sources, uint32_t i, double level, struct gd__spans *covered,
                               struct gd__spans *arcs)
{
    struct gd__circle circle = gd__circle_of(sources, i, level);
    double slack = gd__envelope_slack(level, sources->frame.size), least = slack / circle.radius;
    covered->count = arcs->count = 0;
    if (encloses_face(&circle, &sources->frame)) return GD_OK;
    enum gd_status status = cover_outside_face(&circle, &sources->frame, slack, covered);
    if (!status) status = cover_outside_sector(&circle, &sources->source[i], covered);
    if (!status) status = gd__spans_invert(covered, least, arcs);
    if (status || !arcs->count) return status;
    for (uint32_t k = 0; k < arcs->count && !status; k++)
        status = cover_by_others(sources, i, &circle, slack, &arcs->span[k], covered);
    if (!status) status = gd__spans_invert(covered, least, arcs);
    if (!status) gd__spans_join(arcs);
    return status;
}
