/* List: the windows of one side of an edge, sorted by b0, their intervals disjoint.
 *
 * Scratch lists (struct gd__stack) grow on the heap and are reused; the lists that sides own lie in a pool. */
#ifndef GD_WEDGE_LIST_H
#define GD_WEDGE_LIST_H

#include "base/pool.h"
#include "wedge/window.h"

/* A sorted list under construction. */
struct gd__stack {
    struct gd__window *windows;
    uint32_t count, capacity;
};

GD_MUST_USE enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity);
void gd__stack_destroy(struct gd__stack *stack);

struct gd__list {
    struct gd__window *windows; /* a block of the pool, or NULL */
    uint32_t count;
    uint8_t size_class;
    bool pending; /* holds windows that have not been propagated */
    bool visited; /* has been propagated from before */
};

/* Most windows that a merge of so many can give: each overlap is cut into three pieces at the most. */
static inline uint32_t gd__merged_bound(uint32_t a, uint32_t b)
{
    return 4 * (a + b) + 4;
}

/* Merges sorted `newer` into sorted `existing`, which wins ties, and appends the result to `out`, which has room for gd__merged_bound.
 * Pieces of at most `min_width` are dropped. O(a + b). */
void gd__merge(const struct gd__window *existing, uint32_t existing_count, const struct gd__window *newer,
               uint32_t newer_count, double min_width, struct gd__stack *out);

/* Pushes a window whose place is at or near the end of the list: joins it to the last one if both see the same source, contests what it
 * overlaps. Amortised O(1); `scratch` is used where the window's place is farther back. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__stack_push(struct gd__stack *list, const struct gd__window *window, double min_width,
                                          struct gd__stack *scratch);

/* Puts sorted `newer` into the side's list. `newer` is used up.
 * GD_NO_MEMORY, GD_BUDGET. Moves only what overlaps when the list has room. */
GD_MUST_USE enum gd_status gd__list_insert(struct gd__list *list, struct gd__pool *pool, struct gd__stack *newer,
                                           double min_width, struct gd__stack *scratch);

/* Replaces the side's windows by `count` others. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__list_assign(struct gd__list *list, struct gd__pool *pool,
                                           const struct gd__window *windows, uint32_t count);

#endif
