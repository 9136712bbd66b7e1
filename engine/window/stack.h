/* Stack: a sorted list of whole windows under construction, on the heap, reused.
 *
 * Windows in flight lie in arrays (window/windows.h). What of them has to be merged or sorted out
 * one by one is taken to a stack and put back. */
#ifndef GD_WINDOW_STACK_H
#define GD_WINDOW_STACK_H

#include "window/windows.h"

struct gd__stack {
    struct gd__window *windows;
    uint32_t count, capacity;
};

GD_MUST_USE enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity);
void gd__stack_destroy(struct gd__stack *stack);

/* Appends windows [first, end) of the arrays; there is room. */
void gd__stack_load(struct gd__stack *stack, const struct gd__windows *windows, uint32_t first,
                    uint32_t end);

/* Most windows that a merge of so many can give: each overlap is cut into three pieces at the
 * most. */
static inline uint32_t gd__merged_bound(uint32_t a, uint32_t b)
{
    return 4 * (a + b) + 4;
}

/* Merges sorted `newer` into sorted `existing`, which wins ties, and appends the result to `out`,
 * which has room for gd__merged_bound. Pieces of at most `min_width` are dropped. O(a + b). */
void gd__merge(const struct gd__window *existing, uint32_t existing_count,
               const struct gd__window *newer, uint32_t newer_count, double min_width,
               struct gd__stack *out);

/* Pushes a window whose place is at or near the end of the list: joins it to the last one if both
 * see the same source, contests what it overlaps. Amortised O(1); `scratch` is used where the
 * window's place is farther back. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__stack_push(struct gd__stack *list, const struct gd__window *window,
                                          double min_width, struct gd__stack *scratch);

#endif
