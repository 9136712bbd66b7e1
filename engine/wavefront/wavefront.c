#include "wavefront/wavefront.h"

#include <stdlib.h>
#include <string.h>

#include "base/prefetch.h"

/* Width of a bucket relative to the grain (mean of the shortest edges of faces, mesh/topology.h).
 * With narrower buckets, there are more rounds. With wider buckets, the windows of a side are
 * propagated in several parts, which takes quadratic time on needle-shaped faces. */
#define BUCKET_WIDTH 0.3
/* The key of a side is an interpolation between the distances of its nearer end (weight 0) and its
 * farther end (weight 1). */
#define KEY_WEIGHT 0.25
/* Windows propagated between two checks of the monitor. Each side or vertex counts as ITEM_WINDOWS
 * windows. The interval is well under a millisecond. */
#define CHECK_WINDOWS 4096
#define ITEM_WINDOWS  16
/* records are prefetched this number of queue entries ahead (prefetch_records) */
#define RECORDS_AHEAD 9
#define NAMED_AHEAD   5
#define WORK_AHEAD    2
/* Number of sides of a mesh that nearly fits into a second-level cache. On such a mesh, prefetching
 * more than the records costs 3 %. */
#define SIDES_IN_CACHE 20000
#define WORK_LEAST     (UINT64_C(1) << 25) /* number of windows: about a second of work */
#define WORK_FACTOR    64

/* --- distances, windows, order ---------------------------------------------------------------- */

static void shrink_bound(struct gd__wavefront *front, uint32_t vertex)
{
    if (front->guide) {
        double through =
            (front->distance[vertex] + front->guide->node[vertex].upper) * (1 + GD_TOL_BOUND);
        if (through < front->bound) front->bound = through;
        return;
    }
    for (int i = 0; i < 4; i++) {
        if (front->target_corner[i] != vertex) continue;
        double through = (front->distance[vertex] + front->target_leg[i]) * (1 + GD_TOL_CHECK);
        if (through < front->bound) front->bound = through;
    }
}

/* Stores the offset at which chunks with the vertex' new distance begin. The page of such a vertex
 * must not be reused. */
static void note_fall(struct gd__wavefront *front, uint32_t vertex)
{
    uint32_t valid_from = (uint32_t)(front->work->wedges.used / GD__CHUNK_UNIT);
    if (!front->paged) {
        front->work->valid_from[vertex] = valid_from;
    } else if (valid_from) {
        struct gd__vertex_page *page = gd__paged_vertex(front->paged, vertex);
        page->valid_from[vertex % GD__PAGE_VERTICES] = valid_from;
        page->page.stays = true;
    }
}

static void wait_at(struct gd__wavefront *front, uint32_t vertex, double distance)
{
    uint32_t *waiting = gd__wavefront_waiting(front, vertex), before = *waiting;
    gd__queue_push(front->queue, 2 * front->mesh->edge_count + vertex, distance, waiting);
    if (front->paged && before == GD_NONE) gd__paged_vertex(front->paged, vertex)->page.waiting++;
}

/* Sets a shorter distance. Counts the decrease in `distance_drops` if windows of the vertex are
 * already queued or stored, see prune.c. */
static void set_distance(struct gd__wavefront *front, uint32_t vertex, double distance,
                         const struct gd__predecessor *predecessor)
{
    if (!front->paged && front->distance[vertex] >= GD__FAR)
        gd__workspace_touch(front->work, 2 * front->work->edges + vertex, true);
    if (*gd__wavefront_emitted(front, vertex) < GD__FAR) {
        note_fall(front, vertex);
        front->distance_drops++;
    }
    front->distance[vertex] = distance;
    *gd__wavefront_predecessor(front, vertex) = *predecessor;
    shrink_bound(front, vertex);
    if (front->mesh->vertex_kind[vertex] != GD_VERTEX_CONVEX &&
        distance + gd__wavefront_rest(front, vertex) <= front->bound)
        wait_at(front, vertex, distance);
}

