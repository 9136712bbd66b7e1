/* Wavefront: the state of one propagation of windows from a set of seeds over a mesh, and the loop that drives it.
 *
 * DESIGN
 * - One kernel, gd__wavefront_run, with five inputs: seeds, bound, sink, monitor (gd_control) and executor. A mode is a choice of these.
 * - Work is label-correcting: a side's list may be propagated again when new windows reach it, a vertex may emit again when its distance
 *   falls. The queue orders the work by distance; order costs time, never exactness.
 * - Invariants: the windows of a list are sorted and disjoint; each of them is a path that exists, so distances are upper bounds at any time;
 *   a window is dropped only where an existing path is strictly shorter or no path below the bound can use it.
 * - At the end all windows and vertex distances that are shorter than the bound are final (the paper's Property 5).
 * - All lengths are in the mesh's inside unit. One owner, one thread; the executor is for the sink. */
#ifndef GD_WEDGE_WAVEFRONT_H
#define GD_WEDGE_WAVEFRONT_H

#include "gd/executor.h"
#include "mesh/topology.h"
#include "wedge/list.h"
#include "wedge/queue.h"

#define GD__FAR 1e300 /* not reached yet; inside lengths stay far below */

/* How a vertex got its distance: the last leg of its shortest path. The leg starts at (x, -y) in the frame of `side`, the side opposite to the
 * vertex: beyond the side where it crosses it (y >= 0), in the face itself where a seed lies there (y < 0). The direction back is stored by
 * its far end, not by the crossing: where the vertex lies on or almost on that side, the crossing would not tell it. */
struct gd__birth {
    double x, y;
    uint32_t side; /* GD_NONE: the leg runs along an edge */
    uint32_t
        source; /* pseudo-source in which the leg starts; GD_NONE: the path bends at (x, 0) of the side, the edge knows how it goes on */
};

/* A seed in inside terms. */
struct gd__seed {
    struct gd_point point;
    double offset;
};

/* The means by which useless work is avoided; all false: all of them are used. Results are the same with any of them off: they exist to be
 * measured (tests/bench). */
struct gd__methods {
    bool
        separate_sides; /* do not prune a side's windows by the other side of its edge (the paper's half-edge structure) */
    bool no_filter;     /* do not compare windows with the distances of their edge's ends */
    bool no_cone;       /* saddle and boundary vertices emit all round, not only into their shadow */
    bool no_coalescing; /* neighbouring windows of one source stay apart */
};

/* What to propagate, and how far. Everything is borrowed. */
struct gd__propagation {
    const struct gd__seed *seeds;
    uint32_t seed_count;
    double radius;                 /* inside unit; GD__FAR: no limit */
    const struct gd_point *target; /* NULL: none */
    struct gd__methods methods;
};

/* What a propagation did. */
struct gd__effort {
    uint64_t windows_created, windows_propagated, sides_propagated, vertices_emitted;
};

struct gd__wavefront {
    const struct gd_mesh *mesh;
    const struct gd__seed *seeds;
    uint32_t seed_count;
    struct gd__methods methods;

    struct gd__list *lists;  /* per side */
    double *distance;        /* per vertex */
    double *emitted;         /* per vertex: the distance that it last emitted windows with */
    struct gd__birth *birth; /* per vertex */

    double bound;              /* nothing farther is wanted; shrinks towards the target's distance */
    uint32_t target_corner[4]; /* vertices of the target's faces, GD_NONE fills */
    double target_leg[4];      /* and their distances from the target within a face */

    struct gd__queue queue; /* sides, then vertices */
    struct gd__pool pool;
    struct gd__stack left, right, scratch;
    const struct gd_control *monitor;
    enum gd_status status;  /* sticky: the first failure */
    uint64_t sides_visited; /* different ones: progress */
    struct gd__effort effort;
};

/* What happens to the windows in the end: called once, with everything final, may take arrays out of the wavefront (leaving NULL). */
struct gd__sink {
    enum gd_status (*take)(void *user, struct gd__wavefront *front, const struct gd_executor *executor);
    void *user;
};

/* The kernel: seeds the wavefront, propagates until nothing within the bound is left, hands the result to the sink.
 * Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE and the sink's. */
GD_MUST_USE enum gd_status gd__wavefront_run(const struct gd_mesh *mesh, const struct gd__propagation *propagation,
                                             const struct gd__sink *sink, const struct gd_control *monitor,
                                             const struct gd_executor *executor);

/* --- between the sources of this room ----------------------------------------------------------------------------------- */

/* Offers a vertex a distance; takes it if strictly shorter, and queues the vertex if paths may bend there. */
void gd__wavefront_reach(struct gd__wavefront *front, uint32_t vertex, double distance, struct gd__birth birth);

/* Offers a side new windows, in `windows` (used up), and queues the side. */
void gd__wavefront_deliver(struct gd__wavefront *front, uint32_t side, struct gd__stack *windows);

/* emit.c: windows and neighbour distances of the seeds, and of a saddle or boundary vertex into its shadow cone. */
void gd__emit_seeds(struct gd__wavefront *front);
void gd__emit_vertex(struct gd__wavefront *front, uint32_t vertex);

/* propagate.c: windows of a side across its face. */
void gd__propagate_side(struct gd__wavefront *front, uint32_t side);

/* The windows that a window on `side` casts onto the two other edges of the side's face; false where there is none. */
struct gd__children {
    struct gd__window left, right;
    bool has_left, has_right;
};
struct gd__children gd__window_children(const struct gd_side *side, const struct gd__window *window);

#endif
