#include "window/stack.h"

#include "base/array.h"
#include "window/contest.h"

enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity)
{
    return gd__array_extend(&stack->windows, &stack->capacity, capacity, sizeof *stack->windows,
                            NULL);
}

void gd__stack_destroy(struct gd__stack *stack)
{
    free(stack->windows);
    *stack = (struct gd__stack){0};
}

void gd__stack_load(struct gd__stack *stack, const struct gd__windows *windows, uint32_t first,
                    uint32_t end)
{
    for (uint32_t i = first; i < end; i++)
        stack->windows[stack->count++] = gd__windows_get(windows, i);
}

/* Appends the piece [from, to] of a window. If the last piece has the same source and ends at
 * `from`, extends that piece instead. */
static void append_piece(struct gd__stack *out, const struct gd__window *w, double from, double to,
                         double min_width, const struct gd__window **last)
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

/* A cursor over a sorted list: the current window, and the start of the part of this window that is
 * not yet merged. */
struct cursor {
    const struct gd__window *at, *end;
    double from;
};

static bool cursor_is_done(const struct cursor *c)
{
    return c->at == c->end;
}

static void cursor_advance(struct cursor *c, double to)
{
    c->at++;
    if (!cursor_is_done(c)) c->from = c->at->b0 > to ? c->at->b0 : to;
}

/* Appends the rest of the current window and advances. */
static void cursor_take_rest(struct cursor *c, double min_width, struct gd__stack *out,
                             const struct gd__window **last)
{
    append_piece(out, c->at, c->from, c->at->b1, min_width, last);
    cursor_advance(c, -HUGE_VAL);
}

/* Contests the two current windows on their overlap, which starts at the same point for both.
 * Advances both cursors past the overlap. */
static void take_overlap(struct cursor *existing, struct cursor *newer, double min_width,
                         struct gd__stack *out, const struct gd__window **last)
{
    double from = existing->from,
           to = existing->at->b1 < newer->at->b1 ? existing->at->b1 : newer->at->b1;
    struct gd__contest_result result = gd__contest(newer->at, existing->at, from, to);
    bool newer_wins = result.challenger_first;
    for (int i = 0; i <= result.switches; i++) {
        double until = i < result.switches ? result.at[i] : to;
        append_piece(out, newer_wins ? newer->at : existing->at, from, until, min_width, last);
        newer_wins = !newer_wins;
        from = until;
    }
    existing->from = newer->from = to;
    if (existing->at->b1 <= to + min_width) cursor_advance(existing, to);
    if (newer->at->b1 <= to + min_width) cursor_advance(newer, to);
}

