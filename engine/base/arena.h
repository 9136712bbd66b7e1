/* Arena: the arrays of one owner, charged to one budget and freed together.
 *
 *     struct gd__arena arena = {.budget.control = control};
 *     double *length = gd__arena_take(&arena, count, sizeof *length);
 *     bool *seen = gd__arena_zeroed(&arena, count, sizeof *seen);
 *     if (!arena.status) arena.status = work(length, seen);
 *     gd__arena_free(&arena);
 *
 * An array stays at its place unless it is extended. After a failure all further calls return NULL,
 * so the caller checks `status` once, before it uses the arrays. A struct that is all zero has no
 * arrays and no limit. One owner, one thread. */
#pragma once

#include <string.h>

#include "base/budget.h"

struct gd__arena_block;

struct gd__arena {
    struct gd__budget budget; /* charged with the arrays; an owner may charge more */
    struct gd__arena_block *newest;
    enum gd_status status; /* the first failure: GD_NO_MEMORY or GD_BUDGET */
};

/* Allocates an array, uninitialised or zeroed, aligned as by malloc. `count` may be 0. Returns NULL
 * on a failure, which is in arena->status. */
void *gd__arena_take(struct gd__arena *arena, size_t count, size_t size);
void *gd__arena_zeroed(struct gd__arena *arena, size_t count, size_t size);

/* Like gd__arena_take, but on huge pages (base/large.h). */
void *gd__arena_large(struct gd__arena *arena, size_t count, size_t size);

/* Makes room for `count` items in an array of the owner. Its pointer is stored at the address
 * `array`; NULL means a new array. The capacity doubles. The budget must cover the old and the new
 * array together. On failure the array is unchanged, and so is the status. Errors: GD_NO_MEMORY,
 * GD_BUDGET, GD_TOO_LARGE (more than 2^32 - 1 items). */
GD_MUST_USE enum gd_status gd__arena_extend(struct gd__arena *arena, void *array,
                                            uint32_t *capacity, uint64_t count, size_t size);

/* Appends a copy of `item`, which must not point into the array. Errors: those of
 * gd__arena_extend. */
GD_MUST_USE static inline enum gd_status gd__arena_append(struct gd__arena *arena, void *array,
                                                          uint32_t *count, uint32_t *capacity,
                                                          const void *item, size_t size)
{
    char *items;
    enum gd_status status =
        *count < *capacity ? GD_OK
                           : gd__arena_extend(arena, array, capacity, *count + UINT64_C(1), size);
    if (status) return status;
    memcpy(&items, array, sizeof items);
    memcpy(items + size * (*count)++, item, size);
    return GD_OK;
}

/* Frees all arrays. Keeps the status. */
void gd__arena_free(struct gd__arena *arena);
