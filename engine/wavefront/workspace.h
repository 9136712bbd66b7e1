/* Workspace: arrays that are clean (have their initial values) between propagations. After a
 * propagation, only the records that it touched are cleaned. So this cost does not depend on the
 * size of the mesh. */
#pragma once

#include "base/region.h"
#include "gd/workspace.h"
#include "mesh/topology.h"
#include "window/predecessor.h"
#include "guide/guide.h"
#include "window/list.h"
#include "wavefront/paged.h"
#include "wavefront/queue.h"

struct gd_workspace {
    uint32_t edges, vertices; /* capacity of the arrays */

    /* The clean values are: an empty list for `lists`; GD__FAR for `emitted` and `distance`; 0 for
     * `valid_from`; GD_NONE for `waiting`, `newest` and the members of a predecessor. A propagation
     * may take `distance`, `predecessor` and `newest`, all three together. These pointers are then
     * NULL. */
    struct gd__list *lists; /* per side */
    double *emitted;        /* for each vertex, the distance with which it last emitted */
    /* For each vertex, an offset in `wedges`, in GD__CHUNK_UNITs. The chunks with the vertex'
       present distance begin there. */
    uint32_t *valid_from;
    /* for each vertex, bucket of the queue in which it waits, or GD_NONE if it does not wait */
    uint32_t *waiting;
    double *distance;                    /* per vertex */
    struct gd__predecessor *predecessor; /* per vertex */
    /* sizes of `distance`, `predecessor` and `newest`, which fit the last mesh exactly */
    uint32_t result_edges, result_vertices;
    /* for each edge, its newest chunk of wedges, in GD__CHUNK_UNITs of `wedges`, or GD_NONE if
       there is none */
    uint32_t *newest;

    /* Numbers of the nodes that are not clean. A node is a side or a vertex; vertices are numbered
     * after all sides. */
    uint32_t *touched;
    /* if touched_count > touched_capacity, the list is incomplete, and any node may be dirty (not
     * clean) */
    uint32_t touched_capacity, touched_count;

    /* Used instead of the arrays in a propagation that computes distances only. Closed between
     * propagations. */
    struct gd__paged paged;

    struct gd__guide guide; /* the guide of a search for one target */

    /* The budget of the current propagation. Arrays, windows and wedges are charged to it. */
    struct gd__budget budget;
    struct gd__region wedges; /* memory of the chunks; closed if a propagation took it */
    struct gd__queue *queue;
    struct gd__pool pool;
    struct gd__children left, right;
    struct gd__scratch scratch;
    /* workspace of a second search at the same time (transport/control_points.c); NULL if not
       created yet */
    struct gd_workspace *partner;
};

/* Returns the partner and creates it at first use. NULL if there is no memory. */
struct gd_workspace *gd__workspace_partner(struct gd_workspace *workspace);

/* Returns the bytes that a propagation over the mesh needs before it begins. */
size_t gd__workspace_need(const struct gd_mesh *mesh);

/* Makes room for the mesh. Afterwards all arrays exist and are clean, and the queue is empty and
 * has buckets of that width. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__workspace_open(struct gd_workspace *workspace,
                                              const struct gd_mesh *mesh, double bucket_width,
                                              const struct gd_control *control);

/* Like gd__workspace_open, for a propagation that computes distances only: opens `paged` and leaves
 * the arrays unchanged. */
GD_MUST_USE enum gd_status gd__workspace_open_paged(struct gd_workspace *workspace,
                                                    const struct gd_mesh *mesh, double bucket_width,
                                                    const struct gd_control *control);

/* Cleans everything that the propagation touched. */
void gd__workspace_clean(struct gd_workspace *workspace);

/* Adds a node to the list of dirty nodes if `first_time` is true. Branchless, because a branch
 * would be mispredicted half of the time. */
static inline void gd__workspace_touch(struct gd_workspace *workspace, uint32_t node,
                                       bool first_time)
{
    if (workspace->touched_count < workspace->touched_capacity)
        workspace->touched[workspace->touched_count] = node;
    workspace->touched_count += first_time;
}
