/* Joint: a point of a curve, and the segments that end there. It is nearest only to what lies
 * behind the ends of all of them: in any other direction a place of one of them is nearer (first
 * variation of length). */
#ifndef GD_WAVEFRONT_POLYLINE_VERTEX_H
#define GD_WAVEFRONT_POLYLINE_VERTEX_H

#include "mesh/segment.h"
#include "wavefront/wavefront.h"

enum {
    /* segments are laid before their turn, so that their square roots are there */
    GD__LAID_AHEAD = 1,
    /* are kept: a joint's two, and those ahead; a power of two */
    GD__LAID_LAST = 4 * GD__LAID_AHEAD,
};

/* A segment as it lies on the surface. */
struct gd__laid {
    uint32_t seed; /* GD_NONE: none yet */
    uint32_t face; /* GD_NONE: along an edge */
    uint32_t edge;
    double forward;            /* along an edge: 1 as its side 0 runs, -1 against it */
    struct gd__chord chord[3]; /* across a face: in the frames of its sides */
};

/* The segments laid last: one of a curve is asked for three times in a row, by itself and by its
 * ends. */
struct gd__laying {
    struct gd__laid last[GD__LAID_LAST];
};

/* Nothing is laid yet. */
static inline void gd__laying_begin(struct gd__laying *laying)
{
    for (int i = 0; i < GD__LAID_LAST; i++) laying->last[i].seed = GD_NONE;
}

/* Lays the segment that a seed is. */
void gd__lay_anew(const struct gd__wavefront *front, struct gd__laid *laid, uint32_t seed);

/* The segment that a seed is. Good until another seed is asked for of which half the number has the
 * same rest by GD__LAID_LAST. */
static inline const struct gd__laid *gd__lay(const struct gd__wavefront *front,
                                             struct gd__laying *laying, uint32_t seed)
{
    struct gd__laid *laid = &laying->last[seed / 2 % GD__LAID_LAST];
    if (laid->seed != seed) gd__lay_anew(front, laid, seed);
    return laid;
}

/* The segments that end at the point that a seed is, and stand before and behind it in the list of
 * seeds (gd_curve_seeds). */
struct gd__joint {
    const struct gd__laid *segment[2]; /* NULL: there is none */
    double turned[2];                  /* 1: the segment goes off from here, -1: it comes here */
};

static inline struct gd__joint gd__joint_of(const struct gd__wavefront *front,
                                            struct gd__laying *laying, uint32_t seed)
{
    const struct gd__seed *at = &front->seeds[seed];
    struct gd__joint joint = {{NULL, NULL}, {0, 0}};
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t beside = seed - 1 + 2 * i; /* none before the first */
        if (beside >= front->seed_count) continue;
        const struct gd__seed *s = &front->seeds[beside];
        if (!s->is_segment || s->offset != at->offset) continue;
        bool comes = gd_point_equal(&s->end, &at->point);
        if (!comes && !gd_point_equal(&s->point, &at->point)) continue;
        joint.segment[i] = gd__lay(front, laying, beside);
        joint.turned[i] = comes ? -1 : 1;
    }
    return joint;
}

/* Where the segments of a joint go off from it, in the frame of a side: unit vectors. Zero where
 * there is none: nothing is ahead along that. */
struct gd__spread {
    struct gd__local along[2];
};

static inline struct gd__local gd__turned(struct gd__local along, double by)
{
    return (struct gd__local){by * along.x, by * along.y};
}

/* The spread in the frame of side k of the face that the joint lies in. */
static inline struct gd__spread gd__spread_in_face(const struct gd__joint *joint, int k)
{
    struct gd__spread spread = {{{0, 0}, {0, 0}}};
    for (int i = 0; i < 2; i++)
        if (joint->segment[i])
            spread.along[i] = gd__turned(joint->segment[i]->chord[k].along, joint->turned[i]);
    return spread;
}

/* Where a segment runs, in the frame of one side of an edge that it ends on or runs along: the face
 * across is laid beside the side's own. */
static inline struct gd__local gd__direction_from_edge(const struct gd_mesh *mesh, uint32_t side,
                                                       const struct gd__laid *laid)
{
    if (laid->face == GD_NONE)
        return (struct gd__local){side & 1 ? -laid->forward : laid->forward, 0};
    const uint32_t *sides = mesh->face_side[laid->face];
    int k = gd__place_of_edge(sides, side >> 1);
    return gd__turned(laid->chord[k].along, 1 - 2 * (double)(sides[k] != side));
}

/* The spread in the frame of one side of the edge that the joint lies on. */
static inline struct gd__spread gd__spread_from_edge(const struct gd_mesh *mesh,
                                                     const struct gd__joint *joint, uint32_t side)
{
    struct gd__spread spread = {{{0, 0}, {0, 0}}};
    for (int i = 0; i < 2; i++)
        if (joint->segment[i])
            spread.along[i] = gd__turned(gd__direction_from_edge(mesh, side, joint->segment[i]),
                                         joint->turned[i]);
    return spread;
}

/* The same in the frame of the edge's other side. */
static inline struct gd__spread gd__spread_from_other_side(struct gd__spread spread)
{
    for (int i = 0; i < 2; i++) spread.along[i] = gd__turned(spread.along[i], -1);
    return spread;
}

/* How far a place, at `v` from a joint, lies ahead along a direction. */
static inline double gd__along(struct gd__local direction, struct gd__local v)
{
    return direction.x * v.x + direction.y * v.y;
}

/* Whether one of the segments is nearer to a place, at `v` from the joint, than the joint is, and
 * by more than rounding. */
static inline bool gd__is_ahead(const struct gd__spread *spread, struct gd__local v)
{
    double beside = GD_TOL_ONWARD * (fabs(v.x) + fabs(v.y));
    for (int i = 0; i < 2; i++)
        if (gd__along(spread->along[i], v) > beside) return true;
    return false;
}

/* Two segments that go on straight: what lies behind both is a line. */
static inline bool gd__is_straight(const struct gd__spread *spread)
{
    const struct gd__local *a = &spread->along[0], *b = &spread->along[1];
    return gd__along(*a, *b) < 0 && fabs(a->x * b->y - a->y * b->x) <= GD_TOL_ONWARD;
}

/* A part of a side, in parts of its length from its origin. */
struct gd__part {
    double from, to;
};

/* What of the side from `origin` to `destination`, as seen from a joint, lies behind all its
 * segments. */
struct gd__part gd__part_behind(const struct gd__spread *spread, struct gd__local origin,
                                struct gd__local destination);

#endif
