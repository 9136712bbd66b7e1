/* Polyline vertex (joint): a point of a curve and the segments that end there. A joint is the
 * nearest point of the curve only for the points behind it. A point is behind a joint if its
 * direction from the joint makes an angle of 90 degrees or more with each of the joint's segments.
 * For a point in another direction, a point of a segment is nearer (first variation of length). */
#pragma once

#include "mesh/segment.h"
#include "wavefront/wavefront.h"

enum {
    /* number of segments that are located in advance, so that their square roots are computed
       early */
    GD__SEGMENTS_AHEAD = 1,
    /* number of cached segments: the two of a joint, and those ahead; a power of two */
    GD__SEGMENTS_KEPT = 4 * GD__SEGMENTS_AHEAD,
};

/* A segment with its location on the surface. */
struct gd__placed_segment {
    uint32_t seed; /* GD_NONE if not set yet */
    uint32_t face; /* GD_NONE means along an edge */
    uint32_t edge;
    /* along an edge: 1 if in the direction of the edge's side 0, -1 if in the opposite direction */
    double forward;
    struct gd__chord chord[3]; /* across a face: the segment in the frames of the face's sides */
};

/* The segments that were located last. Each segment is needed three times within a short time: for
 * itself and for its two ends. */
struct gd__segment_cache {
    struct gd__placed_segment last[GD__SEGMENTS_KEPT];
};

/* Empties the cache. */
static inline void gd__segment_cache_clear(struct gd__segment_cache *cache)
{
    for (int i = 0; i < GD__SEGMENTS_KEPT; i++) cache->last[i].seed = GD_NONE;
}

/* Locates the segment of a seed on the surface. */
void gd__segment_place(const struct gd__wavefront *front, struct gd__placed_segment *placed,
                       uint32_t seed);

/* Returns the segment of a seed. It is valid until another seed with the same (seed / 2) modulo
 * GD__SEGMENTS_KEPT is requested. */
static inline const struct gd__placed_segment *
gd__segment_cache_get(const struct gd__wavefront *front, struct gd__segment_cache *cache,
                      uint32_t seed)
{
    struct gd__placed_segment *placed = &cache->last[seed / 2 % GD__SEGMENTS_KEPT];
    if (placed->seed != seed) gd__segment_place(front, placed, seed);
    return placed;
}

/* The segments that end at a seed's point. In the list of seeds, they are the neighbours of this
 * seed (gd_curve_seeds). */
struct gd__joint {
    const struct gd__placed_segment *segment[2]; /* NULL means no such segment */
    double turned[2];                            /* 1: the segment starts here, -1: it ends here */
};

static inline struct gd__joint gd__joint_of(const struct gd__wavefront *front,
                                            struct gd__segment_cache *cache, uint32_t seed)
{
    const struct gd__seed *at = &front->seeds[seed];
    struct gd__joint joint = {{NULL, NULL}, {0, 0}};
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t beside = seed - 1 + 2 * i; /* wraps around before the first seed */
        if (beside >= front->seed_count) continue;
        const struct gd__seed *s = &front->seeds[beside];
        if (!s->is_segment || s->offset != at->offset) continue;
        bool comes = gd_point_equal(&s->end, &at->point);
        if (!comes && !gd_point_equal(&s->point, &at->point)) continue;
        joint.segment[i] = gd__segment_cache_get(front, cache, beside);
        joint.turned[i] = comes ? -1 : 1;
    }
    return joint;
}

/* Directions of the segments of a joint, pointing away from the joint: unit vectors in the frame of
 * a side. The direction of a missing segment is zero, so that no point is ahead in this
 * direction. */
struct gd__segment_directions {
    struct gd__local along[2];
};

static inline struct gd__local gd__local_scaled(struct gd__local along, double by)
{
    return (struct gd__local){by * along.x, by * along.y};
}

/* Returns the directions in the frame of side k of the face that contains the joint. */
static inline struct gd__segment_directions gd__directions_in_face(const struct gd__joint *joint,
                                                                   int k)
{
    struct gd__segment_directions directions = {{{0, 0}, {0, 0}}};
    for (int i = 0; i < 2; i++)
        if (joint->segment[i])
            directions.along[i] =
                gd__local_scaled(joint->segment[i]->chord[k].along, joint->turned[i]);
    return directions;
}

/* Returns the direction of a segment in the frame of one side of an edge. The segment ends on this
 * edge or runs along it. If the segment lies in the face across the edge, this face is unfolded
 * into the plane of the side's face. */
static inline struct gd__local gd__direction_from_edge(const struct gd_mesh *mesh, uint32_t side,
                                                       const struct gd__placed_segment *placed)
{
    if (placed->face == GD_NONE)
        return (struct gd__local){side & 1 ? -placed->forward : placed->forward, 0};
    const uint32_t *sides = mesh->face_side[placed->face];
    int k = gd__place_of_edge(sides, side >> 1);
    return gd__local_scaled(placed->chord[k].along, 1 - 2 * (double)(sides[k] != side));
}

/* Returns the directions in the frame of one side of the edge that contains the joint. */
static inline struct gd__segment_directions
gd__directions_from_edge(const struct gd_mesh *mesh, const struct gd__joint *joint, uint32_t side)
{
    struct gd__segment_directions directions = {{{0, 0}, {0, 0}}};
    for (int i = 0; i < 2; i++)
        if (joint->segment[i])
            directions.along[i] = gd__local_scaled(
                gd__direction_from_edge(mesh, side, joint->segment[i]), joint->turned[i]);
    return directions;
}

/* Converts the directions to the frame of the edge's other side. */
static inline struct gd__segment_directions
gd__directions_from_other_side(struct gd__segment_directions directions)
{
    for (int i = 0; i < 2; i++) directions.along[i] = gd__local_scaled(directions.along[i], -1);
    return directions;
}

/* `v` is the vector from the joint to a point. Returns true if a segment is nearer to this point
 * than the joint, by more than rounding errors. */
static inline bool gd__is_ahead(const struct gd__segment_directions *directions, struct gd__local v)
{
    double beside = GD_TOL_ONWARD * (fabs(v.x) + fabs(v.y));
    for (int i = 0; i < 2; i++)
        if (gd__local_dot(directions->along[i], v) > beside) return true;
    return false;
}

/* Returns true if the two segments form a straight line at the joint. Then only the points of one
 * line, the perpendicular at the joint, are behind both segments. */
static inline bool gd__is_straight(const struct gd__segment_directions *directions)
{
    const struct gd__local *a = &directions->along[0], *b = &directions->along[1];
    return gd__local_dot(*a, *b) < 0 && fabs(a->x * b->y - a->y * b->x) <= GD_TOL_ONWARD;
}

/* A part of a side, as fractions of its length from its origin. */
struct gd__part {
    double from, to;
};

/* Returns the part of a side that lies behind all segments of a joint. `origin` and `destination`
 * are the side's ends, relative to the joint. */
struct gd__part gd__part_behind(const struct gd__segment_directions *directions,
                                struct gd__local origin, struct gd__local destination);
