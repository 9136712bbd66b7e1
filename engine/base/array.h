/* Growing arrays from malloc. The capacity doubles, so appending is amortised O(1). */
#ifndef GD_BASE_ARRAY_H
#define GD_BASE_ARRAY_H

#include <stdlib.h>
#include <string.h>

#include "gd/control.h"

/* Returns the new capacity of an array that must hold `count` items, at most 2^32 - 1. */
static inline uint32_t gd__array_capacity(uint32_t capacity, uint32_t count)
{
    enum { FIRST = 64 };
    uint64_t larger = 2 * (uint64_t)capacity;
    if (larger < count) larger = count;
    if (larger < FIRST) larger = FIRST;
    return larger > UINT32_MAX ? UINT32_MAX : (uint32_t)larger;
}

/* Returns the array with room for `count` items, possibly moved, and updates *capacity. Returns
 * NULL if there is no memory; the array then stays valid. */
static inline void *gd__array_reserve(void *items, uint32_t *capacity, uint32_t count, size_t size)
{
    if (count <= *capacity && items) return items;
    uint32_t larger = gd__array_capacity(*capacity, count);
    void *moved = realloc(items, larger * size);
    if (moved) *capacity = larger;
    return moved;
}

/* As gd__array_reserve, for the array whose pointer is stored at the address `array`. The budget of
 * `control` (NULL: unlimited) must cover the old and the new array together. On failure the array
 * is unchanged. GD_NO_MEMORY, GD_BUDGET, GD_TOO_LARGE (more than 2^32 - 1 items). */
GD_MUST_USE static inline enum gd_status gd__array_extend(void *array, uint32_t *capacity,
                                                          uint64_t count, size_t size,
                                                          const struct gd_control *control)
{
    void *items;
    memcpy(&items, array, sizeof items);
    if (count <= *capacity && items) return GD_OK;
    if (count > UINT32_MAX) return GD_TOO_LARGE;
    uint64_t both = (uint64_t)gd__array_capacity(*capacity, (uint32_t)count) + *capacity;
    enum gd_status status = gd_control_afford(control, both * size);
    if (status) return status;
    items = gd__array_reserve(items, capacity, (uint32_t)count, size);
    if (!items) return GD_NO_MEMORY;
    memcpy(array, &items, sizeof items);
    return GD_OK;
}

#endif
