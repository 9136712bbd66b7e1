/* Weld: merges equal positions into one vertex, in order of first appearance. Equal means ==, so -0
 * equals 0. */
#pragma once

#include "io/builder.h"

struct gd__weld {
    struct gd__builder *builder; /* borrowed; contains the positions */
    /* open addressing: vertex or GD_NONE; at most half of the slots are used */
    uint32_t *slots;
    size_t slot_count; /* a power of two, or 0 */
    uint64_t secret[2];
};

struct gd__weld gd__weld_begin(struct gd__builder *builder);
void gd__weld_free(struct gd__weld *weld);

/* Returns the vertex at `xyz`. Adds it to the builder if it is new. Expected O(1), amortised.
 * Errors: those of gd__builder_add_position. */
GD_MUST_USE enum gd_status gd__weld_vertex(struct gd__weld *weld, const double xyz[3],
                                           const char *at, uint32_t *vertex);
