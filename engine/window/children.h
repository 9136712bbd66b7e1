/* Children: windows that are on their way to a side, as they were cast; and the blocks, of a pool,
 * that they and lists lie in. */
#ifndef GD_WINDOW_CHILDREN_H
#define GD_WINDOW_CHILDREN_H

#include "base/pool.h"
#include "window/stack.h"

/* Scratch of a propagation, shared by all lists. */
struct gd__scratch {
    struct gd__stack stack[3];
    struct gd__window_builder tail;
    bool apart; /* windows of one source are not joined (struct gd__methods) */
};

void gd__scratch_destroy(struct gd__scratch *scratch);

/* of the pool of blocks */
#define GD__LIST_POOL_ITEM ((size_t)GD__WINDOWS_GROUP * GD__WINDOWS_BYTES)

/* Takes the place of a block by one of the class that holds that many windows; the first `kept` are
 * copied, and the old one, NULL at first, is released. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__block_enlarge(void **block, uint8_t *size_class,
                                             struct gd__pool *pool, uint32_t windows,
                                             uint32_t kept);

/* From window `tangled` on they overlap in ways that need gd__untangle; before it they are sorted
 * and disjoint. All zero is empty. */
struct gd__children {
    void *block; /* NULL: none */
    struct gd__windows at;
    uint32_t count;
    /* the first and the last such window; GD_NONE and 0: not at all */
    uint32_t tangled, tangled_last;
    uint8_t size_class;
};

/* Room for that many windows and a group behind them, of which the first `kept` stay. GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__children_grow(struct gd__children *children, struct gd__pool *pool,
                                             uint32_t count, uint32_t kept);

/* A block of such a size, for children that have none. */
GD_MUST_USE static inline enum gd_status gd__children_open(struct gd__children *children,
                                                           struct gd__pool *pool, uint32_t count)
{
    uint32_t groups = (count + 2 * GD__WINDOWS_GROUP - 1) / GD__WINDOWS_GROUP,
             size_class = gd__pool_class(groups);
    children->block = gd__pool_take(pool, size_class);
    if (!children->block) return pool->status;
    children->size_class = (uint8_t)size_class;
    children->at = gd__windows_at(children->block, GD__WINDOWS_GROUP * gd__pool_items(size_class));
    return GD_OK;
}

/* Gives the block back. */
static inline void gd__children_close(struct gd__children *children, struct gd__pool *pool)
{
    gd__pool_release(pool, children->block, children->size_class);
    children->block = NULL;
}

/* Sorts out a list that was built as it came: the windows from `tangled` on are pushed behind the
 * others in turn. GD_NO_MEMORY, GD_BUDGET. O(n) but for rare windows whose place is far back. */
GD_MUST_USE enum gd_status gd__untangle(struct gd__children *children, struct gd__pool *pool,
                                        double min_width, struct gd__scratch *scratch);

#endif
