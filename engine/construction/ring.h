/* Ring: the corners of one polygon that are still to be triangulated, in space and in the polygon's
 * mean plane, where they run counter-clockwise. */
#ifndef GD_CONSTRUCTION_RING_H
#define GD_CONSTRUCTION_RING_H

#include "gd/polygons.h"
#include "gd/vec.h"
#include "construction/edge_set.h"

struct gd__ring_corner {
    double x, y;  /* in the plane */
    double score; /* as the next ear, see ear.c */
    /* from corner 0, in units of the polygon's extent: no product overflows or vanishes */
    struct gd_vec3 position;
    uint32_t vertex, previous, next;
    uint32_t reflex_slot; /* in the list of reflex corners, GD_NONE: convex or cut off */
};

/* Fills corner[0 .. count-1] with the whole polygon. */
void gd__ring_make(const double (*positions)[3], const uint32_t *vertex, uint32_t count,
                   struct gd__ring_corner *corner);

/* Twice the signed area of abc in the plane: > 0 where the ring turns left. */
static inline double gd__ring_turn(const struct gd__ring_corner *a, const struct gd__ring_corner *b,
                                   const struct gd__ring_corner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* 4 sqrt(3) area / (sum of squared sides) in space: 1 for an equilateral triangle, 0 for one of
 * area zero. */
double gd__ring_shape(const struct gd__ring_corner *a, const struct gd__ring_corner *b,
                      const struct gd__ring_corner *c);

/* May a and b be joined by a diagonal: no edge does yet, and it would not have length zero. */
bool gd__ring_may_join(const struct gd__edge_set *edges, const struct gd__ring_corner *a,
                       const struct gd__ring_corner *b);

#endif
