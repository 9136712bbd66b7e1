/* Wavefront: the state of one propagation of windows from a set of seeds over a mesh, and the loop
 * that drives it.
 *
 * DESIGN
 * - One loop, gd__wavefront_run (partition/run.h), with five inputs: seeds, bound, sink, monitor (gd_control) and
 *   executor. A mode is a choice of these.
 * - The windows that wait on a side are taken all at once: filtered, stored as wedges, cast across
 *   the face, forgotten. What arrives on that side later is a list of its own.
 * - Work is label-correcting: a vertex may emit again when its distance falls, a side may be
 *   propagated again when new windows reach it. The queue orders the work by distance; order costs
 *   time, never exactness. A side that is propagated again and again is compared with its stored
 *   wedges, so that only what is strictly better goes on.
 * - Invariants: the windows of a list are sorted and disjoint; each of them is a path that exists,
 *   so distances are upper bounds at any time; a window is dropped only where an existing path is
 *   strictly shorter or no path below the bound can use it.
 * - At the end all windows and vertex distances that are shorter than the bound are final (the
 *   paper's Property 5).
 * - All lengths are in the mesh's inside unit. One owner, one thread; with an executor two
 *   wavefronts share the surface (partition/partition.h). */
#ifndef GD_WAVEFRONT_WAVEFRONT_H
#define GD_WAVEFRONT_WAVEFRONT_H

#include "gd/executor.h"
#include "mesh/polar.h"
#include "kernel/kernel.h"
#include "wavefront/mail.h"
#include "wavefront/workspace.h"

/* A seed in inside terms: a point, or the open segment from `point` to `end`, whose ends are seeds
 * of their own. */
struct gd__seed {
    struct gd_point point;
    double offset;
    struct gd_point end;
    bool is_segment;
    /* that a segment runs across; GD_NONE: along an edge. Set where seeds are indexed, before any
       is propagated: an image's is not used */
    uint32_t face;
};

/* The means by which useless work is avoided; all false: the fastest choice. Results are the same
 * with any of them changed: they exist to be measured (tests/bench). */
struct gd__methods {
    /* prune a side's windows by the wedges of its edge's other side too (the paper's edge-based
       structure) */
    bool one_list;
    bool no_filter; /* do not compare windows with the distances of their edge's ends */
    /* saddle and boundary vertices emit all round, not only into their shadow */
    bool no_cone;
    bool no_coalescing; /* neighbouring windows of one source stay apart */
};

/* What a propagation of the same seeds has left that ended at a bound, to be taken up there: the
 * arrays of a partial field, of the mesh's sizes. */
struct gd__begun {
    double bound; /* inside unit, below GD__FAR: distances up to here are final */
    const double *distance;
    const struct gd__predecessor *predecessor;
    const uint32_t *newest;
    const char *wedges;
    size_t wedge_bytes;
    uint64_t wedge_count;
};

/* What to propagate, and how far. Everything is borrowed. */
struct gd__propagation {
    const struct gd__seed *seeds;
    uint32_t seed_count;
    /* goes on from there, by one wavefront; `radius` lies beyond its bound. NULL: from the seeds */
    const struct gd__begun *begun;
    double radius;                 /* inside unit; GD__FAR: no limit */
    const struct gd_point *target; /* NULL: none */
    /* towards one target: only its distance and path are final. NULL: none */
    struct gd__guide *guide;
    /* distances only, in little memory: the sink finds front->distance; what is stored is for
       gd__prune_by_stored. One wavefront; no guide, nothing begun */
    bool without_wedges;
    /* windows; 0: the mesh's own, far beyond what any surface of sense needs */
    uint64_t work_limit;
    struct gd__methods methods;
};

/* What a propagation did. */
struct gd__effort {
    uint64_t windows_created, windows_propagated, sides_propagated, vertices_emitted;
    uint64_t
        wedges_compared; /* stored ones that windows were compared with, see gd__prune_by_stored */
};

struct gd__wavefront {
    const struct gd_mesh *mesh;
    const struct gd__seed *seeds;
    uint32_t seed_count;
    struct gd__methods methods;

    const struct gd__kernel *kernel;

    struct gd_workspace *work;
    struct gd__near *near;  /* its records, without wedges; NULL: there are arrays */
    struct gd__list *lists; /* the workspace's arrays; in full in workspace.h */
    double *distance, *emitted;
    uint32_t *waiting, *newest;
    struct gd__predecessor *predecessor;
    struct gd__queue *queue;
    uint64_t wedge_count;
    uint32_t falls; /* how often a distance fell with which windows are on their way already */

