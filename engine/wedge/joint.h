/* Joint: a point of a curve, and the segments that end there. It is nearest only to what lies behind the ends of all of them: in any other direction a place
 * of one of them is nearer (first variation of length). */
#ifndef GD_WEDGE_JOINT_H
#define GD_WEDGE_JOINT_H

#include "mesh/segment.h"
#include "wedge/wavefront.h"

/* A segment as it lies on the surface. */
struct gd__laid {
    uint32_t seed; /* GD_NONE: none yet */
    struct gd__home home;
    struct gd__chord chord[3]; /* across a face: in the frames of its sides */
};

/* The two segments laid last: a segment of a curve is asked for three times in a row, by itself and by its ends. */
struct gd__laying {
    struct gd__laid last[2];
};

/* Nothing is laid yet. */
static inline void gd__laying_begin(struct gd__laying *laying)
{
    for (int i = 0; i < 2; i++) laying->last[i].seed = GD_NONE;
}

/* The segment that a seed is; without a home where its ends lie in no common face. Good until the second segment after it is laid. */
const struct gd__laid *gd__lay(const struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed);

struct gd__joint {
    const struct gd__laid *segment[2];
    double turned[2]; /* 1: the segment goes off from here, -1: it comes here */
    int count;
};

/* The segments that end at the point that a seed is, and stand next to it in the list of seeds (gd_curve_seeds). */
struct gd__joint gd__joint_of(const struct gd__wavefront *front, struct gd__laying *laying, uint32_t seed);

/* Where the segments of a joint go off from it, in the frame of a side: unit vectors. */
struct gd__spread {
    struct gd__local along[2];
    int count;
};

/* In the frame of side k of the face that the joint lies in. */
struct gd__spread gd__spread_in_face(const struct gd__joint *joint, int k);

/* In the frame of one side of the edge that the joint lies on: the face across is laid beside the side's own. */
struct gd__spread gd__spread_from_edge(const struct gd__wavefront *front, const struct gd__joint *joint, uint32_t side);

static inline struct gd__local gd__turned(struct gd__local along, double by)
{
    return (struct gd__local){by * along.x, by * along.y};
}

/* The same in the frame of the edge's other side. */
static inline struct gd__spread gd__spread_from_other_side(struct gd__spread spread)
{
    for (int i = 0; i < spread.count; i++) spread.along[i] = gd__turned(spread.along[i], -1);
    return spread;
}

/* How far a place, at `v` from a joint, lies ahead along a direction. */
static inline double gd__along(struct gd__local direction, struct gd__local v)
{
    return direction.x * v.x + direction.y * v.y;
}

/* Whether one of the segments is nearer to a place, at `v` from the joint, than the joint is, and by more than rounding. */
static inline bool gd__is_ahead(const struct gd__spread *spread, struct gd__local v)
{
    double beside = GD_TOL_ONWARD * (fabs(v.x) + fabs(v.y));
    for (int i = 0; i < spread->count; i++)
        if (gd__along(spread->along[i], v) > beside) return true;
    return false;
}

/* Two segments that go on straight: what lies behind both is a line. */
static inline bool gd__is_straight(const struct gd__spread *spread)
{
    const struct gd__local *a = &spread->along[0], *b = &spread->along[1];
    return spread->count == 2 && gd__along(*a, *b) < 0 && fabs(a->x * b->y - a->y * b->x) <= GD_TOL_ONWARD;
}

/* A part of a side, in parts of its length from its origin. */
struct gd__part {
    double from, to;
};

/* What of the side from `origin` to `destination`, as seen from a joint, lies behind all its segments. */
struct gd__part gd__part_behind(const struct gd__spread *spread, struct gd__local origin, struct gd__local destination);

#endif
