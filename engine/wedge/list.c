#include "wedge/list.h"

#include <stdlib.h>
#include <string.h>

#include "wedge/contest.h"

enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity)
{
    if (capacity <= stack->capacity) return GD_OK;
    uint32_t grown = 1u << gd__pool_class(capacity);
    struct gd__window *windows = realloc(stack->windows, sizeof *windows * (size_t)grown);
    if (!windows) return GD_NO_MEMORY;
    stack->windows = windows;
    stack->capacity = grown;
    return GD_OK;
}

void gd__stack_destroy(struct gd__stack *stack)
{
    free(stack->windows);
    *stack = (struct gd__stack){0};
}

/* Appends the piece [from, to] of a window; a piece that continues the last one of the same window lengthens it. */
static void append_piece(struct gd__stack *out, const struct gd__window *w, double from, double to, double min_width,
                         const struct gd__window **last)
{
    if (*last == w && out->windows[out->count - 1].b1 == from) {
        out->windows[out->count - 1].b1 = to;
        return;
    }
    if (to - from <= min_width) return;
    struct gd__window *piece = &out->windows[out->count++];
    *piece = *w;
    piece->b0 = from;
    piece->b1 = to;
    *last = w;
}

/* A cursor over a sorted list: the window at hand and where its unread part starts. */
struct cursor {
    const struct gd__window *at, *end;
    double from;
};

static bool done(const struct cursor *c)
{
    return c->at == c->end;
}

static void advance(struct cursor *c, double to)
{
    c->at++;
    if (!done(c)) c->from = c->at->b0 > to ? c->at->b0 : to;
}

/* Passes the whole rest of the window at hand on. */
static void take_rest(struct cursor *c, double min_width, struct gd__stack *out, const struct gd__window **last)
{
    append_piece(out, c->at, c->from, c->at->b1, min_width, last);
    advance(c, -HUGE_VAL);
}

/* Both windows at hand start at the same place: contests their overlap and steps over it. */
static void take_overlap(struct cursor *existing, struct cursor *newer, double min_width, struct gd__stack *out,
                         const struct gd__window **last)
{
    double from = existing->from, to = existing->at->b1 < newer->at->b1 ? existing->at->b1 : newer->at->b1;
    struct gd__verdict verdict = gd__contest(newer->at, existing->at, from, to);
    bool newer_wins = verdict.challenger_first;
    for (int i = 0; i <= verdict.switches; i++) {
        double until = i < verdict.switches ? verdict.at[i] : to;
        append_piece(out, newer_wins ? newer->at : existing->at, from, until, min_width, last);
        newer_wins = !newer_wins;
        from = until;
    }
    existing->from = newer->from = to;
    if (existing->at->b1 <= to + min_width) advance(existing, to);
    if (newer->at->b1 <= to + min_width) advance(newer, to);
}

void gd__merge(const struct gd__window *existing, uint32_t existing_count, const struct gd__window *newer,
               uint32_t newer_count, double min_width, struct gd__stack *out)
{
    struct cursor e = {existing, existing + existing_count, existing_count ? existing->b0 : 0};
    struct cursor n = {newer, newer + newer_count, newer_count ? newer->b0 : 0};
    const struct gd__window *last = NULL;
    while (!done(&e) || !done(&n)) {
        if (done(&n) || (!done(&e) && e.at->b1 <= n.from + min_width)) {
            take_rest(&e, min_width, out, &last);
        } else if (done(&e) || n.at->b1 <= e.from + min_width) {
            take_rest(&n, min_width, out, &last);
        } else if (e.from < n.from) {
            append_piece(out, e.at, e.from, n.from, min_width, &last);
            e.from = n.from;
        } else if (n.from < e.from) {
            append_piece(out, n.at, n.from, e.from, min_width, &last);
            n.from = e.from;
        } else {
            take_overlap(&e, &n, min_width, out, &last);
        }
    }
}