    struct gd__guide *guide;
    /* parts of lists that are no wider, over their edge, are dropped when lists are put together */
    double narrowest;
    double bound; /* nothing farther is wanted; shrinks towards the target's distance */
    /* resume.c, while it looks for what a bound kept back: what surely was within that bound is not
       wanted again; 0: all is wanted */
    double inner;
    bool takes_all;            /* lists take whatever is offered, from near and far */
    uint32_t target_corner[4]; /* vertices of the target's faces, GD_NONE fills */
    double target_leg[4];      /* and their distances from the target within a face */

    struct gd__partition *partition; /* the part of the surface that is its own; NULL: all of it */

    const struct gd_control *monitor;
    enum gd_status status;  /* sticky: the first failure */
    uint64_t sides_visited; /* different ones: progress */
    uint64_t work_limit;    /* windows: more of them are a runaway */
    struct gd__effort effort;
};

/* What happens to the windows in the end: called once, with everything final. It may keep the
 * workspace's distance, predecessor, newest and wedges (leaving NULL, and the region closed); the rest is
 * used again. */
struct gd__sink {
    enum gd_status (*take)(void *user, struct gd__wavefront *front,
                           const struct gd_executor *executor);
    void *user;
};

/* The steps of a propagation by one wavefront, for room `partition`. Opens the workspace, */
GD_MUST_USE enum gd_status gd__wavefront_open(struct gd__wavefront *front,
                                              const struct gd__propagation *propagation);

/* propagates what waits before bucket `end` of the queue, at most `most` sides and vertices;
 * front->status tells of failure, */
void gd__wavefront_advance(struct gd__wavefront *front, uint32_t end, uint64_t most);

/* tells the other wavefront of a partition what it knows of a vertex, */
void gd__wavefront_tell(struct gd__wavefront *front, uint32_t vertex);

/* takes over what another wavefront knows of a vertex, if it is shorter by however little. */
void gd__wavefront_learn(struct gd__wavefront *front, const struct gd__vertex_letter *letter);

/* --- between the sources of this room --------------------------------------------------------- */

/* Lower bound of the way from a vertex to the target. */
static inline double gd__wavefront_rest(const struct gd__wavefront *front, uint32_t vertex)
{
    return front->guide ? gd__guide_lower(front->guide, vertex) : 0;
}

/* The records of a side, an edge or a vertex: from the arrays, or from near pages, where they must
 * be (gd__near_need_side, gd__near_need_vertex). */
static inline struct gd__list *gd__wavefront_list(const struct gd__wavefront *front, uint32_t side)
{
    return front->near ? &gd__near_side(front->near, side)->list[side % GD__PAGE_SIDES]
                       : &front->lists[side];
}

static inline uint32_t *gd__wavefront_newest(const struct gd__wavefront *front, uint32_t edge)
{
    return front->near ? &gd__near_side(front->near, 2 * edge)->newest[edge % (GD__PAGE_SIDES / 2)]
                       : &front->newest[edge];
}

static inline uint32_t *gd__wavefront_waiting(const struct gd__wavefront *front, uint32_t vertex)
{
    return front->near ? &gd__near_vertex(front->near, vertex)->waiting[vertex % GD__PAGE_VERTICES]
                       : &front->waiting[vertex];
}

static inline double *gd__wavefront_emitted(const struct gd__wavefront *front, uint32_t vertex)
{
    return front->near ? &gd__near_vertex(front->near, vertex)->emitted[vertex % GD__PAGE_VERTICES]
                       : &front->emitted[vertex];
}

static inline struct gd__predecessor *gd__wavefront_predecessor(const struct gd__wavefront *front,
                                                                uint32_t vertex)
{
    return front->near
               ? &gd__near_vertex(front->near, vertex)->predecessor[vertex % GD__PAGE_VERTICES]
               : &front->predecessor[vertex];
}

/* Where the chunks of the vertex's present distance begin: 0 where that is not known any more. */
static inline uint32_t gd__wavefront_since(const struct gd__wavefront *front, uint32_t vertex)
{
    if (!front->near) return front->work->since[vertex];
    const struct gd__vertex_page *page = gd__near_vertex(front->near, vertex);
    return page ? page->since[vertex % GD__PAGE_VERTICES] : 0;
}

/* Distance of the pseudo-source of a window that was a wedge: a linear one has kept its own. */
static inline double gd__wavefront_sigma(const struct gd__wavefront *front,
                                         const struct gd__window *w)
{
    uint32_t vertices = front->mesh->vertex_count;
    if (gd__window_is_linear(w)) return w->sigma;
    return w->source < vertices ? front->distance[w->source]
                                : front->seeds[w->source - vertices].offset;
}

/* Offers a vertex a distance; takes it if strictly shorter, and queues the vertex if paths may bend
 * there. */
void gd__wavefront_reach(struct gd__wavefront *front, uint32_t vertex, double distance,
                         struct gd__predecessor predecessor);

