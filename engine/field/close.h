/* Close seeds: seeds in another face than a point's, across an edge that both are beside, or round
 * a vertex that both are beside. Wedges would lose the digits of so short a distance; here it is
 * made of small weights and their differences. Inside unit. */
#ifndef GD_FIELD_CLOSE_H
#define GD_FIELD_CLOSE_H

#include "field/trail.h"
#include "mesh/polar.h"

/* The straight way from a close seed to a point. */
struct gd__close {
    double distance; /* with the seed's offset */
    uint32_t seed;
    uint32_t side; /* of the point's face */
    /* from the seed to the point, the seed's face laid flat into the side's frame */
    struct gd__local way;

    /* across an edge: where the way crosses `side`, from its origin and from its end */
    double t, rest;

    /* round a vertex: the point and the seed; vertex GD_NONE: across an edge */
    struct gd__polar at, to;
    double turn; /* from the point to the seed, counter-clockwise, between -pi and pi */
};

/* Whether a point of a face may have close seeds: it is beside an edge. */
static inline bool gd__close_may_be(const double weight[3])
{
    const double most = GD_TOL_BESIDE_VERTEX;
    return (weight[0] <= most) | (weight[1] <= most) | (weight[2] <= most);
}

/* The nearest of the close seeds, if it is nearer than `known`. False: there is none. `weight`: of
 * the point, which lies in `face`. O(1) unless the point is beside an edge or a vertex, then
 * O(degree x log seeds + seeds close by). */
bool gd__close_find(const struct gd_field *field, uint32_t face, const double weight[3],
                    double known, struct gd__close *out);

/* Appends the way from a point, the last one of the trail, to its close seed. */
void gd__close_trace(struct gd__trail *trail, uint32_t face, const struct gd__close *close);

#endif
