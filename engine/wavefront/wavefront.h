/* Wavefront: the state of one propagation of windows from a set of seeds over a mesh, and the loop
 * that drives it.
 *
 * DESIGN
 * - gd__wavefront_run is the only loop. Seeds, bound, sink and monitor select the mode.
 * - All windows that wait on a side are filtered, stored as wedges, cast across the face and
 *   released together. Later arrivals on that side form a new list.
 * - The propagation is label-correcting: a vertex emits again when its distance decreases, and a
 *   side is propagated again when new windows reach it. The order of the queue affects the time,
 *   but never the exactness. Windows of a side that is propagated often are pruned against its
 *   stored wedges.
 * - Invariants: the windows of a list are sorted and disjoint. Each window describes existing
 *   paths, so distances are upper bounds. A window is dropped only where an existing path is
 *   shorter, or where no path below the bound can use it.
 * - At the end, distances and windows below the bound are final (Property 5 of the paper).
 * - Lengths are in the mesh's normalised unit. One owner, one thread. */
#pragma once

#include "mesh/polar.h"
#include "kernel/kernel.h"
#include "wavefront/workspace.h"

/* A seed in internal numbering: a point, or the open segment from `point` to `end`. The ends of a
 * segment are separate seeds. */
struct gd__seed {
    struct gd_point point;
    double offset;
    struct gd_point end;
    bool is_segment;
    /* Face that a segment crosses, or GD_NONE if the segment runs along an edge. Set when seeds are
     * indexed, before propagation. The value in a stored image of a field is ignored. */
    uint32_t face;
};

/* Optimisations that are switched off. All false is the fastest variant. The distances of all
 * variants agree up to rounding. A field that fails its check is built again in another variant,
 * because other rounding errors occur there (field.c). */
struct gd__variant {
    bool no_filter; /* true if windows are not compared with the distances of their edge's ends */
    /* true if saddle and boundary vertices emit into all directions instead of only into their
       shadow cone */
    bool no_cone;
    bool no_coalescing; /* true if neighbouring windows of one source are not joined */
#ifdef GD_ABLATION      /* tests/bench only */
    bool one_list;      /* true if windows are also pruned by the wedges of the edge's other side */
#endif
};

/* Input of a propagation. All pointers are borrowed. */
struct gd__propagation {
    const struct gd__seed *seeds;
    uint32_t seed_count;
    double radius;                 /* normalised unit; GD__FAR means no limit */
    const struct gd_point *target; /* NULL means no target */
    /* Bounds for one target. With a guide, only the target's distance and path are final. NULL
       means no guide. */
    struct gd__guide *guide;
    /* If not NULL: only the distances of these points are needed, no paths. Wedges are stored for
       the points' faces and for gd__prune_by_stored only. */
    const struct gd_point *points;
    uint32_t point_count;
    /* Computes distances of vertices only, in little memory: the sink reads front->distance. Wedges
     * are stored for gd__prune_by_stored only. Requires no guide. */
    bool without_wedges;
    /* Limit on windows; 0 means the default limit of the mesh, far above the windows of any real
       mesh. */
    uint64_t work_limit;
    struct gd__variant variant;
};

/* Counters of a propagation. */
struct gd__work_counts {
    uint64_t windows_created, windows_propagated, sides_propagated, vertices_emitted;
    /* stored wedges that were compared with windows, see gd__prune_by_stored */
    uint64_t wedges_compared;
};

struct gd__wavefront {
    const struct gd_mesh *mesh;
    const struct gd__seed *seeds;
    uint32_t seed_count;
    struct gd__variant variant;

    const struct gd__kernel *kernel;

    struct gd_workspace *work;
    /* Paged records, if only distances are computed. Otherwise NULL, and the arrays below are
       used. */
    struct gd__paged *paged;
    struct gd__list *lists; /* the workspace's arrays, described in workspace.h */
    double *distance, *emitted;
    uint32_t *waiting, *newest;
    struct gd__predecessor *predecessor;
    struct gd__queue *queue;
    uint64_t wedge_count;
    enum gd__wedge_form wedge_form; /* form of new chunks */
    /* how many times a distance decreased although windows that depend on it were already queued */
    uint32_t distance_drops;

