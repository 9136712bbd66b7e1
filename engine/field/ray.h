/* Ray: a leg of a path, followed from face to face. A leg is a straight line through unfolded
 * faces, so one frame at a time suffices: where it crosses the edge, and where the source's image
 * lies. */
#ifndef GD_FIELD_RAY_H
#define GD_FIELD_RAY_H

#include "field/trail.h"

/* In the frame of a side of the face it is in: crosses the side at t, its source's image lies
 * across at (x, -y), or, of a segment, in that direction. */
struct gd__ray {
    uint32_t side, source;
    double t, x, y;
};

/* Where a leg ended. */
struct gd__stop {
    enum { GD__STOP_VERTEX, GD__STOP_SEED, GD__STOP_BEND, GD__STOP_FAILED } kind;
    uint32_t vertex;       /* GD__STOP_VERTEX */
    uint32_t seed;         /* GD__STOP_SEED */
    struct gd_point point; /* GD__STOP_BEND: a point of an edge */
};

static inline struct gd__stop gd__stop_at_vertex(uint32_t vertex)
{
    return (struct gd__stop){.kind = GD__STOP_VERTEX, .vertex = vertex};
}

/* At a vertex or a bend. */
static inline struct gd__stop gd__stop_at(struct gd_point point)
{
    if (point.kind == GD_POINT_VERTEX) return gd__stop_at_vertex(point.element);
    return (struct gd__stop){.kind = GD__STOP_BEND, .point = point};
}

static inline struct gd__stop gd__stop_at_seed(uint32_t seed)
{
    return (struct gd__stop){.kind = GD__STOP_SEED, .seed = seed};
}

/* The trail's status says why. */
static inline struct gd__stop gd__stop_failed(struct gd__trail *trail, enum gd_status status)
{
    if (!trail->status) trail->status = status;
    return (struct gd__stop){.kind = GD__STOP_FAILED};
}

/* Appends where the ray crosses edges until it reaches its source or passes through a vertex. */
struct gd__stop gd__ray_follow(struct gd__trail *trail, struct gd__ray ray);

/* Is the source, a vertex or a point, in the face of `side`, and there at (x, y)? Then the leg
 * ends. */
bool gd__ray_has_arrived(const struct gd__trail *trail, uint32_t side, double x, double y,
                         uint32_t source);

/* Appends the source. */
struct gd__stop gd__ray_arrive(struct gd__trail *trail, uint32_t face, uint32_t source);

/* Appends the foot of the perpendicular from the last point, which lies in the segment's face, on
 * the segment. */
struct gd__stop gd__ray_arrive_at_chord(struct gd__trail *trail, uint32_t seed, uint32_t face);

#endif
