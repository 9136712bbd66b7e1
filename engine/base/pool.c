#include "base/pool.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/large.h"

#define CHUNK_FIRST ((size_t)64 << 10)
#define CHUNK_LAST  ((size_t)64 << 20)
#define BUDGET_PART 4

struct gd__pool_chunk {
    struct gd__pool_chunk *next;
    size_t size;
};

#define CHUNK_HEADER 64 /* a size that keeps blocks aligned to cache lines */

/* Takes the next blocks from this chunk. */
static void pool_adopt(struct gd__pool *pool, struct gd__pool_chunk *chunk)
{
    pool->chunks = chunk;
    pool->bytes += chunk->size;
    pool->cursor = (char *)chunk + CHUNK_HEADER;
    pool->end = (char *)chunk + chunk->size;
}

void gd__pool_init(struct gd__pool *pool, size_t item_size, struct gd__budget *budget)
{
    *pool = (struct gd__pool){.item_size = item_size, .budget = budget};
}

static void free_chunks(struct gd__pool_chunk *chunk)
{
    while (chunk) {
        struct gd__pool_chunk *next = chunk->next;
        free(chunk);
        chunk = next;
    }
}

void gd__pool_destroy(struct gd__pool *pool)
{
    free_chunks(pool->chunks);
    *pool = (struct gd__pool){0};
}

void gd__pool_restart(struct gd__pool *pool, size_t item_size, struct gd__budget *budget)
{
    struct gd__pool_chunk *kept = pool->chunks; /* the newest chunk is the largest */
    size_t before = pool->bytes;
    bool is_all = kept && !kept->next, is_largest = kept && kept->size >= CHUNK_LAST;
    if (is_all || is_largest) {
        free_chunks(kept->next);
        kept->next = NULL;
    } else {
        free_chunks(kept);
        kept = NULL;
    }
    gd__pool_init(pool, item_size, budget);
    pool->before = before;
    if (kept) pool_adopt(pool, kept);
    if (budget) budget->held += pool->bytes;
}

/* Returns the size of a chunk. Large chunks lie on huge pages, which avoids most page faults. */
static size_t chunk_size(size_t wanted, size_t need)
{
    size_t size = wanted < CHUNK_FIRST ? CHUNK_FIRST : wanted > CHUNK_LAST ? CHUNK_LAST : wanted;
    if (size < need + CHUNK_HEADER) size = need + CHUNK_HEADER;
    return size > GD__HUGE_PAGE ? (size + GD__HUGE_PAGE - 1) & ~(GD__HUGE_PAGE - 1)
                                : (size + 63) & ~(size_t)63;
}

/* Returns true if the chunk is small compared with the budget. A larger chunk might leave too
 * little for other allocations. */
static bool is_small_beside_budget(const struct gd__budget *budget, size_t bytes)
{
    size_t limit = budget && budget->control ? budget->control->budget_bytes : 0;
    return !limit || bytes <= limit / BUDGET_PART;
}

/* Adds a chunk as large as all existing chunks together, within limits. The first chunk is as large
 * as all chunks before the last restart together. */
static enum gd_status pool_grow(struct gd__pool *pool, size_t need)
{
    bool again = !pool->bytes && is_small_beside_budget(pool->budget, pool->before);
    size_t size = chunk_size(again ? pool->before : pool->bytes, need);
    enum gd_status status = gd__budget_take(pool->budget, size);
    if (status) return status;
    struct gd__pool_chunk *chunk = gd__large_array(1, size);
    if (!chunk) return GD_NO_MEMORY;
    *chunk = (struct gd__pool_chunk){.next = pool->chunks, .size = size};
    pool_adopt(pool, chunk);
    return GD_OK;
}

void *gd__pool_take_new(struct gd__pool *pool, uint32_t size_class)
{
    enum gd_status status = pool_grow(pool, pool->item_size * gd__pool_items(size_class));
    if (!status) return gd__pool_take(pool, size_class);
    pool->status = status;
    return NULL;
}