    struct gd__guide *guide;
    /* When lists are merged, pieces narrower than this are dropped. Relative to the length of the
     * edge. */
    double narrowest;
    /* Windows and distances beyond this bound are not needed. It shrinks with the target's
     * distance. */
    double bound;
    bool takes_all;            /* true if lists accept windows at any distance */
    uint32_t target_corner[4]; /* vertices of the target's faces, padded by GD_NONE */
    double target_leg[4];      /* distances of these vertices from the target within the face */
    bool stores_all;           /* true if the wedges of all sides are stored */

    const struct gd_control *monitor;
    enum gd_status status;  /* the first failure; not overwritten by later ones */
    uint64_t sides_visited; /* sides visited at least once, for the progress */
    uint64_t work_limit;    /* limit on windows; GD_RUNAWAY beyond it */
    struct gd__work_counts counts;
};

/* Receives the result. Called once, when all distances and wedges are final. The sink may take the
 * workspace's arrays `distance`, `predecessor`, `newest` and `wedges`. It must then set their
 * pointers to NULL and leave the region closed. The other arrays are reused. */
struct gd__sink {
    enum gd_status (*take)(void *user, struct gd__wavefront *front);
    void *user;
};

/* Seeds the wavefront, propagates until nothing within the bound is left, and calls the sink.
 * Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_RUNAWAY and those of the sink. */
GD_MUST_USE enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                             const struct gd__propagation *propagation,
                                             const struct gd__sink *sink,
                                             const struct gd_control *monitor);

/* --- shared by the sources of this folder ----------------------------------------------------- */

/* Returns a lower bound of the distance from a vertex to the target. */
static inline double gd__wavefront_rest(const struct gd__wavefront *front, uint32_t vertex)
{
    return front->guide ? gd__guide_lower(front->guide, vertex) : 0;
}

/* Return the record of a side, an edge or a vertex. The record is in the arrays or in a page. The
 * page must exist (gd__paged_need_side, gd__paged_need_vertex). */
static inline struct gd__list *gd__wavefront_list(const struct gd__wavefront *front, uint32_t side)
{
    return front->paged ? &gd__paged_side(front->paged, side)->list[side % GD__PAGE_SIDES]
                        : &front->lists[side];
}

static inline uint32_t *gd__wavefront_newest(const struct gd__wavefront *front, uint32_t edge)
{
    return front->paged
               ? &gd__paged_side(front->paged, 2 * edge)->newest[edge % (GD__PAGE_SIDES / 2)]
               : &front->newest[edge];
}

static inline uint32_t *gd__wavefront_waiting(const struct gd__wavefront *front, uint32_t vertex)
{
    return front->paged
               ? &gd__paged_vertex(front->paged, vertex)->waiting[vertex % GD__PAGE_VERTICES]
               : &front->waiting[vertex];
}

static inline double *gd__wavefront_emitted(const struct gd__wavefront *front, uint32_t vertex)
{
    return front->paged
               ? &gd__paged_vertex(front->paged, vertex)->emitted[vertex % GD__PAGE_VERTICES]
               : &front->emitted[vertex];
}

static inline struct gd__predecessor *gd__wavefront_predecessor(const struct gd__wavefront *front,
                                                                uint32_t vertex)
{
    return front->paged
               ? &gd__paged_vertex(front->paged, vertex)->predecessor[vertex % GD__PAGE_VERTICES]
               : &front->predecessor[vertex];
}

/* Returns the offset at which the chunks with the vertex' present distance begin, or 0 if it is
 * unknown. */
static inline uint32_t gd__wavefront_valid_from(const struct gd__wavefront *front, uint32_t vertex)
{
    if (!front->paged) return front->work->valid_from[vertex];
    const struct gd__vertex_page *page = gd__paged_vertex(front->paged, vertex);
    return page ? page->valid_from[vertex % GD__PAGE_VERTICES] : 0;
}

/* Returns the sigma of a stored wedge: the distance of its pseudo-source. A linear wedge stores its
 * sigma itself. */
static inline double gd__wavefront_sigma(const struct gd__wavefront *front,
                                         const struct gd__window *w)
{
    uint32_t vertices = front->mesh->vertex_count;
    if (gd__window_is_linear(w)) return w->sigma;
    return w->source < vertices ? front->distance[w->source]
                                : front->seeds[w->source - vertices].offset;
}

/* Offers a vertex a distance. If this distance is strictly shorter than the vertex' distance,
 * stores it, and queues the vertex if paths may bend there. */
