#include "partition/partition.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

#include "partition/bisection.h"

#define FACES_LEAST 20000 /* on a smaller surface two wavefronts are not faster than one */
/* largest lead of one part over the other, in buckets; a larger lead causes more repeated work */
#define TURN_BUCKETS 32
/* Sides and vertices per turn, for either part: a tenth of a millisecond. */
#define TURN_WORK 512
/* bytes copied at a time; heads of chunks need not be aligned to this size */
#define COPY_BYTES 16384
/* Least budget for two wavefronts, in bytes for each edge. A smaller budget may not allow two sets
 * of arrays. */
#define BUDGET_AN_EDGE 1000

/* --- outbox ----------------------------------------------------------------------------------- */

/* Drops windows whose source's distance decreased after they were sent, because the source casts
 * them again. */
static uint32_t put_fresh(const struct gd__wavefront *front, const struct gd__window *windows,
                          uint32_t count)
{
    uint32_t fresh = 0;
    for (uint32_t i = 0; i < count; i++)
        if (windows[i].source >= front->mesh->vertex_count ||
            windows[i].sigma == front->distance[windows[i].source])
            gd__windows_put(&front->work->left.at, fresh++, &windows[i]);
    return fresh;
}

static void receive_list(struct gd__wavefront *front, uint32_t side,
                         const struct gd__window *windows, uint32_t count)
{
    struct gd__children *children = &front->work->left;
    front->status = gd__children_open(children, &front->work->pool, count);
    if (front->status) return;
    children->count = put_fresh(front, windows, count);
    struct gd__receiver to = gd__wavefront_receiver(front, side);
    gd__wavefront_deliver(front, &to, children);
}

/* Receives messages, vertices first, because they include sources of the windows. */
static void receive_messages(struct gd__wavefront *front, struct gd__outbox *outbox)
{
    for (uint32_t i = 0; i < outbox->vertex_count; i++)
        gd__wavefront_learn(front, &outbox->vertices[i]);
    const struct gd__window *windows = outbox->windows.windows;
    for (uint32_t i = 0; i < outbox->list_count && !front->status; i++) {
        receive_list(front, outbox->lists[i].side, windows, outbox->lists[i].count);
        windows += outbox->lists[i].count;
    }
    outbox->vertex_count = outbox->list_count = outbox->windows.count = 0;
}

/* --- merged result ---------------------------------------------------------------------------- */

/* Appends the chunks of the other wavefront behind the own chunks. Chunks of one edge keep their
 * links. Copies block by block, so that a block stays in the cache. */
static void append_chunks(struct gd__region *own, const struct gd__region *from, uint32_t shift)
{
    char *to = own->base + own->used;
    for (size_t begin = 0, at = 0, end; begin < from->used; begin = end) {
        end = begin + COPY_BYTES < from->used ? begin + COPY_BYTES : from->used;
        memcpy(to + begin, from->base + begin, end - begin);
        while (at < end) {
            struct gd__chunk *chunk = (struct gd__chunk *)(to + at);
            if (chunk->previous != GD_NONE) chunk->previous += shift;
            at += gd__chunk_bytes(chunk);
        }
    }
    own->used += from->used;
}

/* Links the other wavefront's chain of an edge before the own chain, if both exist: the edge then
 * lies on the cut. All own chunks precede the other's chunks in memory, as chains require
 * (wedges.h). */
static void join_chains(struct gd__wavefront *front, uint32_t edge, uint32_t newest)
{
    uint32_t *own = &front->newest[edge];
    if (*own == GD_NONE) {
        gd__workspace_touch(front->work, 2 * edge, true);
    } else {
        uint32_t at = newest;
        struct gd__chunk *chunk;
        do {
            chunk = (struct gd__chunk *)(front->work->wedges.base + (size_t)at * GD__CHUNK_UNIT);
            at = chunk->previous;
        } while (at != GD_NONE);
        chunk->previous = *own;
    }
    *own = newest;
}

/* Moves the wedges of the other wavefront to the first one. Afterwards the first wavefront has the
 * whole budget, less what the second one still holds. */
static enum gd_status take_wedges(struct gd__wavefront *front, const struct gd__wavefront *other)
{
    struct gd__region *own = &front->work->wedges;
    const struct gd__region *from = &other->work->wedges;
    front->work->budget.control = front->monitor;
    front->work->budget.held += other->work->budget.held;
    enum gd_status status = gd__region_reserve(own, from->used);
    if (status) return status;
    uint32_t shift = (uint32_t)(own->used / GD__CHUNK_UNIT);
    append_chunks(own, from, shift);
    for (uint32_t edge = 0; edge < front->mesh->edge_count; edge++)
        if (other->newest[edge] != GD_NONE) join_chains(front, edge, other->newest[edge] + shift);
    return GD_OK;
}

