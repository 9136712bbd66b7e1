#include "wedge/list.h"

#include <stdlib.h>
#include <string.h>

#include "wedge/contest.h"

enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity)
{
    if (capacity <= stack->capacity) return GD_OK;
    uint32_t grown = capacity < 32 ? 32 : 2 * capacity;
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

void gd__stack_load(struct gd__stack *stack, const struct gd__windows *windows, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; i < end; i++) stack->windows[stack->count++] = gd__windows_get(windows, i);
}

void gd__scratch_destroy(struct gd__scratch *scratch)
{
    for (int i = 0; i < 3; i++) gd__stack_destroy(&scratch->stack[i]);
    gd__window_builder_destroy(&scratch->tail);
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

static void put(struct gd__stack *list, const struct gd__window *w, double from, double to, double min_width)
{
    if (to - from <= min_width) return;
    struct gd__window *place = &list->windows[list->count++]; /* field by field: see push */
    place->b0 = from;
    place->b1 = to;
    place->x = w->x;
    place->y = w->y;
    place->sigma = w->sigma;
    place->source = w->source;
    place->tags = w->tags;
}

/* The part of the window that lies before the last one of the list is useless: others are there already, without a gap, and better. */
static bool is_beaten_before(const struct gd__stack *list, const struct gd__window *w, double min_width)
{
    uint32_t i = list->count - 1;
    for (; i > 0 && w->b0 < list->windows[i].b0 - min_width; i--) {
        const struct gd__window *owner = &list->windows[i - 1];
        double lo = w->b0 > owner->b0 ? w->b0 : owner->b0, hi = owner->b1;
        if (hi < list->windows[i].b0 - min_width) return false;
        struct gd__verdict verdict = gd__contest(w, owner, lo, hi);
        if (verdict.switches || verdict.challenger_first) return false;
    }
    return i > 0;
}

/* The window is better than the last one in [from, to), which falls into two pieces; what reaches beyond that one is left. There is room. */
static enum push split_last(struct gd__stack *list, struct gd__window *w, double from, double to, double min_width)
{
    struct gd__window whole = list->windows[--list->count];
    put(list, &whole, whole.b0, from, min_width);
    put(list, w, from, to, min_width);
    put(list, &whole, to, whole.b1, min_width);
    w->b0 = whole.b1;
    return w->b1 > w->b0 ? PUSH_REST : PUSH_DONE;
}

/* Contests the window with the last one, which it overlaps; the frequent outcomes trim one of the two in place. There is room for three more. */
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
    if (verdict.switches > 1) return PUSH_GENERAL;
    bool wins_first = verdict.challenger_first, wins_last = wins_first != (verdict.switches == 1);
    if (w->b0 < lo && !wins_first && is_beaten_before(list, w, min_width)) w->b0 = lo;
    double from = wins_first ? lo : wins_last ? verdict.at[0] : hi; /* where it begins to be better */
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
    if (wins_first || wins_last) return split_last(list, w, from, wins_last ? hi : verdict.at[0], min_width);
    if (hi >= w->b1 - min_width) return PUSH_DONE;
    w->b0 = hi;
    return PUSH_REST;
}

/* gd__stack_push of a window that is used up. It is handled where it lies: copied from memory it was just written to, it would be waited for. */
static enum gd_status push(struct gd__stack *list, struct gd__window *w, double min_width, struct gd__stack *scratch)
{
    if (list->count && joins(&list->windows[list->count - 1], w, min_width)) {
        struct gd__window *last = &list->windows[list->count - 1];
        if (w->b1 > last->b1) last->b1 = w->b1;
        return GD_OK;
    }
    enum gd_status status = gd__stack_reserve(list, list->count + 3);
    if (status) return status;
    enum push push = PUSH_AGAIN;
    while (push == PUSH_AGAIN && list->count && w->b0 < list->windows[list->count - 1].b1 - min_width)
        push = contest_last(list, w, min_width);
    if (push == PUSH_GENERAL) return merge_into_tail(list, w, min_width, scratch);
    if (push != PUSH_DONE) put(list, w, w->b0, w->b1, min_width);
    return GD_OK;
}

enum gd_status gd__stack_push(struct gd__stack *list, const struct gd__window *window, double min_width,
                              struct gd__stack *scratch)
{
    struct gd__window w = *window;
    return push(list, &w, min_width, scratch);
}

/* --- blocks -------------------------------------------------------------------------------------------------------------- */

static uint32_t class_for(uint32_t windows)
{
    return gd__pool_class((windows + GD__WINDOWS_GROUP - 1) / GD__WINDOWS_GROUP);
}

/* A block of the class that holds that many windows, of which the first `kept` are copied; the one there was is released. */
static enum gd_status move_to_larger(void **block, uint8_t *size_class, struct gd__pool *pool, uint32_t windows,
                                     uint32_t kept)
{
    uint32_t class = class_for(windows);
    void *larger = gd__pool_take(pool, class);
    if (!larger) return pool->status;
    if (*block) {
        struct gd__windows to = gd__windows_at(larger, GD__WINDOWS_GROUP * gd__pool_items(class)),
                           from = gd__windows_at(*block, GD__WINDOWS_GROUP * gd__pool_items(*size_class));
        gd__windows_copy(&to, 0, &from, 0, kept);
        gd__pool_release(pool, *block, *size_class);
    }
    *block = larger;
    *size_class = (uint8_t) class;
    return GD_OK;
}