void gd__merge(const struct gd__window *existing, uint32_t existing_count,
               const struct gd__window *newer, uint32_t newer_count, double min_width,
               struct gd__stack *out)
{
    struct cursor e = {existing, existing + existing_count, existing_count ? existing->b0 : 0};
    struct cursor n = {newer, newer + newer_count, newer_count ? newer->b0 : 0};
    const struct gd__window *last = NULL;
    while (!cursor_is_done(&e) || !cursor_is_done(&n)) {
        if (cursor_is_done(&n) || (!cursor_is_done(&e) && e.at->b1 <= n.from + min_width)) {
            cursor_take_rest(&e, min_width, out, &last);
        } else if (cursor_is_done(&e) || n.at->b1 <= e.from + min_width) {
            cursor_take_rest(&n, min_width, out, &last);
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

/* Pushes a window in the general case: merges it with the windows of the list that end after the
 * window's start. */
static enum gd_status merge_into_tail(struct gd__stack *list, const struct gd__window *window,
                                      double min_width, struct gd__stack *scratch)
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

enum push { PUSH_REST, PUSH_AGAIN, PUSH_DONE, PUSH_GENERAL };

/* Returns true if the part of the window before the list's last window loses everywhere, that is,
 * if better windows of the list cover this part without a gap. */
static bool is_beaten_before(const struct gd__stack *list, const struct gd__window *w,
                             double min_width)
{
    double last = list->windows[list->count - 1].b0, until = last < w->b1 ? last : w->b1;
    for (uint32_t i = list->count - 1; i > 0 && w->b0 < until - min_width; i--) {
        const struct gd__window *owner = &list->windows[i - 1];
        if (owner->b0 >= until) continue;
        if (owner->b1 < until - min_width) return false;
        double lo = w->b0 > owner->b0 ? w->b0 : owner->b0,
               hi = owner->b1 < until ? owner->b1 : until;
        struct gd__contest_result result = gd__contest(w, owner, lo, hi);
        if (result.switches || result.challenger_first) return false;
        until = owner->b0;
    }
    return w->b0 >= until - min_width;
}

/* Handles a window that wins the part [from, to) of the list's last window. Cuts the last window
 * into the two pieces before and after this part. Reduces `w` to its part beyond the last window.
 * There must be room for two more windows. */
static enum push split_last(struct gd__stack *list, struct gd__window *w, double from, double to,
                            double min_width)
{
    struct gd__window whole = list->windows[--list->count];
    gd__stack_put(list, &whole, whole.b0, from, min_width);
    gd__stack_put(list, w, from, to, min_width);
    gd__stack_put(list, &whole, to, whole.b1, min_width);
    w->b0 = whole.b1;
    return w->b1 > w->b0 ? PUSH_REST : PUSH_DONE;
}

/* Contests the window with the list's last window, which it overlaps. In the frequent cases the
 * function only trims one of the two windows in place. There must be room for three more
 * windows. */
static enum push contest_last(struct gd__stack *list, struct gd__window *w, double min_width)
{
    struct gd__window *last = &list->windows[list->count - 1];
    double lo = w->b0 > last->b0 ? w->b0 : last->b0, hi = w->b1 < last->b1 ? w->b1 : last->b1;
    if (hi - lo <= min_width) {
        if (w->b1 <= last->b0 + min_width) /* the window belongs farther back */
            return is_beaten_before(list, w, min_width) ? PUSH_DONE : PUSH_GENERAL;
        w->b0 = last->b1;
        return PUSH_REST;
    }
    struct gd__contest_result result = gd__contest(w, last, lo, hi);
    if (result.switches > 1) return PUSH_GENERAL;
    bool wins_first = result.challenger_first, wins_last = wins_first != (result.switches == 1);
    if (w->b0 < lo && !wins_first && is_beaten_before(list, w, min_width)) w->b0 = lo;
    /* start of the part that the window wins */
    double from = wins_first ? lo : wins_last ? result.at[0] : hi;
    if (hi == last->b1 && wins_last) {
        if (wins_first && lo <= last->b0 + min_width) {
            list->count--;
            return PUSH_AGAIN;
        }
        if (w->b0 < lo) return PUSH_GENERAL;
        last->b1 = w->b0 = from;
        if (last->b1 - last->b0 <= min_width) list->count--;
        return PUSH_REST;
    }
    if (w->b0 < lo) return PUSH_GENERAL;
    if (wins_first || wins_last)
        return split_last(list, w, from, wins_last ? hi : result.at[0], min_width);
    if (hi >= w->b1 - min_width) return PUSH_DONE;
    w->b0 = hi;
    return PUSH_REST;
}

/* Like gd__stack_push, but modifies the window. It works without a copy, because reading a copy
 * that was just written would stall the processor. */
static enum gd_status stack_push(struct gd__stack *list, struct gd__window *w, double min_width,
                                 struct gd__stack *scratch)
{
    if (list->count && gd__window_joins(&list->windows[list->count - 1], w, min_width)) {
        struct gd__window *last = &list->windows[list->count - 1];
        if (w->b1 > last->b1) last->b1 = w->b1;
        return GD_OK;
    }
    enum gd_status status = gd__stack_reserve(list, list->count + 3);
    if (status) return status;
    enum push push = PUSH_AGAIN;
    while (push == PUSH_AGAIN && list->count &&
           w->b0 < list->windows[list->count - 1].b1 - min_width)
        push = contest_last(list, w, min_width);
    if (push == PUSH_GENERAL) return merge_into_tail(list, w, min_width, scratch);
    if (push != PUSH_DONE) gd__stack_put(list, w, w->b0, w->b1, min_width);
    return GD_OK;
}

enum gd_status gd__stack_push(struct gd__stack *list, const struct gd__window *window,
                              double min_width, struct gd__stack *scratch)
{
    struct gd__window w = *window;
    return stack_push(list, &w, min_width, scratch);
}
