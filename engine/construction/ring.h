/* Ring: the remaining corners of one polygon, in space and in the polygon's mean plane. In the
 * plane they run counter-clockwise. */
#pragma once

#include "gd/polygons.h"
#include "gd/vec.h"
#include "construction/edge_set.h"

struct gd__ring_corner {
    double x, y;  /* in the plane */
    double score; /* the corner with the best score is cut off next, see triangulate.c */
    /* position relative to corner 0, in units of the polygon's extent, so that products neither
       overflow nor underflow */
    struct gd_vec3 position;
    uint32_t vertex, previous, next;
    /* index in the list of reflex corners, or GD_NONE if the corner is convex or cut off */
    uint32_t reflex_slot;
};

/* Fills corner[0 .. count-1] with the whole polygon. */
void gd__ring_make(const double (*positions)[3], const uint32_t *vertex, uint32_t count,
                   struct gd__ring_corner *corner);

/* Returns twice the signed area of abc in the plane: positive for a left turn. */
static inline double gd__ring_turn(const struct gd__ring_corner *a, const struct gd__ring_corner *b,
                                   const struct gd__ring_corner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* Returns 4 sqrt(3) area / (sum of squared sides) in space: 1 for an equilateral triangle, 0 for a
 * triangle of area zero. */
double gd__ring_shape(const struct gd__ring_corner *a, const struct gd__ring_corner *b,
                      const struct gd__ring_corner *c);

/* Returns true if a-b may be a diagonal: the edge does not exist yet, and its length is not
 * zero. */
bool gd__ring_may_join(const struct gd__edge_set *edges, const struct gd__ring_corner *a,
                       const struct gd__ring_corner *b);
