/* Eviction: the order in which things that can be rebuilt go when memory is short.
 *
 * GreedyDual-Size-Frequency (Cherkasova, "Improving WWW proxies performance with
 * GreedyDual-Size-Frequency caching policy", 1998): priority = age + cost x uses / bytes, where age
 * is the priority of the last evicted one. So expensive things go too when they are no longer used.
 * Priorities only grow: the heap is corrected when its first is asked for.
 *
 * A node is a member of the thing that it orders. Not thread-safe. */
#ifndef SERVER_FIELDS_EVICTION_H
#define SERVER_FIELDS_EVICTION_H

#include <stdint.h>

#include "server/base/heap.h"

struct server_evictable {
    struct server_heap_node node; /* its key is an earlier priority */
    double priority;              /* now */
    double cost;                  /* of a rebuild, nanoseconds */
    size_t bytes;
    uint64_t uses;
};

struct server_eviction { /* all zero is empty */
    struct server_heap order;
    double age;
};

/* Makes room for one more; false without memory. */
bool server_eviction_reserve(struct server_eviction *eviction);

/* Room was reserved; cost, bytes and uses are set. O(log n), as remove, first and evict. */
void server_eviction_insert(struct server_eviction *eviction, struct server_evictable *evictable);

/* Counts a use of a thing, in the order or not. O(1). */
void server_eviction_use(const struct server_eviction *eviction,
                         struct server_evictable *evictable);

/* Removes a thing for another reason than want of memory. */
void server_eviction_remove(struct server_eviction *eviction, struct server_evictable *evictable);

/* The next one to evict, or NULL. */
struct server_evictable *server_eviction_first(struct server_eviction *eviction);

/* Removes a thing for want of memory. */
void server_eviction_evict(struct server_eviction *eviction, struct server_evictable *evictable);

void server_eviction_free(struct server_eviction *eviction);

#endif