void gd__wavefront_reach(struct gd__wavefront *front, uint32_t vertex, double distance,
                         struct gd__predecessor predecessor)
{
    if (distance >= front->distance[vertex] * (1 - GD_TOL_BETTER)) return;
    if (front->paged && !front->status)
        front->status =
            gd__paged_need_vertex(front->paged, front->mesh, vertex, front->queue->current);
    if (!front->status) set_distance(front, vertex, distance, &predecessor);
}

/* Returns the key of a side and its list. If one end has no distance yet, its distance counts as
 * one edge length more than that of the other end. If both ends have no distance yet, as in front
 * of a narrow cone of windows, the key is the smallest distance of the waiting windows. Branchless,
 * because a branch would be mispredicted half of the time. */
static double key_of(const struct gd__receiver *to, const struct gd__list *list)
{
    double near = to->d0 < to->d1 ? to->d0 : to->d1, apart = fabs(to->d0 - to->d1),
           key = near + KEY_WEIGHT * (apart < to->length ? apart : to->length);
    if (key < GD__FAR) return key;
    struct gd__windows windows = gd__list_windows(list);
    struct gd__window w = gd__windows_get(&windows, 0);
    return gd__window_nearest(&w);
}

/* Returns the list of a side that will receive windows. NULL means that the error is in
 * front->status. */
static inline struct gd__list *open_list(struct gd__wavefront *front, uint32_t side)
{
    if (!front->paged) return &front->lists[side];
    front->status = gd__paged_need_side(front->paged, side, front->queue->current);
    if (front->status) return NULL;
    struct gd__list *list = gd__wavefront_list(front, side);
    if (!list->count) gd__paged_side(front->paged, side)->page.waiting++;
    return list;
}

/* Keeps the windows that are within the bound. Returns false if there are none. */
static inline bool keep_wanted(struct gd__wavefront *front, const struct gd__receiver *to,
                               struct gd__children *children)
{
    if (front->guide)
        children->count = front->kernel->filter(&children->at, children->count, to->length,
                                                front->bound - to->l0, front->bound - to->l1);
    else if (front->bound < GD__FAR)
        children->count = front->kernel->within(&children->at, children->count, front->bound);
    return children->count && !front->status;
}

/* Prefetches the records of a side that enters the queue. In a search with a guide, few sides wait,
 * so prefetching from the queue often begins too late. */
GD__PREFETCH prefetch_queued(const struct gd__wavefront *front, uint32_t side)
{
    __builtin_prefetch(&front->mesh->side[side]);
    __builtin_prefetch(&front->mesh->origin[side]);
    __builtin_prefetch(&front->newest[side >> 1]);
}

void gd__wavefront_deliver(struct gd__wavefront *front, const struct gd__receiver *to,
                           struct gd__children *children)
{
    if (!keep_wanted(front, to, children)) {
        gd__children_close(children, &front->work->pool);
        return;
    }
    struct gd__list *list = open_list(front, to->side);
    if (!list) return; /* the block of `children` is freed with the pool */
    gd__wavefront_note_windows(front, list, to->side, children->count);
    if (!list->count || to->distance_drops < list->distance_drops)
        list->distance_drops = to->distance_drops;
    front->status = gd__list_insert(list, &front->work->pool, children,
                                    front->narrowest * to->length, &front->work->scratch);
    if (front->status) return;
    if (front->guide) prefetch_queued(front, to->side);
    gd__queue_push(front->queue, to->side, key_of(to, list), &list->bucket);
}

static void deliver_one(struct gd__wavefront *front, uint32_t side, double length,
                        const struct gd__window *window)
{
    struct gd__children *one = &front->work->left;
    struct gd__receiver to = gd__wavefront_receiver(front, side, length);
    front->status = gd__children_open(one, &front->work->pool, 1);
    if (front->status) return;
    gd__windows_put(&one->at, 0, window);
    one->count = 1;
    gd__wavefront_deliver(front, &to, one);
}

