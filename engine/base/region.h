/* Region: one array of bytes of unknown size that grows in place, up to 32 GB; what is not used in
 * the end is given back.
 *
 * Growing costs page faults only: address space is reserved for `most` bytes and more of it sought
 * when that is not enough, memory comes with the first touch, on huge pages where it can; memory of
 * released regions is used again. One owner, one thread. */
#ifndef GD_BASE_REGION_H
#define GD_BASE_REGION_H

#include <stddef.h>

#include "base/budget.h"

#define GD__REGION_MOST ((size_t)32 << 30)

struct gd__region {
    char *base;     /* 64-byte aligned; NULL: not open */
    size_t used;    /* bytes, counted by the owner */
    size_t granted; /* bytes that the budget was asked for */
    /* bytes that were in use at some time, by earlier owners too: they are memory */
    size_t touched;
    struct gd__budget *budget; /* may be NULL */
    size_t reserved;
};

/* Begins anew; an all-zero region, or one that was used before and keeps its memory. GD_NO_MEMORY:
 * not even a few megabytes of address space are left. */
GD_MUST_USE enum gd_status gd__region_open(struct gd__region *region, size_t most,
                                           struct gd__budget *budget);

/* Room for that many bytes behind those in use. GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__region_reserve(struct gd__region *region, size_t bytes);

/* An array that outlives its region. */
struct gd__kept {
    char *base;   /* NULL: nothing was used */
    size_t bytes; /* of memory */
    size_t reserved;
};

/* Keeps base[0, used); the region is closed. gd__region_release gives it back, from any thread. */
struct gd__kept gd__region_close(struct gd__region *region);
void gd__region_release(const struct gd__kept *kept);

/* Gives everything back. */
void gd__region_destroy(struct gd__region *region);

/* Released memory is kept for later regions up to so many bytes in all, 0 at first; more than that
 * goes back to the system at once. Thread-safe. */
void gd__region_keep_spare(size_t bytes);
size_t gd__region_spare(void);

#endif