/* A side as those know it who offer it windows: no need to look it up. */
struct gd__receiver {
    uint32_t side;
    double length;
    double d0, d1; /* distances of its ends */
    double l0, l1; /* lower bounds of the ways from them to the target; 0 without a guide */
    /* struct gd__wavefront's, when the offsets of what is offered were the sources' distances */
    uint32_t falls;
};

static inline struct gd__receiver gd__wavefront_receiver(const struct gd__wavefront *front,
                                                         uint32_t side)
{
    uint32_t origin = front->mesh->origin[side], destination = front->mesh->origin[side ^ 1];
    return (struct gd__receiver){side,
                                 front->mesh->side[side].length,
                                 front->distance[origin],
                                 front->distance[destination],
                                 gd__wavefront_rest(front, origin),
                                 gd__wavefront_rest(front, destination),
                                 front->falls};
}

/* Offers a side new windows (used up: their order stays, their ends may be cut), and queues the
 * side. */
void gd__wavefront_deliver(struct gd__wavefront *front, const struct gd__receiver *to,
                           struct gd__children *windows);

/* Before the list of a side takes so many windows in. */
static inline void gd__wavefront_note_windows(struct gd__wavefront *front, struct gd__list *list,
                                              uint32_t side, uint32_t count)
{
    front->effort.windows_created += count;
    gd__workspace_touch(front->work, side, !list->touched);
    list->touched = true;
}

/* gd__wavefront_offer where windows wait already, or not all are wanted. */
void gd__wavefront_offer_with_care(struct gd__wavefront *front, uint32_t side,
                                   const struct gd__window *window);

/* Offers a side one window. Where all is taken the side is queued by the distance in the window's
 * middle: as good an order as that by the distances of the side's ends, which nobody has to look up
 * then. */
static inline void gd__wavefront_offer(struct gd__wavefront *front, uint32_t side,
                                       const struct gd__window *window)
{
    if (!front->takes_all || front->lists[side].count) {
        gd__wavefront_offer_with_care(front, side, window);
        return;
    }
    struct gd__list *list = &front->lists[side];
    gd__wavefront_note_windows(front, list, side, 1);
    list->falls = front->falls;
    enum gd_status status = gd__list_begin(list, &front->work->pool, window);
    if (!front->status) front->status = status;
    if (!status)
        gd__queue_push(front->queue, side, gd__window_distance_in_middle(window), &list->bucket);
}

/* seeds.c, emit.c: windows and neighbour distances of the seeds, and of a saddle or boundary vertex
 * into its shadow cone. */
void gd__emit_seeds(struct gd__wavefront *front);
void gd__emit_vertex(struct gd__wavefront *front, uint32_t vertex);

/* emit.c: a seed beside a vertex emits into the faces of the vertex that it doesn't lie in: what it
 * sees past the vertex on both sides, bounded by rays of the vertex (doc 002). */
void gd__emit_beside(struct gd__wavefront *front, uint32_t seed, const struct gd__polar *polar);

/* propagate.c: stores a window of a side, which is not propagated, as a wedge. */
void gd__store_window(struct gd__wavefront *front, uint32_t side, const struct gd__window *window);

/* propagate.c: the windows that wait on a side become wedges and go on across its face. */
void gd__propagate_side(struct gd__wavefront *front, uint32_t side);

/* propagate.c: casts windows of a side with a face across it: offers its apex distances, and the
 * two other sides windows. */
void gd__cast(struct gd__wavefront *front, const struct gd__receiver *at,
              const struct gd__windows *windows, uint32_t count);

/* resume.c: takes up what has begun; then all that a farther bound wants is on its way. The
 * wavefront is open and fresh. */
void gd__resume(struct gd__wavefront *front, const struct gd__begun *begun);

/* resume.c: drops windows that are offered to a side and were surely within the inner bound
 * already. */
void gd__keep_beyond(const struct gd__wavefront *front, uint32_t side,
                     struct gd__children *windows);

/* prune.c: the wedges of a chunk that came from windows of `side` (`own`) or of the edge's other
 * side, as windows in the side's frame, sorted, appended to `out`, which has room. Those of sources
 * that came nearer since are passed over. */
void gd__stored_windows(const struct gd__wavefront *front, const struct gd__chunk *chunk,
                        uint32_t side, bool own, struct gd__stack *out);

/* prune.c: cuts off windows of a side what its stored wedges (`own`: ties too) or those of the
 * edge's other side (`twin`: only where they are strictly better) make useless. *count: how many
 * windows there are, then how many are left; *windows may move to scratch. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__prune_by_stored(struct gd__wavefront *front, uint32_t side, bool own,
                                               bool twin, struct gd__windows *windows,
                                               uint32_t *count);

#endif