/* The general case of a push: merges the window with the part of the list that reaches past its start. */
static enum gd_status merge_into_tail(struct gd__stack *list, const struct gd__window *window, double min_width,
                                      struct gd__stack *scratch)
{
    uint32_t start = list->count;
    while (start > 0 && list->windows[start - 1].b1 > window->b0 + min_width) start--;
    enum gd_status status = gd__stack_reserve(scratch, gd__merged_bound(list->count - start, 1));
    if (!status) status = gd__stack_reserve(list, start + gd__merged_bound(list->count - start, 1));
    if (status) return status;
    scratch->count = 0;
    gd__merge(list->windows + start, list->count - start, window, 1, min_width, scratch);
    memcpy(list->windows + start, scratch->windows, sizeof *scratch->windows * scratch->count);
    list->count = start + scratch->count;
    return GD_OK;
}

static bool joins(const struct gd__window *last, const struct gd__window *w, double min_width)
{
    return last->b1 >= w->b0 - GD_TOL_ADJACENT * (w->b1 - w->b0) - min_width && last->b0 <= w->b0 &&
           gd__window_same_source(last, w);
}

enum push { PUSH_REST, PUSH_AGAIN, PUSH_DONE, PUSH_GENERAL };

/* Contests the window with the last one, which it overlaps; the frequent outcomes trim one of the two in place. */
static enum push contest_last(struct gd__stack *list, struct gd__window *w, double min_width)
{
    struct gd__window *last = &list->windows[list->count - 1];
    double lo = w->b0 > last->b0 ? w->b0 : last->b0, hi = w->b1 < last->b1 ? w->b1 : last->b1;
    if (hi - lo <= min_width) {
        if (w->b1 <= last->b0 + min_width) return PUSH_GENERAL; /* its place is farther back */
        w->b0 = last->b1;
        return PUSH_REST;
    }
    struct gd__verdict verdict = gd__contest(w, last, lo, hi);
    if (verdict.switches == 1 && !verdict.challenger_first && hi == last->b1 && w->b0 >= last->b0) {
        last->b1 = w->b0 = verdict.at[0];
        if (last->b1 - last->b0 <= min_width) list->count--;
        return PUSH_REST;
    }
    if (verdict.switches == 0 && verdict.challenger_first && hi == last->b1) {
        if (lo <= last->b0 + min_width) {
            list->count--;
            return PUSH_AGAIN;
        }
        last->b1 = w->b0 = lo;
        return PUSH_REST;
    }
    if (verdict.switches == 0 && !verdict.challenger_first && lo == w->b0) {
        if (hi >= w->b1 - min_width) return PUSH_DONE;
        w->b0 = hi;
        return PUSH_REST;
    }
    return PUSH_GENERAL;
}

enum gd_status gd__stack_push(struct gd__stack *list, const struct gd__window *window, double min_width,
                              struct gd__stack *scratch)
{
    struct gd__window w = *window;
    if (list->count && joins(&list->windows[list->count - 1], &w, min_width)) {
        struct gd__window *last = &list->windows[list->count - 1];
        if (w.b1 > last->b1) last->b1 = w.b1;
        return GD_OK;
    }
    enum push push = PUSH_AGAIN;
    while (push == PUSH_AGAIN && list->count && w.b0 < list->windows[list->count - 1].b1 - min_width)
        push = contest_last(list, &w, min_width);
    if (push == PUSH_GENERAL) return merge_into_tail(list, &w, min_width, scratch);
    if (push == PUSH_DONE || w.b1 - w.b0 <= min_width) return GD_OK;
    enum gd_status status = gd__stack_reserve(list, list->count + 1);
    if (!status) list->windows[list->count++] = w;
    return status;
}

/* Part [from, to) of a side's list that `newer` overlaps; ends that only touch are cut to meet exactly. */
struct range {
    uint32_t from, to;
};

