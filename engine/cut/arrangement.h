/* Arrangement: the curve's segments, split until they meet in nodes only.
 *
 * DESIGN. A segment joins two nodes of one face. Two nodes on one side of it make a run along the
 * edge instead. Each segment that waits is
 *     rerouted   through a node that it passes by less than half a reach (nodes.h): so none
 *                is passed closely;
 *     split      at its crossing with a segment that was kept before, which is split too and
 *                waits again;
 *     kept       otherwise.
 * A new node sends the kept segments that pass it closely back to wait. Nodes keep a reach from
 * each other: a rerouted segment's parts are shorter than it by a share that is bounded, so that
 * this ends. In faces narrower than the reach it need not: the work is counted and stops. In the
 * end kept segments that share no node are half a reach apart, far more than the rounding of
 * crossings to the lattice. */
#ifndef GD_CUT_ARRANGEMENT_H
#define GD_CUT_ARRANGEMENT_H

#include "cut/nodes.h"
#include "gd/curve.h"

struct gd__segment {
    uint32_t a, b; /* nodes */
    uint32_t face;
    uint32_t next; /* kept: of the same face; waiting: below it on the stack; GD_NONE: the last */
};

struct gd__run { /* from node a to node b along an edge */
    uint32_t edge, a, b;
};

struct gd__arrangement { /* all zero: none */
    struct gd__nodes nodes;
    struct gd__segment *segments;
    uint32_t segment_count, segment_capacity;
    struct gd__run *runs;
    uint32_t run_count, run_capacity;
    uint32_t *of_face; /* the first kept segment; GD_NONE: there is none */
    uint32_t waiting;  /* top of the stack; GD_NONE: empty */
    uint64_t work;     /* segments that were taken up */
};

/* The arrangement of a curve. GD_INVALID_ARGUMENT (consecutive points without a common face),
 * GD_RUNAWAY (it did not end: a larger snap may help), GD_TOO_LARGE, GD_NO_MEMORY, GD_BUDGET,
 * GD_CANCELLED, GD_DEADLINE. On failure nothing is held. */
GD_MUST_USE enum gd_status gd__arrange(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                       double snap, struct gd__budget *budget,
                                       struct gd__arrangement *out, struct gd_detail *detail);
/* of one that is all zero: harmless */
void gd__arrangement_free(struct gd__arrangement *arrangement);

/* Has the face nodes or segments of its own, or nodes on its sides? */
bool gd__is_crossed(const struct gd__arrangement *arrangement, uint32_t face);

#endif
