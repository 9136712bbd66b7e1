/* Rings: sets of vertices around the target of a guide, at increasing numbers of hops. Every path
 * to the target passes through all of them in turn, which gives a lower bound of its length.
 * Straight lines in space from ring to ring follow the surface better than one line to the target.
 *
 * Hops of a vertex are counted from the target's corners, along edges between vertices that a path
 * within the bound may pass. Along such a path hops change by at most one from vertex to vertex. So
 * a path that crosses hop number k meets a vertex of k hops, or the edge between two such vertices.
 * These vertices and edges form the ring at k. The points of a ring are its vertices and the
 * middles of its edges. Between two points of an edge, the bound is interpolated linearly, less the
 * greatest error of this interpolation (ring_sag in kernel/kernel_ring.h). */
#ifndef GD_KERNEL_RING_H
#define GD_KERNEL_RING_H

#include "mesh/anchor.h"

#define GD__RING_LANES   8
#define GD__RING_NOWHERE 1e18f /* a distance whose square fits in a float */

/* A position relative to the target, divided by the search's bound. */
struct gd__place {
    float x, y, z;
};

/* Points of a ring. x, y, z are positions relative to the target. `lower` is a lower bound of the
 * distance to the target. `part` is an upper bound on the lengths of the parts of edges between the
 * point and the neighbouring points of the ring. All values are divided by the search's bound.
 * Empty lanes are far away. */
struct gd__ring_group {
    float x[GD__RING_LANES], y[GD__RING_LANES], z[GD__RING_LANES], lower[GD__RING_LANES],
        part[GD__RING_LANES];
};

/* The rings of one search. A struct that is all zero has no rings. One thread. */
struct gd__rings {
    /* index of the first group of each ring, and the end of the last ring; the first ring is the
     * target itself */
    uint32_t *ring;
    uint32_t count, capacity;
    struct gd__ring_group *group;
    uint32_t group_count, group_capacity;
    uint32_t *hops; /* for each vertex, 1 + hops from the target; 0 if not marked */
    uint32_t vertices;
    uint32_t *marked; /* vertices, in order of their hops */
    uint32_t marked_count, marked_capacity;
    double bound; /* bound of the search */
    float slack;  /* rounding of a step from ring to ring */
};

#endif
