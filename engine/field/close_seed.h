/* Close seeds: a seed is close to a point in another face if both lie beside the same edge or the
 * same vertex. The distance between seed and point may be very short, and would lose digits if it
 * were computed from wedges. Therefore these functions compute it from barycentric weights that are
 * small, and from differences of weights. Normalised unit. */
#pragma once

#include "field/path_builder.h"
#include "mesh/polar.h"

/* The straight line from a close seed to a point. */
struct gd__close_seed {
    double distance; /* including the seed's offset */
    uint32_t seed;
    uint32_t side; /* a side of the point's face */
    /* vector from the seed to the point, in the side's frame; the seed's face is unfolded into the
     * plane of the point's face */
    struct gd__local way;

    /* across an edge: distances of the crossing from the origin and from the end of `side` */
    double t, rest;

    /* around a vertex: polar coordinates of the point and of the seed. If at.vertex is GD_NONE, the
       line runs across an edge instead */
    struct gd__polar at, to;
    double turn; /* angle from the point to the seed, counter-clockwise, in [-pi, pi] */
};

/* Returns true if a point of a face may have close seeds, because it lies beside an edge. */
static inline bool gd__close_seed_may_be(const double weight[3])
{
    const double most = GD_TOL_BESIDE_VERTEX;
    return (weight[0] <= most) | (weight[1] <= most) | (weight[2] <= most);
}

/* Finds the nearest close seed; returns false if none is nearer than `known`. `weight` are the
 * weights of the point in `face`. O(1); for a point beside an edge or a vertex O(degree x log seeds
 * + close seeds). */
bool gd__close_seed_find(const struct gd_field *field, uint32_t face, const double weight[3],
                         double known, struct gd__close_seed *out);

/* Appends the line from the builder's last point to its close seed. */
void gd__close_seed_trace(struct gd__path_builder *builder, uint32_t face,
                          const struct gd__close_seed *close);
