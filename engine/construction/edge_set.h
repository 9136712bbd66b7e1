/* A set of undirected edges: a hash table with open addressing and a fixed size. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/pace.h"

struct gd__edge_set {
    uint64_t *slot;
    uint64_t mask, seed;
};

/* Allocates a set for up to `most` edges. The caller frees it by gd__edge_set_free. Errors:
 * GD_NO_MEMORY, and those of the pace. */
enum gd_status gd__edge_set_create(uint64_t most, struct gd__pace *pace, struct gd__edge_set *out);
void gd__edge_set_free(struct gd__edge_set *set);

void gd__edge_set_insert(struct gd__edge_set *set, uint32_t a, uint32_t b);
bool gd__edge_set_contains(const struct gd__edge_set *set, uint32_t a, uint32_t b);
