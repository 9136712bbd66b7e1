#include "base/arena.h"

#include <stdalign.h>
#include <stddef.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/large.h"

struct gd__arena_block {
    struct gd__arena_block *next, *previous;
    alignas(max_align_t) char array[];
};

static void arena_link(struct gd__arena *arena, struct gd__arena_block *block)
{
    block->next = arena->newest;
    block->previous = NULL;
    if (block->next) block->next->previous = block;
    arena->newest = block;
}

static void arena_unlink(struct gd__arena *arena, struct gd__arena_block *block)
{
    if (block->next) block->next->previous = block->previous;
    if (block->previous)
        block->previous->next = block->next;
    else
        arena->newest = block->next;
}

static void *arena_add(struct gd__arena *arena, size_t count, size_t size,
                       void *(*allocate)(size_t count, size_t size))
{
    const size_t most = SIZE_MAX - sizeof(struct gd__arena_block);
    if (arena->status) return NULL;
    size_t bytes = size && count > most / size ? most : count * size;
    arena->status = gd__budget_take(&arena->budget, bytes);
    if (arena->status) return NULL;
    struct gd__arena_block *block = allocate(1, sizeof *block + bytes);
    if (!block) {
        arena->status = GD_NO_MEMORY;
        return NULL;
    }
    arena_link(arena, block);
    return block->array;
}

static void *arena_malloc(size_t count, size_t size)
{
    return malloc(count * size);
}

void *gd__arena_take(struct gd__arena *arena, size_t count, size_t size)
{
    return arena_add(arena, count, size, arena_malloc);
}

void *gd__arena_zeroed(struct gd__arena *arena, size_t count, size_t size)
{
    return arena_add(arena, count, size, calloc);
}

void *gd__arena_large(struct gd__arena *arena, size_t count, size_t size)
{
    return arena_add(arena, count, size, gd__large_array);
}

enum gd_status gd__arena_extend(struct gd__arena *arena, void *array, uint32_t *capacity,
                                uint64_t count, size_t size)
{
    struct gd__arena_block *old = NULL;
    char *items;
    memcpy(&items, array, sizeof items);
    if (count <= *capacity && items) return GD_OK;
    if (count > UINT32_MAX) return GD_TOO_LARGE;
    uint32_t larger = gd__array_capacity(*capacity, (uint32_t)count);
    enum gd_status status =
        gd_control_afford(arena->budget.control, arena->budget.held + larger * size);
    if (status) return status;
    if (items) old = (void *)(items - offsetof(struct gd__arena_block, array));
    if (old) arena_unlink(arena, old);
    struct gd__arena_block *block = realloc(old, sizeof *block + larger * size);
    if (block || old) arena_link(arena, block ? block : old);
    if (!block) return GD_NO_MEMORY;
    arena->budget.held += (larger - *capacity) * size;
    *capacity = larger;
    items = block->array;
    memcpy(array, &items, sizeof items);
    return GD_OK;
}

void gd__arena_free(struct gd__arena *arena)
{
    for (struct gd__arena_block *block = arena->newest, *next; block; block = next) {
        next = block->next;
        free(block);
    }
    arena->newest = NULL;
    arena->budget.held = 0;
}