void gd__wavefront_offer_with_care(struct gd__wavefront *front, uint32_t side, double length,
                                   const struct gd__window *window)
{
    if (front->status) return;
    if (!front->takes_all) {
        deliver_one(front, side, length, window);
        return;
    }
    struct gd__list *list = &front->lists[side];
    /* the list keeps the distance_drops of its oldest window */
    gd__wavefront_note_windows(front, list, side, 1);
    front->status = gd__list_add_one(list, &front->work->pool, window, front->narrowest * length,
                                     &front->work->scratch);
    if (!front->status)
        gd__queue_push(front->queue, side, gd__window_distance_in_middle(window), &list->bucket);
}

/* --- opening ---------------------------------------------------------------------------------- */

/* Stores the corners of the target's faces and their straight distances from the target. With them,
 * the distances of the corners give an upper bound of the target's distance at any time. */
static void set_target(struct gd__wavefront *front, const struct gd_point *target)
{
    struct gd__anchor anchor = {.corner = {GD_NONE, GD_NONE, GD_NONE, GD_NONE}};
    if (target) anchor = gd__anchor(front->mesh, target);
    for (int i = 0; i < 4; i++) {
        front->target_corner[i] = anchor.corner[i];
        front->target_leg[i] = anchor.leg[i];
    }
}

static void store_face(struct gd__wavefront *front, uint32_t face)
{
    for (int k = 0; k < 3 && face != GD_NONE; k++) {
        uint32_t side = front->mesh->face_side[face][k];
        struct gd__list *list = &front->lists[side];
        gd__workspace_touch(front->work, side, !list->touched);
        list->touched = true;
        list->stores = true;
    }
}

/* Marks the sides of the point's faces: the point's distance is computed from their wedges. The
 * distance of a vertex is known without wedges. */
static void store_point(struct gd__wavefront *front, const struct gd_point *point)
{
    if (point->kind == GD_POINT_FACE) store_face(front, point->element);
    for (int k = 0; k < 2 && point->kind == GD_POINT_EDGE; k++)
        store_face(front, front->mesh->side_face[2 * point->element + k]);
}

/* Returns the width of a bucket. It is computed for the smallest component that has a seed. With
 * the width for a large component, all nodes of a component that is a million times smaller would
 * be in one bucket. */
static double bucket_width(const struct gd__wavefront *front)
{
    double least = GD__FAR;
    const struct gd_mesh *mesh = front->mesh;
    if (mesh->summary.components == 1) return BUCKET_WIDTH * mesh->component[0].grain;
    for (uint32_t i = 0; i < front->seed_count; i++) {
        double grain = mesh->component[gd_point_component(mesh, &front->seeds[i].point)].grain;
        if (grain < least) least = grain;
    }
    return BUCKET_WIDTH * least;
}

/* Returns a limit on the number of windows, far above that of any real mesh. Meshes of smooth
 * surfaces with n faces have about n^1.5 windows. */
static uint64_t work_limit(const struct gd_mesh *mesh)
{
    double sides = 2 * (double)mesh->edge_count;
    return WORK_LEAST + (uint64_t)(WORK_FACTOR * sides * sqrt(sides));
}

static bool has_segments(const struct gd__wavefront *front)
{
    for (uint32_t i = 0; i < front->seed_count; i++)
        if (front->seeds[i].is_segment) return true;
    return false;
}

