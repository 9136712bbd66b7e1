#include "construction/edge_set.h"

#include <stdlib.h>

#include "base/hash.h"
#include "base/large.h"

/* this value is not a valid edge, because both ends would be the same vertex */
#define FREE_SLOT UINT64_MAX

enum gd_status gd__edge_set_create(uint64_t most, struct gd__pace *pace, struct gd__edge_set *out)
{
    uint64_t slots = 16;
    while (slots < most + most / 2) slots *= 2;
    uint64_t *slot = gd__large_array(slots, sizeof *slot);
    if (!slot) return GD_NO_MEMORY;
    gd__pace_fill(pace, slot, slots * sizeof *slot);
    /* the hash differs from run to run, so that nobody can make a file whose edges collide */
    *out = (struct gd__edge_set){slot, slots - 1, gd_now_ns() ^ (uintptr_t)slot};
    return pace->status;
}

void gd__edge_set_free(struct gd__edge_set *set)
{
    free(set->slot);
    set->slot = NULL;
}

static uint64_t edge_set_key_of(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Returns the slot of the edge, or the free slot where it belongs. */
static uint64_t *edge_set_find(const struct gd__edge_set *set, uint64_t key)
{
    uint64_t i = gd__hash(key + set->seed) & set->mask;
    while (set->slot[i] != FREE_SLOT && set->slot[i] != key) i = (i + 1) & set->mask;
    return &set->slot[i];
}

void gd__edge_set_insert(struct gd__edge_set *set, uint32_t a, uint32_t b)
{
    uint64_t key = edge_set_key_of(a, b);
    *edge_set_find(set, key) = key;
}

bool gd__edge_set_contains(const struct gd__edge_set *set, uint32_t a, uint32_t b)
{
    return *edge_set_find(set, edge_set_key_of(a, b)) != FREE_SLOT;
}
