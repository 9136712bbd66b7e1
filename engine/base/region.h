/* Region: an array of bytes that grows in place, up to 32 GB, for results of unknown size. Closing
 * the region returns its unused memory.
 *
 * A region reserves address space for `most` bytes and extends it if necessary. The system provides
 * memory when it is first accessed, on huge pages if possible. So growing costs only page faults.
 * Memory of released regions is reused. One owner, one thread. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/budget.h"

#define GD__REGION_MOST ((size_t)32 << 30)

struct gd__region {
    char *base;     /* 64-byte aligned; NULL if not open */
    size_t used;    /* bytes in use; the owner sets it */
    size_t granted; /* bytes charged to the budget */
    /* Bytes that this or an earlier owner has used. The system has already provided memory for
       them. */
    size_t touched;
    struct gd__budget *budget; /* may be NULL */
    size_t reserved;
};

/* Opens a region. The struct must be all zero, or a region that was open before; the memory of that
 * region is reused. Error: GD_NO_MEMORY (not even a few megabytes of address space are
 * available). */
GD_MUST_USE enum gd_status gd__region_open(struct gd__region *region, size_t most,
                                           struct gd__budget *budget);

/* Makes room for `bytes` behind the bytes in use. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__region_reserve(struct gd__region *region, size_t bytes);

/* The array of a closed region. */
struct gd__kept {
    char *base;   /* NULL means that the region was empty */
    size_t bytes; /* bytes backed by memory */
    size_t reserved;
};

/* Closes the region and returns base[0, used). The caller frees it by gd__region_release, on any
 * thread. */
struct gd__kept gd__region_close(struct gd__region *region);
void gd__region_release(const struct gd__kept *kept);

/* Frees the region and its array. */
void gd__region_destroy(struct gd__region *region);

/* Sets the limit on the bytes of released memory that are kept for later regions, 0 at first.
 * Returns memory beyond the limit to the system at once. Thread-safe. */
void gd__region_keep_spare(size_t bytes);
size_t gd__region_spare(void);

/* Prepares memory for a later region: as many bytes as the last closed region used. Accesses them,
 * so that the system provides the memory now. Keeps it as spare memory. Does nothing and returns
 * false if no region was closed yet, if the limit would be exceeded, or if there are eight spares
 * already. Thread-safe. */
bool gd__region_prepare(void);