static enum gd_status wavefront_open(struct gd__wavefront *front,
                                     const struct gd__propagation *propagation)
{
    struct gd_workspace *work = front->work;
    enum gd_status status =
        propagation->without_wedges
            ? gd__workspace_open_paged(work, front->mesh, bucket_width(front), front->monitor)
            : gd__workspace_open(work, front->mesh, bucket_width(front), front->monitor);
    front->paged = propagation->without_wedges ? &work->paged : NULL;
    front->lists = work->lists;
    front->distance = front->paged ? work->paged.distance : work->distance;
    front->emitted = work->emitted;
    front->waiting = work->waiting;
    front->newest = work->newest;
    front->predecessor = work->predecessor;
    front->queue = work->queue;
    front->wedge_form = gd__wedge_form_of((uint64_t)front->mesh->vertex_count + front->seed_count);
    front->kernel = gd__kernel_in_use();
    if (has_segments(front)) front->kernel = front->kernel->linear;
    front->work->scratch.apart = front->variant.no_coalescing;
    front->work_limit = propagation->work_limit ? propagation->work_limit : work_limit(front->mesh);
    front->narrowest = front->seed_count > 1 ? GD_TOL_NARROW : GD_TOL_WIDTH;
    front->bound = propagation->radius;
    front->takes_all =
        !front->guide && !front->paged && !propagation->target && propagation->radius >= GD__FAR;
    front->stores_all = !front->paged && !propagation->points;
    set_target(front, propagation->target);
    for (uint32_t i = 0; i < propagation->point_count && !front->paged && !status; i++)
        store_point(front, &propagation->points[i]);
    return status;
}

/* --- the loop --------------------------------------------------------------------------------- */

/* Called after a record of a page was processed. If no other record waits, the page is idle. */
static void leave_page(const struct gd__wavefront *front, struct gd__pages *pages,
                       struct gd__page *page)
{
    if (--page->waiting == 0) gd__pages_rest(pages, page, front->queue->current);
}

static void work_on_side(struct gd__wavefront *front, uint32_t side)
{
    if (front->paged && !gd__paged_side(front->paged, side)) return;
    struct gd__list *list = gd__wavefront_list(front, side);
    if (list->bucket != front->queue->current) return;
    list->bucket = GD_NONE;
    gd__propagate_side(front, side);
    if (front->paged)
        leave_page(front, &front->paged->sides, &gd__paged_side(front->paged, side)->page);
}

static void work_on_vertex(struct gd__wavefront *front, uint32_t vertex)
{
    if (front->paged && !gd__paged_vertex(front->paged, vertex)) return;
    uint32_t *waiting = gd__wavefront_waiting(front, vertex);
    if (*waiting != front->queue->current) return;
    *waiting = GD_NONE;
    double distance = front->distance[vertex];
    if (distance != *gd__wavefront_emitted(front, vertex) &&
        distance + gd__wavefront_rest(front, vertex) <= front->bound)
        gd__emit_vertex(front, vertex);
    if (front->paged)
        leave_page(front, &front->paged->vertices, &gd__paged_vertex(front->paged, vertex)->page);
}

/* The first of three steps of prefetching: the records of a queued node. */
GD__PREFETCH prefetch_records(const struct gd__wavefront *front, uint32_t node)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t sides = 2 * mesh->edge_count;
    if (node < sides) {
        if (!front->paged) __builtin_prefetch(&front->lists[node]);
        __builtin_prefetch(&mesh->side[node]);
        __builtin_prefetch(&mesh->origin[node]);
        if (!front->paged) __builtin_prefetch(&front->newest[node >> 1]);
    } else if (node != GD_NONE) {
        __builtin_prefetch(&front->distance[node - sides]);
        if (!front->paged) __builtin_prefetch(&front->predecessor[node - sides]);
        __builtin_prefetch(&mesh->fan_first[node - sides]);
    }
}

/* The second step: the data to which these records refer. */
GD__PREFETCH prefetch_named(const struct gd__wavefront *front, uint32_t node)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t sides = 2 * mesh->edge_count;
    if (node < sides) {
        const struct gd_side *s = &mesh->side[node];
        __builtin_prefetch(&front->distance[mesh->origin[node]]);
        __builtin_prefetch(&front->distance[mesh->origin[node ^ 1]]);
        if (s->left == GD_NONE) return;
        __builtin_prefetch(&mesh->origin[s->right]);
    } else if (node != GD_NONE) {
        if (front->paged && !gd__paged_vertex(front->paged, node - sides)) return;
        uint32_t first = mesh->fan_first[node - sides],
                 side = gd__wavefront_predecessor(front, node - sides)->side;
        for (uint32_t i = first; i < first + 8; i += 4) __builtin_prefetch(&mesh->fan[i]);
        if (side != GD_NONE) __builtin_prefetch(&mesh->side[side]);
    }
}