/* Room for that many windows and a group behind them; the first `kept` stay. */
static enum gd_status grow(struct gd__children *children, struct gd__pool *pool, uint32_t count, uint32_t kept)
{
    uint32_t need = count + GD__WINDOWS_GROUP;
    if (children->block && need <= GD__WINDOWS_GROUP * gd__pool_items(children->size_class)) return GD_OK;
    enum gd_status status = move_to_larger(&children->block, &children->size_class, pool, need, kept);
    if (!status)
        children->at = gd__windows_at(children->block, GD__WINDOWS_GROUP * gd__pool_items(children->size_class));
    return status;
}

enum gd_status gd__children_reserve(struct gd__children *children, struct gd__pool *pool, uint32_t count)
{
    return grow(children, pool, count, 0);
}

/* --- lists that were built as they came ---------------------------------------------------------------------------------- */

/* How many windows before the first tangled one are taken along: what is pushed seldom reaches farther back. */
#define BEFORE_TANGLE 4

/* Untangles windows [base, count), of which those before children->tangled are in order, into scratch->stack[0]. Stops at the first window behind
 * the last tangled one that lies clear of all before it: *rest, from which on the windows stay as they are. False when a window reaches back
 * beyond `base`. */
static bool untangle_from(const struct gd__children *children, uint32_t base, double min_width,
                          struct gd__scratch *scratch, uint32_t *rest, enum gd_status *status)
{
    struct gd__stack *list = &scratch->stack[0];
    const struct gd__windows *windows = &children->at;
    list->count = 0;
    *status = gd__stack_reserve(list, gd__merged_bound(children->count - base, 0));
    if (*status) return true;
    gd__stack_load(list, windows, base, children->tangled);
    for (uint32_t i = children->tangled; i < children->count; i++) {
        struct gd__window w = gd__windows_get(windows, i);
        *rest = i;
        if (w.b1 - w.b0 <= min_width) continue; /* cut off from both ends */
        if (scratch->apart) w.tags = (i + 1) * GD__WINDOW_SERIAL;
        bool is_clear = list->count && w.b0 >= list->windows[list->count - 1].b1 - min_width;
        if (is_clear && i > children->tangled_last + 1) return true;
        *status = push(list, &w, min_width, &scratch->stack[1]);
        if (*status) return true;
        if (base > 0 && (!list->count || list->windows[0].b0 != windows->b0[base])) return false;
    }
    *rest = children->count;
    return true;
}

/* Puts the untangled windows from place `base` on, and those from `rest` on behind them. */
static enum gd_status put_back(struct gd__children *children, struct gd__pool *pool, uint32_t base, uint32_t rest,
                               struct gd__scratch *scratch)
{
    const struct gd__stack *list = &scratch->stack[0];
    uint32_t behind = children->count - rest, count = base + list->count + behind;
    enum gd_status status = behind ? gd__window_builder_reserve(&scratch->tail, behind) : GD_OK;
    if (!status) gd__windows_copy(&scratch->tail.at, 0, &children->at, rest, behind);
    if (!status) status = grow(children, pool, count, base);
    if (status) return status;
    for (uint32_t i = 0; i < list->count; i++) gd__windows_put(&children->at, base + i, &list->windows[i]);
    gd__windows_copy(&children->at, base + list->count, &scratch->tail.at, 0, behind);
    children->count = count;
    children->tangled = GD_NONE;
    return GD_OK;
}

enum gd_status gd__untangle(struct gd__children *children, struct gd__pool *pool, double min_width,
                            struct gd__scratch *scratch)
{
    enum gd_status status;
    uint32_t base = children->tangled > BEFORE_TANGLE ? children->tangled - BEFORE_TANGLE : 0, rest;
    if (!untangle_from(children, base, min_width, scratch, &rest, &status))
        untangle_from(children, base = 0, min_width, scratch, &rest, &status);
    return status ? status : put_back(children, pool, base, rest, scratch);
}

/* --- the list of a side -------------------------------------------------------------------------------------------------- */

/* Part [from, to) of the list and part [first, last) of the newer windows: those that overlap. Where there are none, all the newer ones go to
 * `from` and first = last = their count. */
struct overlap {
    uint32_t from, to, first, last;
};

