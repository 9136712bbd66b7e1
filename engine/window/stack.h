/* Stack: a sorted list of windows under construction, as an array of structs. Its memory is reused.
 * The lists of a propagation are structures of arrays instead (window/windows.h). If windows must
 * be merged or sorted one by one, they are copied to a stack and back. */
#pragma once

#include "window/windows.h"

struct gd__stack {
    struct gd__window *windows;
    uint32_t count, capacity;
};

GD_MUST_USE enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity);
void gd__stack_destroy(struct gd__stack *stack);

/* Appends windows [first, end) of the arrays. The stack must have room. */
void gd__stack_load(struct gd__stack *stack, const struct gd__windows *windows, uint32_t first,
                    uint32_t end);

/* Appends the piece [from, to] of a window if it is wider than `min_width`. The stack must have
 * room. Sets the members one by one, because copying a struct that was just written would stall the
 * processor. */
static inline void gd__stack_put(struct gd__stack *stack, const struct gd__window *w, double from,
                                 double to, double min_width)
{
    if (to - from <= min_width) return;
    struct gd__window *place = &stack->windows[stack->count++];
    place->b0 = from;
    place->b1 = to;
    place->x = w->x;
    place->y = w->y;
    place->sigma = w->sigma;
    place->source = w->source;
    place->tags = w->tags;
}

/* Returns an upper bound on the number of windows after a merge of a and b windows. Each overlap is
 * cut into at most three pieces. */
static inline uint32_t gd__merged_bound(uint32_t a, uint32_t b)
{
    return 4 * (a + b) + 4;
}

/* Merges the sorted windows `newer` and `existing`; `existing` wins ties. Appends the result to
 * `out`, which must have room for all pieces; gd__merged_bound windows are enough. Drops pieces of
 * at most `min_width`. O(a + b). */
void gd__merge(const struct gd__window *existing, uint32_t existing_count,
               const struct gd__window *newer, uint32_t newer_count, double min_width,
               struct gd__stack *out);

/* Pushes a window that belongs at or near the end of the list. If the last window has the same
 * source, joins the two. Otherwise contests their overlap. Amortised O(1). `scratch` is used if the
 * window belongs farther back. Errors: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__stack_push(struct gd__stack *list, const struct gd__window *window,
                                          double min_width, struct gd__stack *scratch);
