#include "window/list.h"

#include "window/contest.h"

/* Two sorted lists, where the windows of `behind` follow those of `before`. Only the last window of
 * `before` (its index is `last`) and the first window of `behind` (its index is `first`) may
 * overlap. */
struct seam {
    const struct gd__windows *before, *behind;
    uint32_t last, first;
    uint32_t before_left, behind_left; /* number of windows left; 0 means that all are dropped */
    /* true if the windows of `before` are newer than those of `behind`; the older windows win
       ties */
    bool newer_is_before;
};

enum closing { CLOSING_DONE, CLOSING_NEXT, CLOSING_GENERAL };

/* Contests the last window of `before` and the first window of `behind`. The window of the list
 * `before` is the challenger. */
static struct gd__contest_result contest_facing(const struct seam *s, double lo, double hi)
{
    struct gd__window before = gd__windows_get(s->before, s->last),
                      behind = gd__windows_get(s->behind, s->first);
    if (s->newer_is_before) return gd__contest(&before, &behind, lo, hi);
    struct gd__contest_result result = gd__contest(&behind, &before, lo, hi);
    result.challenger_first = !result.challenger_first;
    return result;
}

/* Cuts the last window of `before` and the first window of `behind` at their bisector, and drops a
 * window that loses everywhere. If another window affects the result, the function cuts nothing and
 * returns CLOSING_GENERAL. */
static enum closing close_facing(struct seam *s, double min_width)
{
    double *a0 = &s->before->b0[s->last], *a1 = &s->before->b1[s->last];
    double *b0 = &s->behind->b0[s->first], *b1 = &s->behind->b1[s->first];
    double lo = *a0 > *b0 ? *a0 : *b0, hi = *a1 < *b1 ? *a1 : *b1;
    if (hi - lo <= min_width) {
        if (*a1 > *b0 + min_width) return CLOSING_GENERAL;
        if (*a1 > *b0) *(s->newer_is_before ? a1 : b0) = s->newer_is_before ? *b0 : *a1;
        return CLOSING_DONE;
    }
    struct gd__contest_result result = contest_facing(s, lo, hi);
    bool before_first = result.challenger_first,
         before_last = before_first != (result.switches == 1);
    if (result.switches > 1 || (before_last && !before_first)) return CLOSING_GENERAL;
    if ((before_first && *b0 < lo) || (!before_last && *a1 > hi)) return CLOSING_GENERAL;
    double at = before_last ? hi : before_first ? result.at[0] : lo;
    if (before_first) *b0 = at;
    if (!before_last) *a1 = at;
    /* at most one of the two windows is dropped */
    bool a_is_gone = *a1 - *a0 <= min_width, b_is_gone = !a_is_gone && *b1 - *b0 <= min_width;
    s->last -= a_is_gone;
    s->before_left -= a_is_gone;
    s->first += b_is_gone;
    s->behind_left -= b_is_gone;
    return (a_is_gone || b_is_gone) && s->before_left && s->behind_left ? CLOSING_NEXT
                                                                        : CLOSING_DONE;
}

/* Concatenates two lists, one of which ends where the other begins. Cuts the overlap, and removes
 * dropped windows from both lists. Returns false if the lists must be merged instead. `newer` has
 * *count windows. */
static bool close_seam(struct gd__list *list, struct gd__windows *newer, uint32_t *count,
                       double min_width, bool *newer_is_before)
{
    struct gd__windows windows = gd__list_windows(list);
    uint32_t n = list->count, m = *count;
    bool starts_later = newer->b0[0] >= windows.b0[0],
         ends_later = newer->b1[m - 1] >= windows.b1[n - 1];
    if (starts_later != ends_later) return false;
    *newer_is_before = !starts_later;
    struct seam s = starts_later ? (struct seam){&windows, newer, n - 1, 0, n, m, false}
                                 : (struct seam){newer, &windows, m - 1, 0, m, n, true};
    enum closing closing;
    do closing = close_facing(&s, min_width);
    while (closing == CLOSING_NEXT);
    if (starts_later) {
        list->count = s.before_left;
        *newer = gd__windows_from(newer, s.first);
        *count = s.behind_left;
    } else {
        if (s.first) gd__windows_move(&windows, 0, s.first, s.behind_left);
        list->count = s.behind_left;
        *count = s.before_left;
    }
    return closing == CLOSING_DONE;
}

static bool windows_join_at(const struct gd__windows *a, uint32_t i, const struct gd__windows *b,
                            uint32_t j, double min_width)
{
    if (a->source[i] != b->source[j]) return false;
    struct gd__window before = gd__windows_get(a, i), behind = gd__windows_get(b, j);
    return gd__window_joins(&before, &behind, min_width);
}

/* Appends `count` windows to the list. If `join`, the first of them extends the list's last window
 * if both have the same source. */
