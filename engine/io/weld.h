/* Weld: one vertex for all equal positions, in order of first appearance. Equal means ==, so -0 is
 * 0. */
#ifndef GD_IO_WELD_H
#define GD_IO_WELD_H

#include "io/builder.h"

struct gd__weld {
    struct gd__builder *builder; /* borrowed: holds the positions */
    uint32_t *slots;             /* open addressing: vertex or GD_NONE; at most half are taken */
    size_t slot_count;           /* a power of two, or 0 */
    uint64_t secret[2];
};

struct gd__weld gd__weld_begin(struct gd__builder *builder);
void gd__weld_free(struct gd__weld *weld);

/* The vertex at `xyz`, added to the builder if it is new. Expected O(1), amortised. Errors:
 * those of gd__builder_add_position. */
GD_MUST_USE enum gd_status gd__weld_vertex(struct gd__weld *weld, const double xyz[3],
                                           const char *at, uint32_t *vertex);

#endif
