/* References: counts the owners of an immutable object. The count is its only mutable member.
 * Thread-safe. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>

static inline void gd__references_add(const atomic_uint *references)
{
    atomic_fetch_add_explicit((atomic_uint *)references, 1, memory_order_relaxed);
}

/* Removes a reference. Returns true if it was the last one; the caller must then free the
 * object. */
static inline bool gd__references_drop(const atomic_uint *references)
{
    return atomic_fetch_sub_explicit((atomic_uint *)references, 1, memory_order_acq_rel) == 1;
}
