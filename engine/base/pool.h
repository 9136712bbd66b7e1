/* Pool: allocates blocks of one or more items from a few large chunks. Each block size has its own
 * free list. All memory is freed together.
 *
 * One owner, one thread. Blocks never move. A released block is reused for a request of the same
 * size. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "base/budget.h"

#define GD__POOL_CLASSES 32

struct gd__pool_chunk;

struct gd__pool {
    size_t item_size;          /* at least sizeof(void *) */
    struct gd__budget *budget; /* the budget charged for the chunks; may be NULL */
    struct gd__pool_chunk *chunks;
    char *cursor, *end; /* the unused rest of the newest chunk */
    void *free_blocks[GD__POOL_CLASSES];
    size_t bytes;          /* bytes of all chunks */
    size_t before;         /* value of `bytes` before the last restart */
    enum gd_status status; /* reason of the last failed request */
};

void gd__pool_init(struct gd__pool *pool, size_t item_size, struct gd__budget *budget);
void gd__pool_destroy(struct gd__pool *pool);

/* Releases all blocks, as if the pool were new. If the newest chunk is the only one or has the
 * largest size, keeps it and charges the budget for it. Otherwise frees all chunks; the next chunk
 * is then as large as all freed chunks together. So if the same work is repeated, the second run
 * allocates one chunk, and later runs use this chunk without page faults. The pool may be all
 * zero. */
void gd__pool_restart(struct gd__pool *pool, size_t item_size, struct gd__budget *budget);

/* Returns the number of items of a block: 1 to 16 for the first 16 classes, powers of two for the
 * others. */
static inline uint32_t gd__pool_items(uint32_t size_class)
{
    return size_class < 16 ? size_class + 1 : 16u << (size_class - 15);
}

/* Returns the smallest class whose blocks hold at least `count` items. `count` >= 1. */
static inline uint32_t gd__pool_class(uint32_t count)
{
    return count <= 16 ? count - 1 : 47 - (uint32_t)__builtin_clz((count - 1) >> 4);
}

/* Like gd__pool_take, but takes the block from a new chunk. */
void *gd__pool_take_new(struct gd__pool *pool, uint32_t size_class);

/* Takes a block of gd__pool_items(size_class) items, uninitialised. Returns NULL on an error, which
 * is in pool->status. */
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