static struct range overlapped(const struct gd__list *list, struct gd__stack *newer, double min_width)
{
    const struct gd__window *windows = list->windows;
    uint32_t count = list->count;
    double begin = newer->windows[0].b0, end = newer->windows[newer->count - 1].b1;
    if (begin >= windows[count - 1].b1 - min_width) {
        if (begin < windows[count - 1].b1) newer->windows[0].b0 = windows[count - 1].b1;
        return (struct range){count, count};
    }
    if (end <= windows[0].b0 + min_width) {
        if (end > windows[0].b0) newer->windows[newer->count - 1].b1 = windows[0].b0;
        return (struct range){0, 0};
    }
    struct range range = {0, count};
    while (range.from < count && windows[range.from].b1 <= begin) range.from++;
    while (range.to > range.from && windows[range.to - 1].b0 >= end) range.to--;
    return range;
}

/* Lengthens the neighbours of an insertion instead of inserting windows that see the same source. Returns how many of the inserted windows
 * were used up at the front (*front) and at the back (*back). */
static void coalesce_neighbours(struct gd__list *list, struct range range, const struct gd__window *inserted,
                                uint32_t count, double min_width, uint32_t *front, uint32_t *back)
{
    *front = *back = 0;
    if (range.from > 0 && joins(&list->windows[range.from - 1], &inserted[0], min_width)) {
        list->windows[range.from - 1].b1 = inserted[0].b1;
        *front = 1;
    }
    if (range.to < list->count && count > *front && joins(&inserted[count - 1], &list->windows[range.to], min_width)) {
        list->windows[range.to].b0 = inserted[count - 1].b0;
        *back = 1;
    }
}

/* Replaces windows [range.from, range.to) of the list by `count` others. */
static enum gd_status splice(struct gd__list *list, struct gd__pool *pool, struct range range,
                             const struct gd__window *windows, uint32_t count)
{
    uint32_t tail = list->count - range.to, total = range.from + count + tail;
    if (list->windows && total <= 1u << list->size_class) {
        memmove(list->windows + range.from + count, list->windows + range.to, sizeof *windows * tail);
        memcpy(list->windows + range.from, windows, sizeof *windows * count);
        list->count = total;
        return GD_OK;
    }
    uint32_t size_class = gd__pool_class(total);
    struct gd__window *block = gd__pool_take(pool, size_class);
    if (!block) return pool->status;
    if (list->windows) {
        memcpy(block, list->windows, sizeof *block * range.from);
        memcpy(block + range.from + count, list->windows + range.to, sizeof *block * tail);
        gd__pool_release(pool, list->windows, list->size_class);
    }
    memcpy(block + range.from, windows, sizeof *block * count);
    list->windows = block;
    list->size_class = (uint8_t)size_class;
    list->count = total;
    return GD_OK;
}

enum gd_status gd__list_insert(struct gd__list *list, struct gd__pool *pool, struct gd__stack *newer, double min_width,
                               struct gd__stack *scratch)
{
    if (list->count == 0) return splice(list, pool, (struct range){0, 0}, newer->windows, newer->count);
    struct range range = overlapped(list, newer, min_width);
    const struct gd__window *inserted = newer->windows;
    uint32_t count = newer->count, front, back;
    if (range.to > range.from) {
        enum gd_status status = gd__stack_reserve(scratch, gd__merged_bound(range.to - range.from, newer->count));
        if (status) return status;
        scratch->count = 0;
        gd__merge(list->windows + range.from, range.to - range.from, newer->windows, newer->count, min_width, scratch);
        inserted = scratch->windows;
        count = scratch->count;
    }
    if (count == 0) return splice(list, pool, range, inserted, 0);
    coalesce_neighbours(list, range, inserted, count, min_width, &front, &back);
    return splice(list, pool, range, inserted + front, count - front - back);
}

enum gd_status gd__list_assign(struct gd__list *list, struct gd__pool *pool, const struct gd__window *windows,
                               uint32_t count)
{
    return splice(list, pool, (struct range){0, list->count}, windows, count);
}
