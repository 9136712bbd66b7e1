#include "window/contest.h"
#include "wavefront/wavefront.h"

/* Pruning: windows are compared with the wedges that their edge has already (the paper's merged
 * list of an edge, Property 3). Wedges keep their ends to 2^-32 of the edge only; pieces that
 * narrow are left out, as the windows beside them cover what they would see.
 *
 * A wedge knows its source, not the distance that the source had when the wedge went on. Where that
 * distance fell since, the wedge went on with the longer one and would tie with the windows of the
 * later emission, which are the ones that have to go on: chunks older than the present distance are
 * passed over for this source, and what is still on its way with an older one is dropped before it
 * is stored. */

#define NARROW (4 * GD__WEDGE_UNIT)

void gd__stored_windows(const struct gd__wavefront *front, const struct gd__chunk *chunk,
                        uint32_t side, bool own, struct gd__stack *out)
{
    double length = front->mesh->side[side].length;
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    uint32_t at = (uint32_t)(((const char *)chunk - front->work->wedges.base) / GD__CHUNK_UNIT);
    for (uint32_t i = 0; i < chunk->count; i++) {
        struct gd__window w =
            gd__wedge_window(wedges, chunk->count, side & 1 ? chunk->count - 1 - i : i, length);
        bool is_own = (w.tags & GD__WINDOW_FAR_SIDE ? 1 : 0) == (side & 1);
        if (w.source == GD_NONE || is_own != own) continue;
        if (w.source < front->mesh->vertex_count && at < gd__wavefront_since(front, w.source))
            continue;
        if (side & 1) w = gd__window_mirrored(&w, length);
        w.sigma = gd__wavefront_sigma(front, &w);
        out->windows[out->count++] = w;
    }
}

static void keep(struct gd__stack *out, const struct gd__window *w, double from, double to,
                 double narrow)
{
    if (to - from <= narrow) return;
    out->windows[out->count] = *w;
    out->windows[out->count].b0 = from;
    out->windows[out->count++].b1 = to;
}

/* Cuts the pieces out of `w` where the stored windows are better, and appends what is left. *first
 * is the first that may still overlap. */
static void cut(const struct gd__window *w, const struct gd__stack *stored, bool own, double narrow,
                uint32_t *first, struct gd__stack *out)
{
    double start = w->b0; /* of the piece that is kept so far */
    while (*first < stored->count && stored->windows[*first].b1 <= w->b0) ++*first;
    for (uint32_t i = *first; i < stored->count && stored->windows[i].b0 < w->b1; i++) {
        const struct gd__window *s = &stored->windows[i];
        double lo = fmax(w->b0, s->b0), hi = fmin(w->b1, s->b1);
        if (hi - lo <= 0) continue;
        struct gd__verdict verdict = own ? gd__contest(w, s, lo, hi) : gd__contest(s, w, lo, hi);
        bool stored_wins = verdict.challenger_first != own;
        for (int k = 0; k <= verdict.switches; k++, stored_wins = !stored_wins) {
            double from = k ? verdict.at[k - 1] : lo,
                   to = k < verdict.switches ? verdict.at[k] : hi;
            if (!stored_wins) continue;
            keep(out, w, start, from, narrow);
            start = to;
        }
    }
    keep(out, w, start, w->b1, narrow);
}

/* Cuts all windows of `list` by one chunk; the result is in `out`. */
static enum gd_status cut_by_chunk(const struct gd__wavefront *front, const struct gd__chunk *chunk,
                                   uint32_t side, bool own, const struct gd__stack *list,
                                   struct gd__stack *stored, struct gd__stack *out)
{
    enum gd_status status = gd__stack_reserve(stored, chunk->count + 1);
    if (!status) status = gd__stack_reserve(out, gd__merged_bound(list->count, chunk->count));
    if (status) return status;
    uint32_t first = 0;
    stored->count = out->count = 0;
    gd__stored_windows(front, chunk, side, own, stored);
    for (uint32_t i = 0; i < list->count; i++)
        cut(&list->windows[i], stored, own, NARROW * front->mesh->side[side].length, &first, out);
    return GD_OK;
}

static bool is_of_side(const struct gd__chunk *chunk, uint32_t side)
{
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    uint32_t i = 0;
    while (i + 1 < chunk->count && gd__wedge_source(wedges.start[i]) == GD_NONE) i++;
    return (signbit(wedges.y[i]) != 0) == !(side & 1);
}

enum gd_status gd__prune_by_stored(struct gd__wavefront *front, uint32_t side, bool own, bool twin,
                                   struct gd__windows *windows, uint32_t *count)
{
    struct gd__stack *list = &front->work->scratch.stack[0],
                     *stored = &front->work->scratch.stack[1],
                     *out = &front->work->scratch.stack[2];
    enum gd_status status = gd__stack_reserve(list, *count + 1);
    if (status) return status;
    list->count = 0;
    gd__stack_load(list, windows, 0, *count);
    for (uint32_t at = *gd__wavefront_newest(front, side >> 1); at != GD_NONE && !status;) {
        const struct gd__chunk *chunk =
            (const struct gd__chunk *)(front->work->wedges.base + (size_t)at * GD__CHUNK_UNIT);
        bool is_own = is_of_side(chunk, side);
        at = chunk->previous;
        front->effort.wedges_compared += chunk->count;
        if (!(is_own ? own : twin)) continue;
        status = cut_by_chunk(front, chunk, side, is_own, list, stored, out);
        struct gd__stack swap = *list;
        *list = *out;
        *out = swap;
    }
    if (!status) status = gd__window_builder_reserve(&front->work->scratch.tail, list->count);
    if (status) return status;
    for (uint32_t i = 0; i < list->count; i++)
        gd__windows_put(&front->work->scratch.tail.at, i, &list->windows[i]);
    *windows = front->work->scratch.tail.at;
    *count = list->count;
    return GD_OK;
}
