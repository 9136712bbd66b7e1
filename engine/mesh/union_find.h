/* Union-find over indices: each set is named by its lowest member. */
#ifndef GD_MESH_UNION_FIND_H
#define GD_MESH_UNION_FIND_H

#include <stdint.h>

/* parent[i] <= i; a root is its own parent. Halves the path on the way. */
static inline uint32_t gd__find(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void gd__unite(uint32_t *parent, uint32_t i, uint32_t j)
{
    i = gd__find(parent, i);
    j = gd__find(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

static inline void gd__each_alone(uint32_t *parent, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) parent[i] = i;
}

#endif
