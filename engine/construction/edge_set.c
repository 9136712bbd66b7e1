#include "construction/edge_set.h"

#include <stdlib.h>

#include "base/large.h"

#define FREE_SLOT UINT64_MAX /* no edge: its ends would be equal */

enum gd_status gd__edge_set_create(uint64_t most, struct gd__pace *pace, struct gd__edge_set *out)
{
    uint64_t slots = 16;
    while (slots < most + most / 2) slots *= 2;
    uint64_t *slot = gd__large_array(slots, sizeof *slot);
    if (!slot) return GD_NO_MEMORY;
    gd__pace_fill(pace, slot, slots * sizeof *slot);
    /* not the same from run to run: no file can be made to collide */
    *out = (struct gd__edge_set){slot, slots - 1, gd_now_ns() ^ (uintptr_t)slot};
    return pace->status;
}

void gd__edge_set_free(struct gd__edge_set *set)
{
    free(set->slot);
    set->slot = NULL;
}

/* The finaliser of splitmix64: every bit of the key moves every bit of the result. */
static uint64_t mix(uint64_t x)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

static uint64_t key_of(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* The slot that holds the edge, or the free one where it belongs. */
static uint64_t *find(const struct gd__edge_set *set, uint64_t key)
{
    uint64_t i = mix(key + set->seed) & set->mask;
    while (set->slot[i] != FREE_SLOT && set->slot[i] != key) i = (i + 1) & set->mask;
    return &set->slot[i];
}

void gd__edge_set_insert(struct gd__edge_set *set, uint32_t a, uint32_t b)
{
    uint64_t key = key_of(a, b);
    *find(set, key) = key;
}

bool gd__edge_set_contains(const struct gd__edge_set *set, uint32_t a, uint32_t b)
{
    return *find(set, key_of(a, b)) != FREE_SLOT;
}
