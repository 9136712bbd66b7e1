/* The workspace from the inside: arrays that are clean between propagations, so that a propagation
 * pays for what it touches only. */
#ifndef GD_WAVEFRONT_WORKSPACE_H
#define GD_WAVEFRONT_WORKSPACE_H

#include "base/region.h"
#include "gd/workspace.h"
#include "mesh/topology.h"
#include "window/predecessor.h"
#include "guide/guide.h"
#include "window/list.h"
#include "wavefront/near.h"
#include "wavefront/queue.h"

struct gd_workspace {
    uint32_t edges, vertices; /* that the arrays have room for */

    /* Clean, each array: no windows; GD__FAR; 0; GD_NONE. A propagation may keep distance, predecessor
     * and newest, all three: they are NULL then. */
    struct gd__list *lists; /* per side */
    double *emitted;        /* per vertex: the distance that it last emitted windows with */
    /* per vertex: where in `wedges` the chunks of its present distance begin, in GD__CHUNK_UNITs */
    uint32_t *since;
    uint32_t *waiting;                   /* per vertex: bucket of the queue, GD_NONE: in none */
    double *distance;                    /* per vertex */
    struct gd__predecessor *predecessor; /* per vertex */
    /* of distance, predecessor, newest: just those of the last mesh */
    uint32_t result_edges, result_vertices;
    /* per edge: its newest chunk of wedges, in GD__CHUNK_UNITs of `wedges`; GD_NONE: none */
    uint32_t *newest;

    /* sides, then vertices behind all sides: what is not clean; as many as fit, see
       touched_count */
    uint32_t *touched;
    uint32_t touched_capacity, touched_count; /* count > capacity: anything may be touched */

    /* in place of all these for a propagation that keeps distances only; closed between
       propagations */
    struct gd__near near;

    struct gd__guide guide; /* of searches for one target */

    /* of the propagation at hand: arrays, windows and wedges come from one budget */
    struct gd__budget budget;
    struct gd__region wedges; /* chunks; closed where a propagation kept them */
    struct gd__queue *queue;
    struct gd__pool pool;
    struct gd__children left, right;
    struct gd__scratch scratch;
    /* of the second wavefront of a field on two threads (partition.h); NULL: none yet */
    struct gd_workspace *partner;
};

/* The partner, made if there is none; NULL without memory. */
struct gd_workspace *gd__workspace_partner(struct gd_workspace *workspace);

/* Bytes that a propagation over the mesh takes before it begins. */
size_t gd__workspace_need(const struct gd_mesh *mesh);

/* Makes room for the mesh: all arrays are there and clean, the queue empty with buckets of that
 * width. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__workspace_open(struct gd_workspace *workspace,
                                              const struct gd_mesh *mesh, double bucket_width,
                                              const struct gd_control *control);

/* The same for one that keeps distances only: what it has is in `near`, the arrays are left
 * alone. */
GD_MUST_USE enum gd_status gd__workspace_open_near(struct gd_workspace *workspace,
                                                   const struct gd_mesh *mesh, double bucket_width,
                                                   const struct gd_control *control);

/* Cleans what the propagation touched. */
void gd__workspace_clean(struct gd_workspace *workspace);

/* Notes what is not clean any more, if it is the first time. Without a branch on that, which would
 * be as good as random. */
static inline void gd__workspace_touch(struct gd_workspace *workspace, uint32_t node,
                                       bool first_time)
{
    if (workspace->touched_count < workspace->touched_capacity)
        workspace->touched[workspace->touched_count] = node;
    workspace->touched_count += first_time;
}

#endif
