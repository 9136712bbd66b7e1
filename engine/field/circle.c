#include "field/circle.h"

#include "base/array.h"

/* This file computes the part of a circle that lies in the face and where no other source is
 * nearer. Disks and half-planes bound this part. On a circle, each disk or half-plane gives a
 * condition cos(angle - phi) >= q. On a line (the circle of a segment source), each disk or
 * half-plane gives an interval. */

static struct gd__local opposite(struct gd__local v)
{
    return (struct gd__local){-v.x, -v.y};
}

/* --- the circle ------------------------------------------------------------------------------- */

static double angle_of(const struct gd__circle *circle, struct gd__local v)
{
    return atan2(gd__local_dot(gd__circle_along(circle), v), gd__local_dot(circle->towards, v));
}

/* Returns the angle that represents the length `way` along a line (see circle.h). */
static double angle_along(const struct gd__circle *line, double way)
{
    return 2 * atan2(way, line->radius);
}

static struct gd__circle line_of(const struct gd__source *source, struct gd__local middle,
                                 double size, double level)
{
    struct gd__local up = source->gradient;
    double more = level - gd__source_distance(source, middle);
    return (struct gd__circle){.straight = true,
                               .centre = {middle.x + more * up.x, middle.y + more * up.y},
                               .radius = size,
                               .towards = up};
}

struct gd__circle gd__circle_of(const struct gd__sources *sources, uint32_t i, double level)
{
    const struct gd__source *source = &sources->source[i];
    struct gd__local middle = gd__face_frame_middle(&sources->frame);
    if (source->linear) return line_of(source, middle, sources->frame.size, level);
    double zero = atan2(middle.y - source->at.y, middle.x - source->at.x);
    return (struct gd__circle){.centre = source->at,
                               .radius = level - source->sigma,
                               .zero = zero,
                               .towards = {cos(zero), sin(zero)}};
}

struct gd__local gd__circle_place(const struct gd__circle *circle, double angle)
{
    if (circle->straight) {
        struct gd__local along = gd__circle_along(circle);
        double way = circle->radius * tan(0.5 * angle);
        return (struct gd__local){circle->centre.x + way * along.x,
                                  circle->centre.y + way * along.y};
    }
    double a = circle->zero + angle;
    return (struct gd__local){circle->centre.x + circle->radius * cos(a),
                              circle->centre.y + circle->radius * sin(a)};
}

double gd__circle_angle(const struct gd__circle *circle, struct gd__local at)
{
    struct gd__local v = gd__local_minus(at, circle->centre);
    return circle->straight ? angle_along(circle, gd__local_dot(gd__circle_along(circle), v))
                            : angle_of(circle, v);
}

/* --- borders of the arcs ---------------------------------------------------------------------- */

/* Returns the part of a line where a linear function is at least 0. Its value is `height` at the
 * line's centre, and its derivative along the line is `slope`. */
static struct gd__turn line_above(const struct gd__circle *line, double height, double slope)
{
    if (slope == 0) return height >= 0 ? gd__turn_all : (struct gd__turn){0};
    double bound = angle_along(line, -height / slope);
    return slope > 0 ? (struct gd__turn){1, {{.from = bound, .to = M_PI}}}
                     : (struct gd__turn){1, {{.from = -M_PI, .to = bound}}};
}

/* Returns the part of the circle inside a half-plane with the given unit normal. `height` is the
 * height of the circle's centre above the border. */
static struct gd__turn in_half_plane(const struct gd__circle *circle, struct gd__local normal,
                                     double height)
{
    if (circle->straight)
        return line_above(circle, height, gd__local_dot(normal, gd__circle_along(circle)));
    return gd__turn_around(angle_of(circle, normal), -height / circle->radius);
}

/* Returns the height of the centre above the line through `through`. */
static double height_over(const struct gd__circle *circle, struct gd__local normal,
                          struct gd__local through)
{
    return gd__local_dot(normal, gd__local_minus(circle->centre, through));
}

static bool circle_touches(const struct gd__circle *circle, struct gd__local normal, double height,
                           double slack)
{
    if (!circle->straight) return fabs(fabs(height) - circle->radius) <= slack;
    return fabs(height) + fabs(gd__local_dot(normal, gd__circle_along(circle))) * circle->radius <=
           slack;
}

