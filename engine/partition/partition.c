#include "partition/partition.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

#include "partition/bisection.h"

#define FACES_LEAST  20000 /* a smaller surface is done before the turns pay */
#define TURN_BUCKETS 32    /* that one part may be ahead: more of them do more work twice */
/* sides and vertices of a turn, the same for both parts; a tenth of a millisecond */
#define TURN_WORK      512
#define COPY_BYTES     16384 /* at a time; chunks' heads are not divided by it */
#define BUDGET_AN_EDGE 1000  /* bytes: with less there may be no room for two of all */

/* --- mail ------------------------------------------------------------------------------------- */

/* What waits of a source whose distance fell is on its way again: gd__propagate_side would drop it,
 * and so would who sent it. */
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
    uint32_t origin = front->mesh->origin[side], destination = front->mesh->origin[side ^ 1];
    struct gd__receiver to = {side,
                              front->mesh->side[side].length,
                              front->distance[origin],
                              front->distance[destination],
                              0,
                              0,
                              front->falls};
    gd__wavefront_deliver(front, &to, children);
}

/* Vertices first: the windows' sources are among them. */
static void receive(struct gd__wavefront *front, struct gd__mail *mail)
{
    for (uint32_t i = 0; i < mail->vertex_count; i++)
        gd__wavefront_learn(front, &mail->vertices[i]);
    const struct gd__window *windows = mail->windows.windows;
    for (uint32_t i = 0; i < mail->list_count && !front->status; i++) {
        receive_list(front, mail->lists[i].side, windows, mail->lists[i].count);
        windows += mail->lists[i].count;
    }
    mail->vertex_count = mail->list_count = mail->windows.count = 0;
}

/* --- one result ------------------------------------------------------------------------------- */

/* Copies the other's chunks behind the own ones; those of one edge still point to each other. A
 * block at a time, which stays in the cache. */
static void append_chunks(struct gd__region *own, const struct gd__region *from, uint32_t shift)
{
    char *to = own->base + own->used;
    for (size_t begin = 0, at = 0, end; begin < from->used; begin = end) {
        end = begin + COPY_BYTES < from->used ? begin + COPY_BYTES : from->used;
        memcpy(to + begin, from->base + begin, end - begin);
        while (at < end) {
            struct gd__chunk *chunk = (struct gd__chunk *)(to + at);
            if (chunk->previous != GD_NONE) chunk->previous += shift;
            at += sizeof *chunk + (size_t)chunk->count * GD__WEDGE_BYTES;
        }
    }
    own->used += from->used;
}

/* Puts an edge's chain of the other's before its own, if it has one too: it lies on the cut. All of
 * the own chunks come before all of the other's, as chains want it (wedges.h). */
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

/* From here on all of the budget is the first one's, but for what the second one still has. */
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
    front->effort.windows_created += other->effort.windows_created;
    front->effort.windows_propagated += other->effort.windows_propagated;
    front->effort.sides_propagated += other->effort.sides_propagated;
    front->effort.vertices_emitted += other->effort.vertices_emitted;
    front->effort.wedges_compared += other->effort.wedges_compared;
    front->wedge_count += other->wedge_count;
    front->bound = fmin(front->bound, other->bound);
    return take_wedges(front, other);
}

/* --- turns ------------------------------------------------------------------------------------ */

/* What one thread writes all the time shares no cache line, nor a pair of them, with what the other
 * one reads. */
struct part {
    alignas(128) struct gd__wavefront front;
    struct gd__partition partition;
    struct gd__mail inbox; /* from the other part */
};

struct pair {
    struct part part[2];
    uint32_t end; /* bucket before which a turn ends */
};

static void take_turn(void *context, uint32_t index)
{
    struct pair *pair = context;
    struct part *part = &pair->part[index];
    receive(&part->front, &part->inbox);
    gd__wavefront_advance(&part->front, pair->end, TURN_WORK);
}

static void deliver(struct pair *pair)
{
    for (int i = 0; i < 2; i++) {
        struct gd__mail read = pair->part[i].inbox;
        pair->part[i].inbox = pair->part[1 - i].partition.mail;
        pair->part[1 - i].partition.mail = read;
    }
}

static bool is_idle(const struct part *part)
{
    return !part->inbox.vertex_count && !part->inbox.list_count &&
           gd__queue_first(part->front.queue) == GD_NONE;
}

/* Mail that is not read yet may bring something nearer than what waits: it only makes the turn go a
 * little farther. Where nothing waits but mail, TURN_WORK alone ends the turn. */
static uint32_t find_end(const struct pair *pair)
{
    uint32_t a = gd__queue_first(pair->part[0].front.queue),
             b = gd__queue_first(pair->part[1].front.queue);
    uint32_t first = a < b ? a : b;
    return first == GD_NONE ? GD_NONE : first + TURN_BUCKETS;
}

static double progress(const struct pair *pair)
{
    return (double)(pair->part[0].front.sides_visited + pair->part[1].front.sides_visited) /
           (2 * (double)pair->part[0].front.mesh->edge_count);
}

/* An entry that the queue lost for want of memory is known only there. */
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
    deliver(pair);
    enum gd_status status = status_of(pair);
    while (!status && !(is_idle(&pair->part[0]) && is_idle(&pair->part[1]))) {
        pair->end = find_end(pair);
        gd_executor_run(executor, take_turn, pair, 2);
        deliver(pair);
        status = status_of(pair);
        if (!status) status = gd_control_check(monitor, progress(pair));
    }
    return status;
}

/* Each wavefront gets half of the budget and none of the reports. */
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
        gd__mail_destroy(&pair.part[i].partition.mail);
        gd__mail_destroy(&pair.part[i].inbox);
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

enum gd_status gd__partition_propagate(struct gd__wavefront *front,
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
