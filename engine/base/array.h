/* Growing arrays from malloc. The capacity doubles, so appending is amortised O(1). */
#pragma once

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

/* Makes room for `count` items in the array whose pointer is stored at the address `array`. The
 * budget of `control` (NULL means no limit) must cover the old and the new array together. On
 * failure the array is unchanged. Errors: GD_NO_MEMORY, GD_BUDGET, GD_TOO_LARGE (more than 2^32 - 1
 * items). */
GD_MUST_USE static inline enum gd_status gd__array_extend(void *array, uint32_t *capacity,
                                                          uint64_t count, size_t size,
                                                          const struct gd_control *control)
{
    void *items;
    memcpy(&items, array, sizeof items);
    if (count <= *capacity && items) return GD_OK;
    if (count > UINT32_MAX) return GD_TOO_LARGE;
    uint32_t larger = gd__array_capacity(*capacity, (uint32_t)count);
    enum gd_status status = gd_control_afford(control, ((uint64_t)larger + *capacity) * size);
    if (status) return status;
    items = realloc(items, larger * size);
    if (!items) return GD_NO_MEMORY;
    *capacity = larger;
    memcpy(array, &items, sizeof items);
    return GD_OK;
}

/* Appends a copy of `item`, which must not point into the array. Extends the array if necessary.
 * Errors: those of gd__array_extend. */
GD_MUST_USE static inline enum gd_status
gd__array_append(void *array, uint32_t *count, uint32_t *capacity, const void *item, size_t size)
{
    char *items;
    enum gd_status status = gd__array_extend(array, capacity, *count + UINT64_C(1), size, NULL);
    if (status) return status;
    memcpy(&items, array, sizeof items);
    memcpy(items + size * (*count)++, item, size);
    return GD_OK;
}