static void take_vertices(struct gd__wavefront *front, const struct gd__wavefront *other)
{
    for (uint32_t v = 0; v < front->mesh->vertex_count; v++) {
        if (other->distance[v] >= front->distance[v]) continue;
        if (front->distance[v] >= GD__FAR)
            gd__workspace_touch(front->work, 2 * front->work->edges + v, true);
        front->distance[v] = other->distance[v];
        front->predecessor[v] = other->predecessor[v];
    }
}

static enum gd_status take_all(struct gd__wavefront *front, const struct gd__wavefront *other)
{
    take_vertices(front, other);
    front->counts.windows_created += other->counts.windows_created;
    front->counts.windows_propagated += other->counts.windows_propagated;
    front->counts.sides_propagated += other->counts.sides_propagated;
    front->counts.vertices_emitted += other->counts.vertices_emitted;
    front->counts.wedges_compared += other->counts.wedges_compared;
    front->wedge_count += other->wedge_count;
    front->bound = fmin(front->bound, other->bound);
    return take_wedges(front, other);
}

/* --- turns ------------------------------------------------------------------------------------ */

/* One of the two wavefronts. Data that one thread writes shares neither a cache line nor a pair of
 * adjacent lines with data that the other thread reads. */
struct part {
    alignas(128) struct gd__wavefront front;
    struct gd__partition partition;
    struct gd__outbox inbox; /* messages from the other part */
};

struct pair {
    struct part part[2];
    uint32_t end; /* bucket before which the turn ends */
};

static void take_turn(void *context, uint32_t index)
{
    struct pair *pair = context;
    struct part *part = &pair->part[index];
    receive_messages(&part->front, &part->inbox);
    gd__wavefront_advance(&part->front, pair->end, TURN_WORK);
}

static void exchange_mail(struct pair *pair)
{
    for (int i = 0; i < 2; i++) {
        struct gd__outbox read = pair->part[i].inbox;
        pair->part[i].inbox = pair->part[1 - i].partition.outbox;
        pair->part[1 - i].partition.outbox = read;
    }
}

static bool is_idle(const struct part *part)
{
    return !part->inbox.vertex_count && !part->inbox.list_count &&
           gd__queue_first(part->front.queue) == GD_NONE;
}

/* Returns the bucket before which the turn ends. Unread messages may be nearer than the waiting
 * nodes, which only extends the turn a little. If only messages wait, TURN_WORK alone ends the
 * turn. */
static uint32_t find_end(const struct pair *pair)
{
    uint32_t a = gd__queue_first(pair->part[0].front.queue),
             b = gd__queue_first(pair->part[1].front.queue);
    uint32_t first = a < b ? a : b;
    return first == GD_NONE ? GD_NONE : first + TURN_BUCKETS;
}

static double pair_progress(const struct pair *pair)
{
    return (double)(pair->part[0].front.sides_visited + pair->part[1].front.sides_visited) /
           (2 * (double)pair->part[0].front.mesh->edge_count);
}

/* Returns the status of both wavefronts. The queue itself records an entry that was lost for lack
 * of memory. */
static enum gd_status status_of(const struct pair *pair)
{
    for (int i = 0; i < 2; i++) {
        const struct gd__wavefront *front = &pair->part[i].front;
        if (front->status) return front->status;
        if (front->queue->out_of_memory) return GD_NO_MEMORY;
    }
    return GD_OK;
}

static enum gd_status propagate(struct pair *pair, const struct gd_control *monitor,
                                const struct gd_executor *executor)
{
    for (int i = 0; i < 2; i++) gd__emit_seeds(&pair->part[i].front);
    exchange_mail(pair);
    enum gd_status status = status_of(pair);
    while (!status && !(is_idle(&pair->part[0]) && is_idle(&pair->part[1]))) {
        pair->end = find_end(pair);
        gd_executor_run(executor, take_turn, pair, 2);
        exchange_mail(pair);
        status = status_of(pair);
        if (!status) status = gd_control_check(monitor, pair_progress(pair));
    }
    return status;
}

/* Returns the control of one wavefront, with half of the budget and without progress. */
static struct gd_control share_of(const struct gd_control *monitor, struct gd_workspace *work)
{
    struct gd_control share = monitor ? *monitor : (struct gd_control){0};
    share.budget_bytes /= 2;
    share.progress = NULL;
    share.workspace = work;
    return share;
}

static enum gd_status open_pair(struct pair *pair, const struct gd__propagation *propagation,
                                const struct gd_control share[2])
{
    enum gd_status status = GD_OK;
    for (int i = 0; i < 2 && !status; i++) {
        struct part *part = &pair->part[i];
        part->front.monitor = &share[i];
        part->front.work = share[i].workspace;
        part->front.partition = &part->partition;
        status = gd__wavefront_open(&part->front, propagation);
    }
    return status;
}