/* The third step: the data to which the data of the second step refers. */
GD__PREFETCH prefetch_work(const struct gd__wavefront *front, uint32_t node)
{
    const struct gd_mesh *mesh = front->mesh;
    uint32_t sides = 2 * mesh->edge_count;
    if (node < sides) {
        if (front->paged && !gd__paged_side(front->paged, node)) return;
        const struct gd__list *list = gd__wavefront_list(front, node);
        const char *block = list->block;
        size_t array = gd__list_capacity(list) * sizeof(double),
               second = list->count > GD__WINDOWS_GROUP ? GD__WINDOWS_GROUP * sizeof(double) : 0;
        for (int i = 0; i < 6 && block; i++) {
            __builtin_prefetch(block + i * array);
            __builtin_prefetch(block + i * array + second);
        }
        if (mesh->side[node].left != GD_NONE)
            __builtin_prefetch(&front->distance[mesh->origin[mesh->side[node].right]]);
    } else if (node != GD_NONE) {
        for (uint32_t i = mesh->fan_first[node - sides]; i < mesh->fan_first[node - sides + 1];
             i++) {
            __builtin_prefetch(&mesh->side[mesh->fan[i].side]);
            __builtin_prefetch(&front->distance[mesh->fan[i].tip]);
        }
    }
}

static void check_control(struct gd__wavefront *front)
{
    double part = (double)front->sides_visited / (2 * (double)front->mesh->edge_count);
    if (!front->status) front->status = gd_control_check(front->monitor, part);
    if (!front->status &&
        front->counts.windows_propagated + front->counts.wedges_compared > front->work_limit)
        front->status = GD_RUNAWAY;
}

/* Processes nodes until the queue is empty. */
static void wavefront_advance(struct gd__wavefront *front)
{
    uint32_t sides = 2 * front->mesh->edge_count, node;
    const bool is_large = sides > SIDES_IN_CACHE;
    uint64_t next_check = 0;
    for (uint64_t work = 0; !front->status; work++) {
        node = gd__queue_pop(front->queue);
        if (node == GD_NONE) break;
        prefetch_records(front,
                         gd__queue_peek(front->queue, is_large ? RECORDS_AHEAD : WORK_AHEAD));
        if (is_large) {
            prefetch_named(front, gd__queue_peek(front->queue, NAMED_AHEAD));
            prefetch_work(front, gd__queue_peek(front->queue, WORK_AHEAD));
        }
        if (node < sides)
            work_on_side(front, node);
        else
            work_on_vertex(front, node - sides);
        if (front->counts.windows_propagated + ITEM_WINDOWS * work >= next_check) {
            next_check = front->counts.windows_propagated + ITEM_WINDOWS * work + CHECK_WINDOWS;
            check_control(front);
        }
    }
    if (!front->status && front->queue->out_of_memory) front->status = GD_NO_MEMORY;
}

static enum gd_status wavefront_propagate(struct gd__wavefront *front,
                                          const struct gd__propagation *propagation)
{
    enum gd_status status = wavefront_open(front, propagation);
    if (status) return status;
    gd__emit_seeds(front);
    wavefront_advance(front);
    return front->status;
}

enum gd_status gd__wavefront_run(const struct gd_mesh *mesh,
                                 const struct gd__propagation *propagation,
                                 const struct gd__sink *sink, const struct gd_control *monitor)
{
    struct gd_workspace own = {0},
                        *work = monitor && monitor->workspace ? monitor->workspace : &own;
    struct gd__wavefront front = {.mesh = mesh,
                                  .work = work,
                                  .seeds = propagation->seeds,
                                  .seed_count = propagation->seed_count,
                                  .variant = propagation->variant,
                                  .guide = propagation->guide,
                                  .monitor = monitor};
    enum gd_status status = wavefront_propagate(&front, propagation);
    if (!status) status = sink->take(sink->user, &front);
    if (work == &own)
        gd_workspace_trim(work);
    else
        gd__workspace_clean(work);
    return status;
}
