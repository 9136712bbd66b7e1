/* Arrangement: the curve's segments, split until they only meet in nodes.
 *
 * DESIGN. A segment joins two nodes of one face. If both nodes are on the same side of the face,
 * the segment is stored as a run along that edge. Each waiting segment is
 *     rerouted   through a node within half a reach of it (nodes.h);
 *     split      at its crossing with a kept segment, which is split too and waits again;
 *     kept       otherwise.
 *
 * When a node is added, the kept segments near it wait again. Nodes are at least a reach apart, so
 * the parts of a rerouted segment are shorter by a bounded factor, and the process ends. In faces
 * narrower than the reach the process might not end, so the work is limited. At the end, kept
 * segments without a common node are at least half a reach apart, far more than the rounding of
 * crossings to the lattice. */
#pragma once

#include "cut/nodes.h"
#include "gd/curve.h"

struct gd__segment {
    uint32_t a, b; /* nodes */
    uint32_t face;
    /* the next kept segment of the same face, or the next waiting segment on the stack; GD_NONE for
       the last one */
    uint32_t next;
};

struct gd__run { /* a part of the curve along an edge, from node a to node b */
    uint32_t edge, a, b;
};

struct gd__arrangement { /* nodes.arena has the arrays */
    struct gd__nodes nodes;
    struct gd__segment *segments;
    uint32_t segment_count, segment_capacity;
    struct gd__run *runs;
    uint32_t run_count, run_capacity;
    uint32_t *of_face; /* for each face, its first kept segment, or GD_NONE if there is none */
    uint32_t waiting;  /* top of the stack; GD_NONE if empty */
    uint64_t work;     /* number of segments processed */
};

/* Computes the arrangement of a curve. Errors: GD_INVALID_ARGUMENT (consecutive points without a
 * common face), GD_RUNAWAY (work limit exceeded; a larger snap distance may help), GD_TOO_LARGE
 * (more than 2^24 segments), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__arrange(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                       double snap, struct gd__arena *arena,
                                       struct gd__arrangement *out, struct gd_detail *detail);

/* Returns true if the face has nodes or segments inside, or nodes on its sides. */
bool gd__is_crossed(const struct gd__arrangement *arrangement, uint32_t face);