static enum gd_status propagate_pair(struct gd__wavefront *front,
                                     const struct gd__propagation *propagation,
                                     const uint8_t *side_part, const uint8_t *vertex_parts,
                                     const struct gd_executor *executor)
{
    struct gd_workspace *partner = gd__workspace_partner(front->work);
    if (!partner) return GD_NO_MEMORY;
    struct gd_control share[2] = {share_of(front->monitor, front->work),
                                  share_of(front->monitor, partner)};
    struct gd__partition partition = {.side_part = side_part,
                                      .vertex_parts = vertex_parts,
                                      .part = 0},
                         second = partition;
    second.part = 1;
    struct pair pair = {.part = {{.front = *front, .partition = partition},
                                 {.front = *front, .partition = second}}};
    enum gd_status status = open_pair(&pair, propagation, share);
    if (!status) status = propagate(&pair, front->monitor, executor);
    struct part *first = &pair.part[0];
    first->front.monitor = front->monitor;
    if (!status) status = take_all(&first->front, &pair.part[1].front);
    for (int i = 0; i < 2; i++) {
        gd__outbox_destroy(&pair.part[i].partition.outbox);
        gd__outbox_destroy(&pair.part[i].inbox);
    }
    gd__workspace_clean(partner);
    first->front.partition = NULL;
    *front = first->front;
    return status;
}

bool gd__partition_is_worth_it(const struct gd_mesh *mesh,
                               const struct gd__propagation *propagation,
                               const struct gd_control *monitor)
{
    return mesh->face_count >= FACES_LEAST && propagation->seed_count == 1 &&
           !propagation->seeds[0].is_segment && !propagation->target && !propagation->guide &&
           !propagation->without_wedges && propagation->radius >= GD__FAR &&
           (!monitor || !monitor->budget_bytes ||
            monitor->budget_bytes > BUDGET_AN_EDGE * (size_t)mesh->edge_count);
}

/* Propagates by two wavefronts. `front` must not be open. After the call it is in the same state as
 * after propagating alone. If the status is GD_BUDGET, a propagation by one wavefront may still
 * succeed. */
static enum gd_status propagate_in_parts(struct gd__wavefront *front,
                                         const struct gd__propagation *propagation,
                                         const struct gd_executor *executor)
{
    const struct gd_mesh *mesh = front->mesh;
    uint8_t *side_part = malloc(2 * (size_t)mesh->edge_count),
            *vertex_parts = malloc(mesh->vertex_count);
    enum gd_status status = side_part && vertex_parts ? GD_OK : GD_NO_MEMORY;
    if (!status) {
        gd__bisection_divide(mesh, gd__anchor(mesh, &propagation->seeds[0].point).position,
                             side_part, vertex_parts);
        status = propagate_pair(front, propagation, side_part, vertex_parts, executor);
    }
    free(side_part);
    free(vertex_parts);
    return status;
}

/* --- one or two wavefronts -------------------------------------------------------------------- */

static enum gd_status propagate_alone(struct gd__wavefront *front,
                                      const struct gd__propagation *propagation)
{
    enum gd_status status = gd__wavefront_open(front, propagation);
    if (status) return status;
    if (propagation->partial)
        gd__resume(front, propagation->partial);
    else
        gd__emit_seeds(front);
    gd__wavefront_advance(front, GD_NONE, UINT64_MAX);
    return front->status;
}

/* Propagates by two wavefronts, or by one if the memory does not suffice for two. */
static enum gd_status propagate_together(struct gd__wavefront *front,
                                         const struct gd__propagation *propagation,
                                         const struct gd_executor *executor)
{
    struct gd__wavefront fresh = *front;
    enum gd_status status = propagate_in_parts(front, propagation, executor);
    if (status != GD_BUDGET) return status;
    gd__workspace_clean(front->work);
    *front = fresh;
    return propagate_alone(front, propagation);
}

static enum gd_status run_in(struct gd_workspace *work, const struct gd_mesh *mesh,
                             const struct gd__propagation *propagation, const struct gd__sink *sink,
                             const struct gd_control *monitor, const struct gd_executor *executor)
{
    struct gd__wavefront front = {.mesh = mesh,
                                  .work = work,
                                  .seeds = propagation->seeds,
                                  .seed_count = propagation->seed_count,
                                  .variant = propagation->variant,
                                  .guide = propagation->guide,
                                  .monitor = monitor};
    bool together = executor && executor->width > 1 && !propagation->partial &&
                    gd__partition_is_worth_it(mesh, propagation, monitor);
    enum gd_status status = together ? propagate_together(&front, propagation, executor)
                                     : propagate_alone(&front, propagation);
    if (!status) status = sink->take(sink->user, &front);
    return status;
}

enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                 const struct gd__propagation *propagation,
                                 const struct gd__sink *sink, const struct gd_control *monitor,
                                 const struct gd_executor *executor)
{
    struct gd_workspace own = {0},
                        *work = monitor && monitor->workspace ? monitor->workspace : &own;
    enum gd_status status = run_in(work, mesh, propagation, sink, monitor, executor);
    if (work == &own)
        gd_workspace_trim(work);
    else
        gd__workspace_clean(work);
    return status;
}
