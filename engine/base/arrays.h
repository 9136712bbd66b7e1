/* Arrays: the arrays of one owner, charged to one budget and freed together.
 *
 *     struct gd__arrays arrays = {.budget.control = control};
 *     double *length = gd__arrays_take(&arrays, count, sizeof *length);
 *     bool *seen = gd__arrays_zeroed(&arrays, count, sizeof *seen);
 *     if (!arrays.status) arrays.status = work(length, seen);
 *     gd__arrays_free(&arrays);
 *
 * Arrays do not move. After a failure all further calls return NULL, so the caller checks `status`
 * once, before it uses the arrays. A struct that is all zero has no arrays and no limit. One owner,
 * one thread. */
#ifndef GD_BASE_ARRAYS_H
#define GD_BASE_ARRAYS_H

#include "base/budget.h"

struct gd__arrays_block;

struct gd__arrays {
    struct gd__budget budget; /* charged with the arrays; an owner may charge more */
    struct gd__arrays_block *newest;
    enum gd_status status; /* the first failure: GD_NO_MEMORY or GD_BUDGET */
};

/* Allocates an array, uninitialised or zeroed, aligned as by malloc. `count` may be 0. Returns NULL
 * on a failure, which is in arrays->status. */
void *gd__arrays_take(struct gd__arrays *arrays, size_t count, size_t size);
void *gd__arrays_zeroed(struct gd__arrays *arrays, size_t count, size_t size);

/* Frees all arrays. Keeps the status. */
void gd__arrays_free(struct gd__arrays *arrays);

#endif
