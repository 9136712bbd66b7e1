/* Children: windows that were cast to a side and are not yet in the side's list. A block is memory
 * from a pool. It holds the windows of children or of a list. */
#pragma once

#include "base/pool.h"
#include "window/stack.h"

/* Scratch memory of a propagation, which all lists share. */
struct gd__scratch {
    struct gd__stack stack[3];
    struct gd__window_builder tail;
    bool apart; /* true if windows of one source are not joined (struct gd__variant) */
};

void gd__scratch_destroy(struct gd__scratch *scratch);

/* Size of an item of the pool from which blocks are taken. */
#define GD__LIST_POOL_ITEM ((size_t)GD__WINDOWS_GROUP * GD__WINDOWS_BYTES)

/* Returns the arrays in a block of that size class. */
static inline struct gd__windows gd__block_windows(void *block, uint32_t size_class)
{
    return gd__windows_at(block, GD__WINDOWS_GROUP * gd__pool_items(size_class));
}

/* Replaces a block by one with room for `windows` windows. Copies the first `kept` windows and
 * releases the old block, which may be NULL. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__block_enlarge(void **block, uint8_t *size_class,
                                             struct gd__pool *pool, uint32_t windows,
                                             uint32_t kept);

/* Windows before `tangled` are sorted and disjoint. Later windows may be in any order and may
 * overlap, until gd__children_sort is called. A struct that is all zero has no windows. */
struct gd__children {
    void *block; /* NULL means no block */
    struct gd__windows at;
    uint32_t count;
    /* First and last unsorted window; GD_NONE and 0 if all are sorted. */
    uint32_t tangled, tangled_last;
    uint8_t size_class;
};

/* Makes room for `count` windows, and for one group (windows.h) behind them. Keeps the first `kept`
 * windows. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__children_grow(struct gd__children *children, struct gd__pool *pool,
                                             uint32_t count, uint32_t kept);

/* Allocates a block for children without a block. It has the same room as after
 * gd__children_grow. */
GD_MUST_USE static inline enum gd_status gd__children_open(struct gd__children *children,
                                                           struct gd__pool *pool, uint32_t count)
{
    uint32_t groups = (count + 2 * GD__WINDOWS_GROUP - 1) / GD__WINDOWS_GROUP,
             size_class = gd__pool_class(groups);
    children->block = gd__pool_take(pool, size_class);
    if (!children->block) return pool->status;
    children->size_class = (uint8_t)size_class;
    children->at = gd__block_windows(children->block, size_class);
    return GD_OK;
}

/* Releases the block. */
static inline void gd__children_close(struct gd__children *children, struct gd__pool *pool)
{
    gd__pool_release(pool, children->block, children->size_class);
    children->block = NULL;
}

/* Sorts the windows and makes them disjoint. Pushes the windows from index `tangled` on, one by
 * one. Errors: GD_NO_MEMORY, GD_BUDGET. O(n), except for rare windows that belong far back. */
GD_MUST_USE enum gd_status gd__children_sort(struct gd__children *children, struct gd__pool *pool,
                                             double min_width, struct gd__scratch *scratch);
