/* List: the windows that wait on one side of an edge, sorted by b0, their intervals disjoint.
 *
 * Windows in flight lie in arrays (wedge/windows.h). Where lists have to be merged, contested or untangled, that part of them is taken to a
 * stack of whole windows and put back. */
#ifndef GD_WEDGE_LIST_H
#define GD_WEDGE_LIST_H

#include "base/pool.h"
#include "wedge/windows.h"

/* A sorted list under construction, on the heap, reused. */
struct gd__stack {
    struct gd__window *windows;
    uint32_t count, capacity;
};

GD_MUST_USE enum gd_status gd__stack_reserve(struct gd__stack *stack, uint32_t capacity);
void gd__stack_destroy(struct gd__stack *stack);

/* Appends windows [first, end) of the arrays; there is room. */
void gd__stack_load(struct gd__stack *stack, const struct gd__windows *windows, uint32_t first, uint32_t end);

/* Scratch of a propagation, shared by all lists. */
struct gd__scratch {
    struct gd__stack stack[3];
    struct gd__window_builder tail;
    bool apart; /* windows of one source are not joined (struct gd__methods) */
};

void gd__scratch_destroy(struct gd__scratch *scratch);

/* The list of a side, in a block of a pool whose items are groups. */
struct gd__list {
    void *block; /* NULL: empty */
    uint32_t count;
    uint32_t bucket; /* of the queue, in which the side waits; GD_NONE: in none */
    uint32_t falls;  /* struct gd__wavefront's, when the oldest of the windows came */
    uint16_t visits; /* how often it was propagated, saturating */
    uint8_t size_class;
    bool touched; /* is not clean, and is on the workspace's list of such */
};

#define GD__LIST_POOL_ITEM ((size_t)GD__WINDOWS_GROUP * GD__WINDOWS_BYTES)

static inline uint32_t gd__list_capacity(const struct gd__list *list)
{
    return GD__WINDOWS_GROUP * gd__pool_items(list->size_class);
}

static inline struct gd__windows gd__list_windows(const struct gd__list *list)
{
    return gd__windows_at(list->block, gd__list_capacity(list));
}

/* A list that is on its way to a side. From window `tangled` on they overlap in ways that need gd__untangle; before it they are sorted and
 * disjoint. All zero is empty. */
struct gd__children {
    void *block; /* of the same pool; NULL: none */
    struct gd__windows at;
    uint32_t count;
    uint32_t tangled, tangled_last; /* the first and the last such window; GD_NONE and 0: not at all */
    uint8_t size_class;
};

/* Room for that many windows and a group behind them; what was in it is lost. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__children_reserve(struct gd__children *children, struct gd__pool *pool, uint32_t count);

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

/* Sorts out a list that was built as it came: the windows from `tangled` on are pushed behind the others in turn. GD_NO_MEMORY, GD_BUDGET. O(n) but
 * for rare windows whose place is far back. */
GD_MUST_USE enum gd_status gd__untangle(struct gd__children *children, struct gd__pool *pool, double min_width,
                                        struct gd__scratch *scratch);

/* Puts sorted windows, at least one, into the list; they are used up, and their block with them where the list was empty. Ties stay with what is
 * there. GD_NO_MEMORY, GD_BUDGET. Contests only what overlaps. */
GD_MUST_USE enum gd_status gd__list_insert(struct gd__list *list, struct gd__pool *pool, struct gd__children *newer,
                                           double min_width, struct gd__scratch *scratch);

#endif
