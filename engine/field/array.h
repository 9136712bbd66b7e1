/* Arrays that grow: by doubling, so that appending is amortised O(1). */
#ifndef GD_FIELD_ARRAY_H
#define GD_FIELD_ARRAY_H

#include <stdint.h>
#include <stdlib.h>

/* The array with room for `count` items, moved where it had to be and *capacity raised; NULL
 * without memory, and then it is as it was. */
static inline void *gd__array_reserve(void *items, uint32_t *capacity, uint32_t count, size_t size)
{
    enum { FIRST = 64 };
    if (count <= *capacity && items) return items;
    uint64_t larger = 2 * (uint64_t)*capacity;
    if (larger < count) larger = count;
    if (larger < FIRST) larger = FIRST;
    if (larger > UINT32_MAX) larger = UINT32_MAX;
    void *moved = realloc(items, larger * size);
    if (moved) *capacity = (uint32_t)larger;
    return moved;
}

#endif
