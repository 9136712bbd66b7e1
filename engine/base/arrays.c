#include "base/arrays.h"

#include <stdalign.h>
#include <stddef.h>
#include <stdlib.h>

struct gd__arrays_block {
    struct gd__arrays_block *next;
    alignas(max_align_t) char array[];
};

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
    block->next = arrays->newest;
    arrays->newest = block;
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

void gd__arrays_free(struct gd__arrays *arrays)
{
    for (struct gd__arrays_block *block = arrays->newest, *next; block; block = next) {
        next = block->next;
        free(block);
    }
    arrays->newest = NULL;
    arrays->budget.held = 0;
}
