/* Pool: blocks of so many items from few large chunks, each size with its own free list; everything
 * is given back at once.
 *
 * One owner, one thread. Blocks are never moved. A block may be released and is then reused for the
 * same size; destroying the pool frees all. */
#ifndef GD_BASE_POOL_H
#define GD_BASE_POOL_H

#include <stddef.h>
#include <stdint.h>

#include "base/budget.h"

#define GD__POOL_CLASSES 32

struct gd__pool_chunk;

struct gd__pool {
    size_t item_size;          /* >= sizeof(void *) */
    struct gd__budget *budget; /* pays for the chunks; may be NULL */
    struct gd__pool_chunk *chunks;
    char *cursor, *end; /* the unused rest of the newest chunk */
    void *free_blocks[GD__POOL_CLASSES];
    size_t bytes;          /* of all chunks */
    size_t before;         /* what it had when it began anew */
    enum gd_status status; /* why the last request failed */
};

void gd__pool_init(struct gd__pool *pool, size_t item_size, struct gd__budget *budget);
void gd__pool_destroy(struct gd__pool *pool);

/* Takes all blocks back and begins anew as gd__pool_init does, but keeps the chunk if it is the
 * only one, or one of the largest; the budget is charged with it unasked. After several the next one
 * is as large as all of them were, so that who does the same for the third time has one chunk,
 * without page faults. An all-zero pool will do. */
void gd__pool_restart(struct gd__pool *pool, size_t item_size, struct gd__budget *budget);

/* Items of a block: 1 to 16 of them, then powers of two. */
static inline uint32_t gd__pool_items(uint32_t size_class)
{
    return size_class < 16 ? size_class + 1 : 16u << (size_class - 15);
}

/* Smallest class whose blocks hold `count` >= 1 items. */
static inline uint32_t gd__pool_class(uint32_t count)
{
    return count <= 16 ? count - 1 : 47 - (uint32_t)__builtin_clz((count - 1) >> 4);
}

/* A block of a new chunk: see gd__pool_take. */
void *gd__pool_take_new(struct gd__pool *pool, uint32_t size_class);

/* A block of gd__pool_items(size_class) items, uninitialised; NULL when out of memory or budget
 * (pool->status says which). */
static inline void *gd__pool_take(struct gd__pool *pool, uint32_t size_class)
{
    void *block = pool->free_blocks[size_class];
    if (block) {
        pool->free_blocks[size_class] = *(void **)block;
        return block;
    }
    size_t size = pool->item_size * gd__pool_items(size_class);
    if ((size_t)(pool->end - pool->cursor) < size) return gd__pool_take_new(pool, size_class);
    block = pool->cursor;
    pool->cursor += size;
    return block;
}

static inline void gd__pool_release(struct gd__pool *pool, void *block, uint32_t size_class)
{
    *(void **)block = pool->free_blocks[size_class];
    pool->free_blocks[size_class] = block;
}

#endif