static enum gd_status list_append(struct gd__list *list, struct gd__pool *pool,
                                  struct gd__windows newer, uint32_t count, double min_width,
                                  bool join)
{
    struct gd__windows windows = gd__list_windows(list);
    if (join && list->count && windows_join_at(&windows, list->count - 1, &newer, 0, min_width)) {
        windows.b1[list->count - 1] = newer.b1[0];
        newer = gd__windows_from(&newer, 1);
        count--;
    }
    if (list->count + count + GD__WINDOWS_GROUP > gd__list_capacity(list)) {
        enum gd_status status =
            gd__block_enlarge(&list->block, &list->size_class, pool,
                              list->count + count + GD__WINDOWS_GROUP, list->count);
        if (status) return status;
        windows = gd__list_windows(list);
    }
    gd__windows_copy(&windows, list->count, &newer, 0, count);
    list->count += count;
    return GD_OK;
}

/* Inserts the first `count` newer windows before those of the list. Copies the list's windows into
 * the block of the newer ones and swaps the two blocks. */
static enum gd_status list_prepend(struct gd__list *list, struct gd__pool *pool,
                                   struct gd__children *newer, uint32_t count, double min_width,
                                   bool join)
{
    struct gd__windows windows = gd__list_windows(list);
    if (join && list->count && windows_join_at(&newer->at, count - 1, &windows, 0, min_width))
        windows.b0[0] = newer->at.b0[--count];
    enum gd_status status = gd__children_grow(newer, pool, count + list->count, count);
    if (status) return status;
    gd__windows_copy(&newer->at, count, &windows, 0, list->count);
    struct gd__list old = *list;
    list->block = newer->block;
    list->size_class = newer->size_class;
    list->count += count;
    newer->block = old.block;
    newer->size_class = old.size_class;
    newer->at = windows;
    return GD_OK;
}

/* The windows that overlap: [from, to) of the list and [first, last) of the newer windows. If there
 * is no overlap, all newer windows are inserted at `from`, and first = last = number of newer
 * windows. */
struct overlap {
    uint32_t from, to, first, last;
};

static struct overlap find_overlap(const struct gd__windows *list, uint32_t count,
                                   const struct gd__windows *newer, uint32_t newer_count)
{
    double begin = newer->b0[0], end = newer->b1[newer_count - 1];
    struct overlap o = {0, count, 0, newer_count};
    while (o.from < count && list->b1[o.from] <= begin) o.from++;
    while (o.to > o.from && list->b0[o.to - 1] >= end) o.to--;
    if (o.to == o.from) return (struct overlap){o.from, o.from, newer_count, newer_count};
    while (o.first < newer_count && newer->b1[o.first] <= list->b0[o.from]) o.first++;
    while (o.last > o.first && newer->b0[o.last - 1] >= list->b1[o.to - 1]) o.last--;
    return o;
}

/* The windows that replace windows [from, to) of the list, in this order: newer windows [0, first),
 * the merged windows, newer windows [last, count). */
struct insertion {
    const struct gd__windows *newer;
    const struct gd__stack *merged;
    struct overlap at;
    uint32_t count; /* number of newer windows */
    /* newer windows [skip, first) and [last, end) are inserted; the others were joined to a
       neighbour */
    uint32_t skip, end;
};

/* If the first or the last newer window has the same source as the neighbouring window of the list,
 * extends this neighbour instead of inserting the newer window. */
static void join_neighbours(const struct gd__windows *list, uint32_t count, struct insertion *in,
                            double min_width)
{
    if (in->at.from > 0 && (in->at.first > 0 || !in->merged) &&
        windows_join_at(list, in->at.from - 1, in->newer, 0, min_width)) {
        list->b1[in->at.from - 1] = in->newer->b1[0];
        in->skip = 1;
    }
    if (in->at.to < count && (in->at.last < in->count || !in->merged) && in->count > in->skip &&
        windows_join_at(in->newer, in->count - 1, list, in->at.to, min_width)) {
        list->b0[in->at.to] = in->newer->b0[in->count - 1];
        in->end = in->count - 1;
    }
    if (in->at.first > in->end) in->at.first = in->end;
}

/* Rebuilds the list with the insertion. A copy writes whole groups and may overwrite windows behind
 * its end, so the parts are written in their order. */
static enum gd_status list_splice(struct gd__list *list, struct gd__pool *pool,
                                  const struct insertion *in, struct gd__window_builder *scratch)
{
    uint32_t tail = list->count - in->at.to,
             before = in->at.first > in->skip ? in->at.first - in->skip : 0,
             behind = in->end > in->at.last ? in->end - in->at.last : 0,
             merged = in->merged ? in->merged->count : 0;
    uint32_t count = in->at.from + before + merged + behind + tail, at = in->at.from;
    enum gd_status status = tail ? gd__window_builder_reserve(scratch, tail) : GD_OK;
    struct gd__windows windows = gd__list_windows(list);
    if (!status && tail) gd__windows_copy(&scratch->at, 0, &windows, in->at.to, tail);
    if (!status && count + GD__WINDOWS_GROUP > gd__list_capacity(list))
        status = gd__block_enlarge(&list->block, &list->size_class, pool, count + GD__WINDOWS_GROUP,
                                   in->at.from);
    if (status) return status;
    windows = gd__list_windows(list);
    gd__windows_copy(&windows, at, in->newer, in->skip, before);
    at += before;
    for (uint32_t i = 0; i < merged; i++) gd__windows_put(&windows, at++, &in->merged->windows[i]);
    gd__windows_copy(&windows, at, in->newer, in->at.last, behind);
    at += behind;
    gd__windows_copy(&windows, at, &scratch->at, 0, tail);
    list->count = count;
    return GD_OK;
}

