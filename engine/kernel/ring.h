/* Rings: sets of vertices round the target of a guide, so many edges apart, through all of which
 * any way to it passes in turn, and what they tell of the length of such a way: a straight line in
 * space from ring to ring comes nearer to the surface than one to the target itself.
 *
 * A vertex' hops are counted from the target's corners, along edges between vertices that a way
 * within the bound may pass by. Along such a way they change by one from vertex to vertex, so that
 * it meets, wherever it has k of them, a vertex that has k or the edge between two: those vertices
 * are the ring at k. A ring's points are those vertices and the middles of those edges. What is
 * stored for them bounds the ways from all points of the edges too, by a linear function between
 * two points that are s apart: the least of linear functions is concave, and a distance in space
 * lies below its chord, see ring_sag in kernel/kernel_ring.h. */
#ifndef GD_KERNEL_RING_H
#define GD_KERNEL_RING_H

#include "mesh/anchor.h"

#define GD__RING_LANES   8
#define GD__RING_NOWHERE 1e18f /* its square is a float */

/* A place from the target, over the search's bound. */
struct gd__place {
    float x, y, z;
};

/* Points of a ring: places from the target, lower bounds of the ways to it, and lengths that no
 * part of an edge between the point and the next one of the ring exceeds, all over the search's
 * bound. Empty lanes are far off. */
struct gd__ring_group {
    float x[GD__RING_LANES], y[GD__RING_LANES], z[GD__RING_LANES], lower[GD__RING_LANES],
        part[GD__RING_LANES];
};

/* Those of one search; all zero: none. Of one thread. */
struct gd__rings {
    /* the first group of each; the first ring is the target itself; one more, which ends the
       last */
    uint32_t *ring;
    uint32_t count, capacity;
    struct gd__ring_group *group;
    uint32_t group_count, group_capacity;
    uint32_t *hops; /* per vertex: 1 + hops from the target; 0: not marked */
    uint32_t vertices;
    uint32_t *marked; /* vertices, by their hops */
    uint32_t marked_count, marked_capacity;
    double bound; /* of the search */
    float slack;  /* of a step from ring to ring, for rounding */
};

#endif
