#include "base/prefetch.h"
#include "wavefront/wavefront.h"

/* Number of visits of a side after which its windows are pruned. On real meshes, few sides have
 * more than three visits. */
#define PRUNE_AFTER 8
/* Number of visits of a side after which its wedges are stored for pruning. This is for
 * propagations that do not store all wedges. */
#define STORE_AFTER  4
#define LINE         64 /* bytes of a cache line */
#define LINES_BEFORE 16 /* number of cache lines for the wedges of a few lists */
#define LINES_AHEAD  3  /* number of cache lines for the wedges of one list */

/* Prefetches the cache lines for the wedges of the next lists, because this memory is not in the
 * cache. */
GD__PREFETCH prefetch_ahead(const char *end)
{
    for (int i = 0; i < LINES_AHEAD; i++)
        __builtin_prefetch(end + (ptrdiff_t)LINE * (LINES_BEFORE + i), 1);
}

/* Prefetches the lists that receive the children. */
GD__PREFETCH prefetch_receivers(const struct gd__wavefront *front, uint32_t side)
{
    const struct gd_side *s = &front->mesh->side[side];
    if (front->paged || s->left == GD_NONE) return;
    __builtin_prefetch(&front->lists[s->left], 1);
    __builtin_prefetch(&front->lists[s->right], 1);
}

/* Stores windows as a chunk of wedges of the side's edge. */
static enum gd_status store_chunk(struct gd__wavefront *front, uint32_t side,
                                  const struct gd__windows *windows, uint32_t count)
{
    if (count > GD__CHUNK_MOST / 2) return GD_BUDGET; /* gd__wedges_bound */
    enum gd_status status = gd__region_reserve(&front->work->wedges, gd__chunk_bound(count));
    if (status) return status;
    struct gd__chunk *chunk =
        (struct gd__chunk *)(front->work->wedges.base + front->work->wedges.used);
    double length = front->mesh->side[side].length;
    uint32_t *newest = gd__wavefront_newest(front, side >> 1);
    *chunk = (struct gd__chunk){.form = front->wedge_form};
    if (!front->kernel->store(windows, count, length, side & 1, chunk))
        gd__chunk_write(windows, count, length, side & 1, chunk);
    front->wedge_count += chunk->count;
    size_t bytes = gd__chunk_link(chunk, *newest);
    if (front->paged) gd__paged_side(front->paged, side)->page.stays = true;
    *newest = (uint32_t)(front->work->wedges.used / GD__CHUNK_UNIT);
    front->work->wedges.used += bytes;
    prefetch_ahead(front->work->wedges.base + front->work->wedges.used);
    return GD_OK;
}

void gd__store_window(struct gd__wavefront *front, uint32_t side, const struct gd__window *window)
{
    struct gd__window_builder *one = &front->work->scratch.tail;
    if (front->status || front->paged) return;
    front->status = gd__window_builder_reserve(one, 1);
    if (front->status) return;
    struct gd__list *list = gd__wavefront_list(front, side);
    gd__workspace_touch(front->work, side, !list->touched);
    list->touched = true;
    gd__windows_put(&one->at, 0, window);
    front->status = store_chunk(front, side, &one->at, 1);
}

static enum gd_status open_children(struct gd_workspace *work, uint32_t count)
{
    enum gd_status status = gd__children_open(&work->left, &work->pool, count);
    if (status) return status;
    status = gd__children_open(&work->right, &work->pool, count);
    if (status) gd__children_close(&work->left, &work->pool);
    return status;
}

static void deliver_children(struct gd__wavefront *front, const struct gd__receiver *to,
                             struct gd__children *children)
{
    if (!children->count) {
        gd__children_close(children, &front->work->pool);
        return;
    }
    if (children->tangled != GD_NONE && !front->status)
        front->status = gd__children_sort(children, &front->work->pool, GD_TOL_WIDTH * to->length,
                                          &front->work->scratch);
    gd__wavefront_deliver(front, to, children);
}

/* Returns true if the ray through the end `end` of window `at` passes (px, py) at a distance of
 * more than `apart`. */
static inline bool passes_far_off(const struct gd__windows *w, uint32_t at, double end, double px,
                                  double py, double apart)
{
    double ex = end - w->x[at], y = w->y[at];
    return fabs(ex * (py + y) - y * (px - w->x[at])) > apart * (fabs(ex) + y) &&
           !gd__source_is_linear(w->source[at]);
}

/* Offers the apex a path that bends at an end of a window. This path is needed if rounding has
 * removed the window that would see the apex. Only the two windows that are closest to the line of
 * sight to the apex need such paths. */
static inline void offer_bend(struct gd__apex *apex, const struct gd_side *s,
                              const struct gd__windows *w, uint32_t at, double end)
{
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y, fx = px - end;
    if (passes_far_off(w, at, end, px, py, GD_TOL_BESIDE_APEX * s->length)) return;
    struct gd__window window = gd__windows_get(w, at);
    if (!(gd__window_distance_beyond(&window, px, py) < apex->distance)) return;
    double distance = gd__window_distance(&window, end) + sqrt(fx * fx + py * py);
    if (distance >= apex->distance * (1 - GD_TOL_BETTER)) return;
    apex->distance = distance;
    apex->improved = true;
    apex->x = end;
    apex->y = 0;
    apex->source = GD_NONE;
}

