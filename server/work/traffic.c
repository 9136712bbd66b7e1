/* See traffic.h. */
#include "server/work/traffic.h"

#include <stdatomic.h>

#define SLOT_NS    UINT64_C(100000)
#define LOOK_SLOTS 100 /* at least, between two measurements */

static _Atomic uint64_t marked_slot; /* the latest */
static atomic_uint marks;            /* slots so far that were marked; wraps around */

void server_traffic_note(uint64_t now_ns)
{
    uint64_t slot = now_ns / SLOT_NS,
             before = atomic_load_explicit(&marked_slot, memory_order_relaxed);
    if (slot > before &&
        atomic_compare_exchange_strong_explicit(&marked_slot, &before, slot, memory_order_relaxed,
                                                memory_order_relaxed))
        atomic_fetch_add_explicit(&marks, 1, memory_order_relaxed);
}

bool server_traffic_is_dense(struct server_traffic *traffic, uint64_t now_ns)
{
    uint64_t slot = now_ns / SLOT_NS, passed = slot - traffic->looked_slot;
    if (passed < LOOK_SLOTS) return traffic->is_dense;
    uint32_t marked = atomic_load_explicit(&marks, memory_order_relaxed);
    traffic->is_dense = marked - traffic->looked_marks > passed / 2;
    traffic->looked_marks = marked;
    traffic->looked_slot = slot;
    return traffic->is_dense;
}