/* Ends that only touch are cut to meet exactly. */
static struct overlap find_overlap(const struct gd__windows *list, uint32_t count, const struct gd__windows *newer,
                                   uint32_t newer_count, double min_width)
{
    double begin = newer->b0[0], end = newer->b1[newer_count - 1];
    if (begin >= list->b1[count - 1] - min_width) {
        if (begin < list->b1[count - 1]) newer->b0[0] = list->b1[count - 1];
        return (struct overlap){count, count, newer_count, newer_count};
    }
    if (end <= list->b0[0] + min_width) {
        if (end > list->b0[0]) newer->b1[newer_count - 1] = list->b0[0];
        return (struct overlap){0, 0, newer_count, newer_count};
    }
    struct overlap o = {0, count, 0, newer_count};
    while (o.from < count && list->b1[o.from] <= begin) o.from++;
    while (o.to > o.from && list->b0[o.to - 1] >= end) o.to--;
    if (o.to == o.from) return (struct overlap){o.from, o.from, newer_count, newer_count};
    while (o.first < newer_count && newer->b1[o.first] <= list->b0[o.from]) o.first++;
    while (o.last > o.first && newer->b0[o.last - 1] >= list->b1[o.to - 1]) o.last--;
    return o;
}

/* The windows that take the place of list [from, to): newer [0, first), merged ones, newer [last, count). */
struct insertion {
    const struct gd__windows *newer;
    const struct gd__stack *merged;
    struct overlap at;
    uint32_t count;     /* of newer */
    uint32_t skip, end; /* newer [skip, first) and [last, end): what is not joined to a neighbour */
};

/* Lengthens the neighbours of an insertion instead of inserting windows that see the same source. */
static void join_neighbours(const struct gd__windows *list, uint32_t count, struct insertion *in, double min_width)
{
    if (in->at.from > 0 && (in->at.first > 0 || !in->merged)) {
        struct gd__window before = gd__windows_get(list, in->at.from - 1), first = gd__windows_get(in->newer, 0);
        if (joins(&before, &first, min_width)) {
            list->b1[in->at.from - 1] = first.b1;
            in->skip = 1;
        }
    }
    if (in->at.to < count && (in->at.last < in->count || !in->merged) && in->count > in->skip) {
        struct gd__window behind = gd__windows_get(list, in->at.to), last = gd__windows_get(in->newer, in->count - 1);
        if (joins(&last, &behind, min_width)) {
            list->b0[in->at.to] = last.b0;
            in->end = in->count - 1;
        }
    }
    if (in->at.first > in->end) in->at.first = in->end;
}

/* Rebuilds the list around an insertion. Copies write whole groups, so each part is written after what is before it. */
static enum gd_status splice(struct gd__list *list, struct gd__pool *pool, const struct insertion *in,
                             struct gd__window_builder *scratch)
{
    uint32_t tail = list->count - in->at.to, before = in->at.first > in->skip ? in->at.first - in->skip : 0,
             behind = in->end > in->at.last ? in->end - in->at.last : 0, merged = in->merged ? in->merged->count : 0;
    uint32_t count = in->at.from + before + merged + behind + tail, at = in->at.from;
    enum gd_status status = tail ? gd__window_builder_reserve(scratch, tail) : GD_OK;
    struct gd__windows windows = gd__list_windows(list);
    if (!status && tail) gd__windows_copy(&scratch->at, 0, &windows, in->at.to, tail);
    if (!status && count + GD__WINDOWS_GROUP > gd__list_capacity(list))
        status = move_to_larger(&list->block, &list->size_class, pool, count + GD__WINDOWS_GROUP, in->at.from);
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

/* Merges what overlaps, into scratch->stack[2]. */
static enum gd_status merge_overlap(const struct gd__windows *list, const struct gd__windows *newer, struct overlap o,
                                    double min_width, struct gd__scratch *scratch)
{
    struct gd__stack *existing = &scratch->stack[0], *challengers = &scratch->stack[1], *merged = &scratch->stack[2];
    enum gd_status status = gd__stack_reserve(existing, o.to - o.from + 1);
    if (!status) status = gd__stack_reserve(challengers, o.last - o.first + 1);
    if (!status) status = gd__stack_reserve(merged, gd__merged_bound(o.to - o.from, o.last - o.first));
    if (status) return status;
    existing->count = challengers->count = merged->count = 0;
    gd__stack_load(existing, list, o.from, o.to);
    gd__stack_load(challengers, newer, o.first, o.last);
    gd__merge(existing->windows, existing->count, challengers->windows, challengers->count, min_width, merged);
    return GD_OK;
}

enum gd_status gd__list_insert(struct gd__list *list, struct gd__pool *pool, struct gd__children *newer,
                               double min_width, struct gd__scratch *scratch)
{
    if (list->count == 0) { /* such a list has no block */
        list->block = newer->block;
        list->size_class = newer->size_class;
        list->count = newer->count;
        newer->block = NULL;
        return GD_OK;
    }
    struct insertion in = {.newer = &newer->at, .count = newer->count, .end = newer->count};
    struct gd__windows windows = gd__list_windows(list);
    in.at = find_overlap(&windows, list->count, &newer->at, newer->count, min_width);
    if (in.at.to > in.at.from) {
        enum gd_status status = merge_overlap(&windows, &newer->at, in.at, min_width, scratch);
        if (status) return status;
        in.merged = &scratch->stack[2];
    }
    if (!scratch->apart) join_neighbours(&windows, list->count, &in, min_width);
    return splice(list, pool, &in, &scratch->tail);
}