/* Casts windows of a side across its face. Offers distances to the apex and windows to the other
 * two sides. */
static void cast_windows(struct gd__wavefront *front, const struct gd__receiver *at,
                         const struct gd__windows *windows, uint32_t count)
{
    uint32_t side = at->side;
    const struct gd_side *s = &front->mesh->side[side];
    uint32_t vertex = gd__side_apex(front->mesh, side);
    front->status = open_children(front->work, count);
    if (front->status) return;
    front->counts.windows_propagated += count;
    struct gd__apex apex = {.distance = front->distance[vertex]};
    front->kernel->cast(s, windows, count, !front->variant.no_coalescing, &apex, &front->work->left,
                        &front->work->right);
    if (apex.last_left != GD_NONE)
        offer_bend(&apex, s, windows, apex.last_left, windows->b1[apex.last_left]);
    if (apex.first_right != GD_NONE)
        offer_bend(&apex, s, windows, apex.first_right, windows->b0[apex.first_right]);
    if (apex.improved) {
        struct gd__predecessor predecessor = {
            .x = apex.x, .y = apex.y, .side = side, .source = apex.source};
        gd__wavefront_reach(front, vertex, apex.distance, predecessor);
    }
    double rest = gd__wavefront_rest(front, vertex);
    deliver_children(front,
                     &(struct gd__receiver){s->left, s->left_length, at->d0, apex.distance, at->l0,
                                            rest, at->distance_drops},
                     &front->work->left);
    deliver_children(front,
                     &(struct gd__receiver){s->right, s->right_length, apex.distance, at->d1, rest,
                                            at->l1, at->distance_drops},
                     &front->work->right);
}

/* Returns true if the distance of the window's source decreased after the source cast the window,
 * by more than GD_TOL_STALE. The source casts its windows again, and this window must not win
 * against the new ones. */
static bool is_stale(const struct gd__wavefront *front, const struct gd__windows *w, uint32_t i,
                     double length)
{
    if (w->source[i] >= front->mesh->vertex_count) return false;
    double reach = w->sigma[i] + fabs(w->x[i]) + w->y[i] + length;
    return w->sigma[i] - front->distance[w->source[i]] > GD_TOL_STALE * reach;
}

/* Drops stale windows; prune.c explains why. */
static uint32_t drop_stale(const struct gd__wavefront *front, const struct gd__windows *w,
                           uint32_t count, double length)
{
    uint32_t vertices = front->mesh->vertex_count, older = 0, kept = 0;
    for (uint32_t i = 0; i < count; i++)
        older += w->source[i] < vertices && w->sigma[i] != front->distance[w->source[i]];
    if (!older) return count;
    for (uint32_t i = 0; i < count; i++) {
        if (is_stale(front, w, i, length)) continue;
        struct gd__window window = gd__windows_get(w, i);
        if (kept < i) gd__windows_put(w, kept, &window);
        kept++;
    }
    return kept;
}

/* Removes the parts of a side's windows that cannot be part of a shortest path. */
static enum gd_status prune_windows(struct gd__wavefront *front, const struct gd__receiver *at,
                                    const struct gd__list *list, struct gd__windows *windows,
                                    uint32_t *count)
{
    double d0 = at->d0, d1 = at->d1;
    /* windows whose distances exceed the bound are not needed either */
    if (front->guide) {
        d0 = fmin(d0, front->bound - at->l0);
        d1 = fmin(d1, front->bound - at->l1);
    }
    if (list->distance_drops != front->distance_drops)
        *count = drop_stale(front, windows, *count, at->length);
    bool often = list->visits > (front->variant.no_filter ? 1 : PRUNE_AFTER);
    enum gd__prune_by by = often ? GD__PRUNE_BY_OWN : 0;
#ifdef GD_ABLATION
    if (front->variant.one_list) by |= GD__PRUNE_BY_OTHER;
#endif
    enum gd_status status = by ? gd__prune_by_stored(front, at->side, by, windows, count) : GD_OK;
    if (!status && !front->variant.no_filter)
        *count = front->kernel->filter(windows, *count, at->length, d0, d1);
    return status;
}

/* Empties the list. The caller owns the block. */
static void list_forget(struct gd__wavefront *front, struct gd__list *list)
{
    list->block = NULL;
    list->count = 0;
    if (list->visits == 0) front->sides_visited++;
    if (list->visits < UINT16_MAX) list->visits++;
}

void gd__propagate_side(struct gd__wavefront *front, uint32_t side)
{
    struct gd__list *list = gd__wavefront_list(front, side);
    struct gd__windows windows = gd__list_windows(list);
    void *block = list->block;
    uint32_t count = list->count, size_class = list->size_class;
    list_forget(front, list);
    prefetch_receivers(front, side);
    struct gd__receiver at = gd__wavefront_receiver(front, side, front->mesh->side[side].length);
    front->counts.sides_propagated++;
    front->status = prune_windows(front, &at, list, &windows, &count);
    bool stores = front->stores_all || list->stores || list->visits > STORE_AFTER;
    if (!front->status && count && stores)
        front->status = store_chunk(front, side, &windows, count);
    if (front->bound < GD__FAR && !front->guide)
        count = front->kernel->within(&windows, count, front->bound);
    if (!front->status && count && !gd__side_is_boundary(front->mesh, side))
        cast_windows(front, &at, &windows, count);
    gd__pool_release(&front->work->pool, block, size_class);
}
