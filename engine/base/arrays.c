#include "base/arrays.h"

#include <stdalign.h>
#include <stddef.h>
#include <stdlib.h>

#include "base/array.h"

struct gd__arrays_block {
    struct gd__arrays_block *next, *previous;
    alignas(max_align_t) char array[];
};

static void arrays_link(struct gd__arrays *arrays, struct gd__arrays_block *block)
{
    block->next = arrays->newest;
    block->previous = NULL;
    if (block->next) block->next->previous = block;
    arrays->newest = block;
}

static void arrays_unlink(struct gd__arrays *arrays, struct gd__arrays_block *block)
{
    if (block->next) block->next->previous = block->previous;
    if (block->previous)
        block->previous->next = block->next;
    else
        arrays->newest = block->next;
}

static void *arrays_add(struct gd__arrays *arrays, size_t count, size_t size, bool is_zeroed)
{
    const size_t most = SIZE_MAX - sizeof(struct gd__arrays_block);
    if (arrays->status) return NULL;
    size_t bytes = size && count > most / size ? most : count * size;
    arrays->status = gd__budget_take(&arrays->budget, bytes);
    if (arrays->status) return NULL;
    struct gd__arrays_block *block =
        is_zeroed ? calloc(1, sizeof *block + bytes) : malloc(sizeof *block + bytes);
    if (!block) {
        arrays->status = GD_NO_MEMORY;
        return NULL;
    }
    arrays_link(arrays, block);
    return block->array;
}

void *gd__arrays_take(struct gd__arrays *arrays, size_t count, size_t size)
{
    return arrays_add(arrays, count, size, false);
}

void *gd__arrays_zeroed(struct gd__arrays *arrays, size_t count, size_t size)
{
    return arrays_add(arrays, count, size, true);
}

enum gd_status gd__arrays_extend(struct gd__arrays *arrays, void *array, uint32_t *capacity,
                                 uint64_t count, size_t size)
{
    struct gd__arrays_block *old = NULL;
    char *items;
    memcpy(&items, array, sizeof items);
    if (count <= *capacity && items) return GD_OK;
    if (count > UINT32_MAX) return GD_TOO_LARGE;
    uint32_t larger = gd__array_capacity(*capacity, (uint32_t)count);
    enum gd_status status =
        gd_control_afford(arrays->budget.control, arrays->budget.held + larger * size);
    if (status) return status;
    if (items) old = (void *)(items - offsetof(struct gd__arrays_block, array));
    if (old) arrays_unlink(arrays, old);
    struct gd__arrays_block *block = realloc(old, sizeof *block + larger * size);
    if (block || old) arrays_link(arrays, block ? block : old);
    if (!block) return GD_NO_MEMORY;
    arrays->budget.held += (larger - *capacity) * size;
    *capacity = larger;
    items = block->array;
    memcpy(array, &items, sizeof items);
    return GD_OK;
}

void gd__arrays_free(struct gd__arrays *arrays)
{
    for (struct gd__arrays_block *block = arrays->newest, *next; block; block = next) {
        next = block->next;
        free(block);
    }
    arrays->newest = NULL;
    arrays->budget.held = 0;
}
