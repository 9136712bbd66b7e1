/* List: the sorted, disjoint windows that wait on one side of an edge. */
#pragma once

#include "window/children.h"

struct gd__list {
    void *block; /* NULL if empty */
    uint32_t count;
    /* the queue's bucket in which the side waits, or GD_NONE if the side does not wait */
    uint32_t bucket;
    uint32_t distance_drops; /* wavefront->distance_drops when the oldest window was inserted */
    /* number of times that windows of the side were propagated, saturating */
    uint16_t visits;
    uint8_t size_class;
    bool touched : 1; /* true if the workspace has recorded that this list must be cleaned */
    bool stores : 1;  /* true if the side's wedges are needed after the propagation */
};

static inline uint32_t gd__list_capacity(const struct gd__list *list)
{
    return GD__WINDOWS_GROUP * gd__pool_items(list->size_class);
}

static inline struct gd__windows gd__list_windows(const struct gd__list *list)
{
    return gd__block_windows(list->block, list->size_class);
}

/* Inserts sorted windows, at least one, into a list that is not empty. Takes ownership of their
 * block: the list uses the block or releases it. Where windows overlap, they are contested; the
 * list's windows win ties. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__list_add(struct gd__list *list, struct gd__pool *pool,
                                        struct gd__children *newer, double min_width,
                                        struct gd__scratch *scratch);

/* Like gd__list_add, but the list may be empty. An empty list takes over the block of the
 * windows. */
GD_MUST_USE static inline enum gd_status
gd__list_insert(struct gd__list *list, struct gd__pool *pool, struct gd__children *newer,
                double min_width, struct gd__scratch *scratch)
{
    if (list->count) return gd__list_add(list, pool, newer, min_width, scratch);
    list->block = newer->block; /* an empty list has no block */
    list->size_class = newer->size_class;
    list->count = newer->count;
    newer->block = NULL;
    return GD_OK;
}

/* Like gd__list_add, for one window. A short list is changed in place. */
GD_MUST_USE enum gd_status gd__list_add_one(struct gd__list *list, struct gd__pool *pool,
                                            const struct gd__window *window, double min_width,
                                            struct gd__scratch *scratch);

/* Puts a window into an empty list. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE static inline enum gd_status
gd__list_begin(struct gd__list *list, struct gd__pool *pool, const struct gd__window *window)
{
    /* two groups: one for the window, and one that kernels may overwrite */
    enum { GROUPS = 2, SIZE_CLASS = GROUPS - 1 };
    void *block = gd__pool_take(pool, SIZE_CLASS);
    if (!block) return pool->status;
    struct gd__windows at = gd__windows_at(block, GROUPS * GD__WINDOWS_GROUP);
    gd__windows_put(&at, 0, window);
    list->block = block;
    list->size_class = SIZE_CLASS;
    list->count = 1;
    return GD_OK;
}