/* Merges the overlap into scratch->stack[2]. */
static enum gd_status merge_overlap(const struct gd__windows *list, const struct gd__windows *newer,
                                    struct overlap o, double min_width, struct gd__scratch *scratch)
{
    struct gd__stack *existing = &scratch->stack[0], *challengers = &scratch->stack[1],
                     *merged = &scratch->stack[2];
    enum gd_status status = gd__stack_reserve(existing, o.to - o.from + 1);
    if (!status) status = gd__stack_reserve(challengers, o.last - o.first + 1);
    if (!status)
        status = gd__stack_reserve(merged, gd__merged_bound(o.to - o.from, o.last - o.first));
    if (status) return status;
    existing->count = challengers->count = merged->count = 0;
    gd__stack_load(existing, list, o.from, o.to);
    gd__stack_load(challengers, newer, o.first, o.last);
    gd__merge(existing->windows, existing->count, challengers->windows, challengers->count,
              min_width, merged);
    return GD_OK;
}

/* Inserts windows in the general case, in which the overlap is merged. */
static enum gd_status list_merge(struct gd__list *list, struct gd__pool *pool,
                                 const struct gd__windows *newer, uint32_t count, double min_width,
                                 struct gd__scratch *scratch)
{
    struct insertion in = {.newer = newer, .count = count, .end = count};
    struct gd__windows windows = gd__list_windows(list);
    in.at = find_overlap(&windows, list->count, newer, count);
    if (in.at.to > in.at.from) {
        enum gd_status status = merge_overlap(&windows, newer, in.at, min_width, scratch);
        if (status) return status;
        in.merged = &scratch->stack[2];
    }
    if (!scratch->apart) join_neighbours(&windows, list->count, &in, min_width);
    return list_splice(list, pool, &in, &scratch->tail);
}

static enum gd_status list_add_newer(struct gd__list *list, struct gd__pool *pool,
                                     struct gd__children *newer, double min_width,
                                     struct gd__scratch *scratch)
{
    struct gd__windows view = newer->at;
    uint32_t count = newer->count;
    bool is_before;
    if (!close_seam(list, &view, &count, min_width, &is_before))
        return list_merge(list, pool, &view, count, min_width, scratch);
    if (!count) return GD_OK;
    if (is_before) return list_prepend(list, pool, newer, count, min_width, !scratch->apart);
    return list_append(list, pool, view, count, min_width, !scratch->apart);
}

enum gd_status gd__list_add(struct gd__list *list, struct gd__pool *pool,
                            struct gd__children *newer, double min_width,
                            struct gd__scratch *scratch)
{
    enum gd_status status = list_add_newer(list, pool, newer, min_width, scratch);
    gd__children_close(newer, pool);
    return status;
}

/* --- one window ------------------------------------------------------------------------------- */

#define FEW 3 /* lists of at most that many windows are changed in their own block */
/* Each window of the list is cut into at most three pieces. Pieces of the new window lie between
 * them and at both ends. */
#define MOST_PARTS (4 * FEW + 1)
_Static_assert(MOST_PARTS <= 2 * GD__WINDOWS_GROUP,
               "the smallest block of a list has room for them");

static bool has_source(const struct gd__windows *windows, uint32_t count, uint32_t source)
{
    for (uint32_t i = 0; i < count; i++)
        if (windows->source[i] == source) return true;
    return false;
}

enum gd_status gd__list_add_one(struct gd__list *list, struct gd__pool *pool,
                                const struct gd__window *window, double min_width,
                                struct gd__scratch *scratch)
{
    struct gd__windows windows = gd__list_windows(list);
    if (list->count > FEW || has_source(&windows, list->count, window->source)) {
        struct gd__children one = {.count = 1};
        enum gd_status status = gd__children_open(&one, pool, 1);
        if (status) return status;
        gd__windows_put(&one.at, 0, window);
        return gd__list_add(list, pool, &one, min_width, scratch);
    }
    struct gd__window there[FEW], parts[MOST_PARTS];
    struct gd__stack merged = {.windows = parts};
    for (uint32_t i = 0; i < list->count; i++) there[i] = gd__windows_get(&windows, i);
    gd__merge(there, list->count, window, 1, min_width, &merged);
    for (uint32_t i = 0; i < merged.count; i++) gd__windows_put(&windows, i, &parts[i]);
    /* if all pieces are too narrow, the list stays unchanged */
    if (merged.count) list->count = merged.count;
    if (list->count + GD__WINDOWS_GROUP <= gd__list_capacity(list)) return GD_OK;
    return gd__block_enlarge(&list->block, &list->size_class, pool, list->count + GD__WINDOWS_GROUP,
                             list->count);
}