/* Returns the part on the negative side of a line. If a circle touches the line within `slack`, the
 * whole circle counts as lying on the side of its centre. If a straight circle coincides with the
 * line, the circle counts as lying on the side of its source. */
static struct gd__turn beyond_line(const struct gd__circle *circle, struct gd__local normal,
                                   struct gd__local through, double slack)
{
    double height = height_over(circle, normal, through);
    if (!circle_touches(circle, normal, height, slack))
        return in_half_plane(circle, opposite(normal), -height);
    bool stays = circle->straight ? gd__local_dot(normal, circle->towards) < 0 : height > 0;
    return stays ? (struct gd__turn){0} : gd__turn_all;
}

static struct gd__turn line_in_disk(const struct gd__circle *line, struct gd__local centre,
                                    double radius)
{
    struct gd__local v = gd__local_minus(centre, line->centre);
    double along = gd__local_dot(v, gd__circle_along(line)),
           away = fabs(gd__local_dot(v, line->towards));
    if (!(radius > away)) return (struct gd__turn){0};
    double half = sqrt((radius - away) * (radius + away));
    return (struct gd__turn){
        1, {{.from = angle_along(line, along - half), .to = angle_along(line, along + half)}}};
}

static struct gd__turn in_disk(const struct gd__circle *circle, struct gd__local centre,
                               double radius)
{
    if (circle->straight) return line_in_disk(circle, centre, radius);
    struct gd__local v = gd__local_minus(centre, circle->centre);
    double apart = sqrt(gd__local_dot(v, v)),
           excess = (circle->radius - radius) * (circle->radius + radius);
    if (radius <= 0) return (struct gd__turn){0};
    if (apart == 0) return excess <= 0 ? gd__turn_all : (struct gd__turn){0};
    return gd__turn_around(angle_of(circle, v),
                           (apart * apart + excess) / (2 * apart * circle->radius));
}

/* Returns the part where the distance from a linear source is at most the level. Positions where
 * this distance is less than the source's `nearest` are excluded. */
static struct gd__turn in_band(const struct gd__circle *circle, const struct gd__source *source,
                               double level)
{
    double distance = gd__source_distance(source, circle->centre);
    struct gd__turn above = in_half_plane(circle, source->gradient, distance - source->nearest),
                    below = in_half_plane(circle, opposite(source->gradient), level - distance);
    return gd__turn_both(&above, &below);
}

/* Returns the part that the source sees and whose distance from this source is at most the
 * level. */
static struct gd__turn seen_by(const struct gd__circle *circle, const struct gd__source *source,
                               double level)
{
    struct gd__turn parts = source->linear ? in_band(circle, source, level)
                                           : in_disk(circle, source->at, level - source->sigma);
    if (!source->has_sector || !parts.count) return parts;
    struct gd__turn right_of =
        in_half_plane(circle, source->left, height_over(circle, source->left, source->left_at));
    parts = gd__turn_both(&parts, &right_of);
    struct gd__turn left_of =
        in_half_plane(circle, source->right, height_over(circle, source->right, source->right_at));
    return gd__turn_both(&parts, &left_of);
}

static void cover_outside_face(const struct gd__circle *circle, const struct gd__face_frame *frame,
                               double slack, struct gd__spans *covered)
{
    for (int k = 0; k < 3; k++) {
        struct gd__local inwards = {-frame->along[k].y, frame->along[k].x};
        struct gd__turn outside = beyond_line(circle, inwards, frame->corner[k], slack);
        gd__spans_put(covered, &outside, 0);
    }
}

static void cover_outside_sector(const struct gd__circle *circle, const struct gd__source *source,
                                 struct gd__spans *covered)
{
    if (!source->has_sector) return;
    struct gd__turn beyond_left = beyond_line(circle, source->left, source->left_at, 0),
                    beyond_right = beyond_line(circle, source->right, source->right_at, 0);
    gd__spans_put(covered, &beyond_left, 0);
    gd__spans_put(covered, &beyond_right, 0);
}

/* The smallest disk around the middle of a span that contains the span. */
struct probe {
    struct gd__local at;
    double reach;
};

static struct probe probe_of(const struct gd__circle *circle, const struct gd__span *span)
{
    if (circle->straight) {
        struct gd__local a = gd__circle_place(circle, span->from),
                         b = gd__circle_place(circle, span->to);
        struct gd__local half = {0.5 * (b.x - a.x), 0.5 * (b.y - a.y)};
        return (struct probe){{a.x + half.x, a.y + half.y}, sqrt(gd__local_dot(half, half))};
    }
    return (struct probe){gd__circle_place(circle, 0.5 * (span->from + span->to)),
                          0.5 * circle->radius * (span->to - span->from)};
}

