/* Rings: sets of vertices and edges around the target of a guide, at increasing numbers of hops.
 * Every path to the target passes through all rings, one after another. So the sum of the straight
 * lines in space from ring to ring is a lower bound of the path's length. These lines follow the
 * surface better than one straight line to the target.
 *
 * The hops of a vertex are the number of edges from the target's corners to this vertex. An edge is
 * used only if paths within the bound may pass both of its ends. From vertex to vertex along such a
 * path, the hops change by at most one. So a path to a vertex of more than k hops meets a vertex
 * of k hops, or the edge between two such vertices. These vertices and edges form the ring at k.
 * The points of a ring are its vertices and the middles of its edges. Between two points of an
 * edge, the bound is interpolated linearly, and the greatest error of this interpolation is
 * subtracted (ring_sag in kernel/kernel_ring.h). */
#pragma once

#include "mesh/anchor.h"

#define GD__RING_LANES 8
/* a very large distance whose square is still in the range of floats */
#define GD__RING_NOWHERE 1e18f

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
    uint32_t *hops; /* for each vertex, 1 + its hops from the target, or 0 if it is not marked */
    uint32_t vertices;
    uint32_t *marked; /* the marked vertices, in the order of their hops */
    uint32_t marked_count, marked_capacity;
    double bound; /* bound of the search */
    float slack;  /* rounding error of a step from ring to ring */
};
