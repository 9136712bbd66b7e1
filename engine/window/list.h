/* List: the windows that wait on one side of an edge, sorted by b0, their intervals disjoint. */
#ifndef GD_WINDOW_LIST_H
#define GD_WINDOW_LIST_H

#include "window/children.h"

struct gd__list {
    void *block; /* NULL: empty */
    uint32_t count;
    uint32_t bucket; /* of the queue, in which the side waits; GD_NONE: in none */
    uint32_t falls;  /* struct gd__wavefront's, when the oldest of the windows came */
    uint16_t visits; /* how often it was propagated, saturating */
    uint8_t size_class;
    bool touched; /* is not clean, and is on the workspace's list of such */
};

static inline uint32_t gd__list_capacity(const struct gd__list *list)
{
    return GD__WINDOWS_GROUP * gd__pool_items(list->size_class);
}

static inline struct gd__windows gd__list_windows(const struct gd__list *list)
{
    return gd__windows_at(list->block, gd__list_capacity(list));
}

/* Puts sorted windows, at least one, into a list that is not empty. Their block is used up: it
 * becomes the list's or goes back to the pool. Ties stay with what is there. GD_NO_MEMORY,
 * GD_BUDGET. Contests only what overlaps. */
GD_MUST_USE enum gd_status gd__list_add(struct gd__list *list, struct gd__pool *pool,
                                        struct gd__children *newer, double min_width,
                                        struct gd__scratch *scratch);

/* The same of any list: an empty one takes the block of the windows. */
GD_MUST_USE static inline enum gd_status
gd__list_insert(struct gd__list *list, struct gd__pool *pool, struct gd__children *newer,
                double min_width, struct gd__scratch *scratch)
{
    if (list->count) return gd__list_add(list, pool, newer, min_width, scratch);
    list->block = newer->block; /* such a list has none */
    list->size_class = newer->size_class;
    list->count = newer->count;
    newer->block = NULL;
    return GD_OK;
}

/* gd__list_add of one window: among few others it is put in their own block. */
GD_MUST_USE enum gd_status gd__list_add_one(struct gd__list *list, struct gd__pool *pool,
                                            const struct gd__window *window, double min_width,
                                            struct gd__scratch *scratch);

/* Puts a window into an empty list. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE static inline enum gd_status
gd__list_begin(struct gd__list *list, struct gd__pool *pool, const struct gd__window *window)
{
    enum { GROUPS = 2, SIZE_CLASS = GROUPS - 1 }; /* there is a group behind the last window */
    void *block = gd__pool_take(pool, SIZE_CLASS);
    if (!block) return pool->status;
    struct gd__windows at = gd__windows_at(block, GROUPS * GD__WINDOWS_GROUP);
    gd__windows_put(&at, 0, window);
    list->block = block;
    list->size_class = SIZE_CLASS;
    list->count = 1;
    return GD_OK;
}

#endif