/* Returns true if the distance from the source may be less than the level at a point of the probe.
 * The test needs no angles and rejects most sources. */
static bool may_cover(const struct gd__source *source, double level, const struct probe *probe)
{
    struct gd__local v = gd__local_minus(probe->at, source->left_at),
                     u = gd__local_minus(probe->at, source->right_at);
    double far = level - source->sigma + probe->reach;
    if (source->linear ? gd__source_distance(source, probe->at) - probe->reach >= level
                       : far <= 0 || gd__local_dot(v, v) >= far * far)
        return false;
    return !source->has_sector || (gd__local_dot(source->left, v) >= -probe->reach &&
                                   gd__local_dot(source->right, u) >= -probe->reach);
}

/* Returns true if the paths of two sources meet at the level from opposite sides where the sources
 * tie. Then, at each of the two sources, the distance from the other source is at least the
 * level. */
static bool face_each_other(const struct gd__source *a, const struct gd__source *b, double level)
{
    if (a->linear && b->linear) return gd__local_dot(a->gradient, b->gradient) < 0;
    return (a->linear || gd__source_distance(b, a->at) >= level) &&
           (b->linear || gd__source_distance(a, b->at) >= level);
}

/* Returns true if source k wins a tie with source i. The circles of sources that face each other
 * touch in one point, or along a ridge at the level; then neither source wins. A linear source wins
 * against a point, so that a segment's line and the circle around the segment's end join exactly.
 * Otherwise the source with the lower number wins. */
static bool takes_tie(const struct gd__sources *sources, uint32_t k, uint32_t i, double level)
{
    const struct gd__source *a = &sources->source[k], *b = &sources->source[i];
    if (face_each_other(a, b, level)) return false;
    return a->linear == b->linear ? k < i : a->linear;
}

static void cover_by_others(struct gd__sources *sources, uint32_t i,
                            const struct gd__circle *circle, double level,
                            const struct gd__span *span)
{
    double slack = gd__envelope_slack(level, sources->frame.size);
    struct probe probe = probe_of(circle, span);
    uint32_t limit = GD__SPANS_FEW;
    for (uint32_t k = 0; k < sources->count; k++) {
        const struct gd__source *other = &sources->source[k];
        double most = level + (takes_tie(sources, k, i, level) ? slack : -slack);
        if (k == i || !may_cover(other, most, &probe)) continue;
        struct gd__turn seen = seen_by(circle, other, most);
        gd__spans_put(&sources->covered, &seen, 0);
        if (gd__spans_settle(&sources->covered, slack / circle->radius, &limit)) break;
    }
}

/* --- arcs ------------------------------------------------------------------------------------- */

/* Returns true if no point of the circle is in the face, because the circle encloses the face. A
 * line within `slack` of a side may lie in the face. */
static bool encloses_face(const struct gd__circle *circle, const struct gd__face_frame *frame,
                          double slack)
{
    for (int k = 0; k < 3; k++) {
        struct gd__local v = gd__local_minus(frame->corner[k], circle->centre);
        if (circle->straight ? gd__local_dot(v, circle->towards) >= -slack
                             : gd__local_dot(v, v) >= circle->radius * circle->radius)
            return false;
    }
    return true;
}

enum gd_status gd__circle_arcs(struct gd__sources *sources, uint32_t i, double level)
{
    struct gd__spans *covered = &sources->covered, *arcs = &sources->spans;
    struct gd__circle circle = gd__circle_of(sources, i, level);
    double slack = gd__envelope_slack(level, sources->frame.size), least = slack / circle.radius;
    covered->count = arcs->count = 0;
    if (encloses_face(&circle, &sources->frame, slack)) return GD_OK;
    cover_outside_face(&circle, &sources->frame, slack, covered);
    cover_outside_sector(&circle, &sources->source[i], covered);
    gd__spans_invert(covered, least, arcs);
    if (!arcs->count) return arcs->status;
    for (uint32_t k = 0; k < arcs->count; k++)
        cover_by_others(sources, i, &circle, level, &arcs->span[k]);
    gd__spans_invert(covered, least, arcs);
    gd__spans_join(arcs);
    return arcs->status;
}
