/* Ray: follows a leg of a path from face to face. A leg is a straight line through unfolded faces.
 * In each face a ray is described by its crossing of an edge and the image of its source. */
#pragma once

#include "field/path_builder.h"

/* A ray in the frame of a side of its face. The ray crosses the side at t. The image of a point
 * source lies beyond the side, at (x, -y). A segment source lies in the direction (x, -y). */
struct gd__ray {
    uint32_t side, source;
    double t, x, y;
};

/* The position where a leg ended. */
struct gd__stop {
    enum { GD__STOP_VERTEX, GD__STOP_SEED, GD__STOP_BEND, GD__STOP_FAILED } kind;
    uint32_t vertex;       /* GD__STOP_VERTEX */
    uint32_t seed;         /* GD__STOP_SEED */
    struct gd_point point; /* GD__STOP_BEND; a point of an edge */
};

static inline struct gd__stop gd__stop_at_vertex(uint32_t vertex)
{
    return (struct gd__stop){.kind = GD__STOP_VERTEX, .vertex = vertex};
}

/* Returns a stop at a vertex, or a bend at another point. */
static inline struct gd__stop gd__stop_at(struct gd_point point)
{
    if (point.kind == GD_POINT_VERTEX) return gd__stop_at_vertex(point.element);
    return (struct gd__stop){.kind = GD__STOP_BEND, .point = point};
}

static inline struct gd__stop gd__stop_at_seed(uint32_t seed)
{
    return (struct gd__stop){.kind = GD__STOP_SEED, .seed = seed};
}

/* Stores a failure in the builder's status. */
static inline struct gd__stop gd__stop_failed(struct gd__path_builder *builder,
                                              enum gd_status status)
{
    if (!builder->status) builder->status = status;
    return (struct gd__stop){.kind = GD__STOP_FAILED};
}

/* Appends the crossings of the ray with edges until it reaches its source or passes through a
 * vertex. */
struct gd__stop gd__ray_follow(struct gd__path_builder *builder, struct gd__ray ray);

/* Returns true if the source, a vertex or a point seed, lies in the face of `side` at (x, y). The
 * leg then ends in this face. */
bool gd__ray_has_arrived(const struct gd__path_builder *builder, uint32_t side, double x, double y,
                         uint32_t source);

/* Appends the source, where the leg ends. */
struct gd__stop gd__ray_arrive(struct gd__path_builder *builder, uint32_t face, uint32_t source);

/* Appends the projection of the last point onto a segment seed. The last point lies in the
 * segment's face. */
struct gd__stop gd__ray_arrive_at_chord(struct gd__path_builder *builder, uint32_t seed,
                                        uint32_t face);
