#include "window/contest.h"
#include "wavefront/wavefront.h"

/* Pruning: compares windows with the stored wedges of their edge (the paper's merged list of an
 * edge, Property 3). Ends of wedges are stored with an error of 2^-32 of the edge. Pieces that are
 * only a few times as wide as this error are dropped, because the neighbouring windows cover their
 * rays.
 *
 * A wedge stores its source, not the source's distance when it was stored. If that distance has
 * decreased since, the wedge was propagated with the longer distance, but its distances are now
 * computed with the shorter one. So the wedge would tie with the windows that the source has
 * emitted again, and would prune these windows, although they must propagate. Therefore chunks
 * older than the source's present distance are skipped, and waiting windows with an older distance
 * are dropped before they are stored. */

#define NARROW (4 * GD__WEDGE_UNIT)

/* Appends the wedges of a chunk to `out`, which must have room, as sorted windows in the frame of
 * `side`. Selects the wedges that came from windows of `side` (`own`) or of the other side. Skips a
 * wedge if the distance of its source has decreased since the wedge was stored. */
static void stored_windows(const struct gd__wavefront *front, const struct gd__chunk *chunk,
                           uint32_t side, bool own, struct gd__stack *out)
{
    double length = front->mesh->side[side].length;
    struct gd__wedges wedges = gd__chunk_wedges(chunk);
    uint32_t at = (uint32_t)(((const char *)chunk - front->work->wedges.base) / GD__CHUNK_UNIT);
    for (uint32_t i = 0; i < chunk->count; i++) {
        struct gd__window w =
            gd__wedge_window(&wedges, side & 1 ? chunk->count - 1 - i : i, length);
        bool is_own = (w.tags & GD__WINDOW_FAR_SIDE ? 1 : 0) == (side & 1);
        if (w.source == GD_NONE || is_own != own) continue;
        if (w.source < front->mesh->vertex_count && at < gd__wavefront_valid_from(front, w.source))
            continue;
        if (side & 1) w = gd__window_mirrored(&w, length);
        w.sigma = gd__wavefront_sigma(front, &w);
        out->windows[out->count++] = w;
    }
}

/* Removes the parts of `w` where the stored windows are better, and appends the remaining pieces.
 * *first is the index of the first stored window that may overlap `w` or a later window. */
static void cut_window(const struct gd__window *w, const struct gd__stack *stored, bool own,
                       double narrow, uint32_t *first, struct gd__stack *out)
{
    double start = w->b0; /* start of the piece that has been kept so far */
    while (*first < stored->count && stored->windows[*first].b1 <= w->b0) ++*first;
    for (uint32_t i = *first; i < stored->count && stored->windows[i].b0 < w->b1; i++) {
        const struct gd__window *s = &stored->windows[i];
        double lo = fmax(w->b0, s->b0), hi = fmin(w->b1, s->b1);
        if (hi - lo <= 0) continue;
        struct gd__contest_result verdict =
            own ? gd__contest(w, s, lo, hi) : gd__contest(s, w, lo, hi);
        bool stored_wins = verdict.challenger_first != own;
        for (int k = 0; k <= verdict.switches; k++, stored_wins = !stored_wins) {
            double from = k ? verdict.at[k - 1] : lo,
                   to = k < verdict.switches ? verdict.at[k] : hi;
            if (!stored_wins) continue;
            gd__stack_put(out, w, start, from, narrow);
            start = to;
        }
    }
    gd__stack_put(out, w, start, w->b1, narrow);
}

static enum gd_status cut_by_chunk(const struct gd__wavefront *front, const struct gd__chunk *chunk,
                                   uint32_t side, bool own, const struct gd__stack *list,
                                   struct gd__stack *stored, struct gd__stack *out)
{
    enum gd_status status = gd__stack_reserve(stored, chunk->count + 1);
    if (!status) status = gd__stack_reserve(out, gd__merged_bound(list->count, chunk->count));
    if (status) return status;
    uint32_t first = 0;
    stored->count = out->count = 0;
    stored_windows(front, chunk, side, own, stored);
    for (uint32_t i = 0; i < list->count; i++)
        cut_window(&list->windows[i], stored, own, NARROW * front->mesh->side[side].length, &first,
                   out);
    return GD_OK;
}

enum gd_status gd__prune_by_stored(struct gd__wavefront *front, uint32_t side, enum gd__prune_by by,
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
        bool is_own = chunk->is_far == (side & 1);
        at = gd__chunk_previous(chunk);
        front->counts.wedges_compared += chunk->count;
        if (!(by & (is_own ? GD__PRUNE_BY_OWN : GD__PRUNE_BY_OTHER))) continue;
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