void gd__wavefront_reach(struct gd__wavefront *front, uint32_t vertex, double distance,
                         struct gd__predecessor predecessor);

/* A side that receives windows, with values that the caller has already loaded. */
struct gd__receiver {
    uint32_t side;
    double length;
    double d0, d1; /* distances of the side's ends */
    /* lower bounds of the distances from the ends to the target; 0 without a guide */
    double l0, l1;
    /* value of front->distance_drops when the sigma of the windows was read */
    uint32_t distance_drops;
};

/* The caller passes the length of the side, because the record of a side that is not in the cache
 * would be loaded only for it. */
static inline struct gd__receiver gd__wavefront_receiver(const struct gd__wavefront *front,
                                                         uint32_t side, double length)
{
    uint32_t origin = front->mesh->origin[side], destination = front->mesh->origin[side ^ 1];
    return (struct gd__receiver){side,
                                 length,
                                 front->distance[origin],
                                 front->distance[destination],
                                 gd__wavefront_rest(front, origin),
                                 gd__wavefront_rest(front, destination),
                                 front->distance_drops};
}

/* Offers a side new windows and queues the side. The side takes over the windows. Their order does
 * not change, but their ends may be cut. */
void gd__wavefront_deliver(struct gd__wavefront *front, const struct gd__receiver *to,
                           struct gd__children *windows);

/* Counts windows before they enter the list of a side. */
static inline void gd__wavefront_note_windows(struct gd__wavefront *front, struct gd__list *list,
                                              uint32_t side, uint32_t count)
{
    front->counts.windows_created += count;
    gd__workspace_touch(front->work, side, !list->touched);
    list->touched = true;
}

/* Like gd__wavefront_offer, but also for a list that is not empty, and for wavefronts that do not
 * accept every window. */
void gd__wavefront_offer_with_care(struct gd__wavefront *front, uint32_t side, double length,
                                   const struct gd__window *window);

/* Offers a side one window. If the wavefront accepts every window, the side's key is the distance
 * in the middle of the window. This key is as good for the order of the queue as a key from the
 * distances of the side's ends. So these distances need not be loaded. */
static inline void gd__wavefront_offer(struct gd__wavefront *front, uint32_t side, double length,
                                       const struct gd__window *window)
{
    if (!front->takes_all || front->lists[side].count) {
        gd__wavefront_offer_with_care(front, side, length, window);
        return;
    }
    struct gd__list *list = &front->lists[side];
    gd__wavefront_note_windows(front, list, side, 1);
    list->distance_drops = front->distance_drops;
    enum gd_status status = gd__list_begin(list, &front->work->pool, window);
    if (!front->status) front->status = status;
    if (!status)
        gd__queue_push(front->queue, side, gd__window_distance_in_middle(window), &list->bucket);
}

/* seeds.c, emit.c: emit the windows of the seeds, or of a saddle or boundary vertex into its shadow
 * cone. Offer distances to the neighbours. */
void gd__emit_seeds(struct gd__wavefront *front);
void gd__emit_vertex(struct gd__wavefront *front, uint32_t vertex);

/* emit.c: emits from a seed beside a vertex into the faces of the vertex that do not contain the
 * seed. The windows pass the vertex on both sides, and rays from the vertex limit them (doc
 * 002). */
void gd__emit_beside(struct gd__wavefront *front, uint32_t seed, const struct gd__polar *polar);

/* propagate.c: stores a window of a side as a wedge without propagating it. */
void gd__store_window(struct gd__wavefront *front, uint32_t side, const struct gd__window *window);

/* propagate.c: stores the waiting windows of a side as wedges and casts them across its face. */
void gd__propagate_side(struct gd__wavefront *front, uint32_t side);

/* The stored wedges that prune the windows of a side. OWN: those of the side itself, which win
 * ties. OTHER: those of the edge's other side, which lose ties. */
enum gd__prune_by { GD__PRUNE_BY_OWN = 1, GD__PRUNE_BY_OTHER = 2 };

/* prune.c: removes the parts of windows where a stored wedge is better. On entry and on return,
 * *count is the number of windows. On return, *windows may point into scratch memory. Errors:
 * GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__prune_by_stored(struct gd__wavefront *front, uint32_t side,
                                               enum gd__prune_by by, struct gd__windows *windows,
                                               uint32_t *count);
