/* Union-find over indices. The lowest member of a set represents it. */
#pragma once

#include <stdint.h>

/* Returns the representative of i. parent[i] <= i, and a root is its own parent. Shortens the path
 * to the root by path halving. */
static inline uint32_t gd__union_find_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void gd__union_find_join(uint32_t *parent, uint32_t i, uint32_t j)
{
    i = gd__union_find_root(parent, i);
    j = gd__union_find_root(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

static inline void gd__union_find_init(uint32_t *parent, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) parent[i] = i;
}
