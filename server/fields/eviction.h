/* Eviction: the order in which things that can be rebuilt go when memory is short.
 *
 * GreedyDual-Size-Frequency (Cherkasova, "Improving WWW proxies performance with
 * GreedyDual-Size-Frequency caching policy", 1998): priority = age + cost x uses / bytes, where age
 * is the priority of the last evicted thing. Priorities only grow: the heap is corrected when its
 * first is asked for. A node is a member of the thing that it orders. Not thread-safe. */
#ifndef SERVER_FIELDS_EVICTION_H
#define SERVER_FIELDS_EVICTION_H

#include <stdint.h>

#include "server/base/heap.h"

struct server_evictable {
    struct server_heap_node node; /* first; its key is an earlier priority */
    double priority;              /* now */
    double cost;                  /* of a rebuild, nanoseconds */
    size_t bytes;
    uint64_t uses;
};

struct server_eviction { /* all zero is empty; freed by server_heap_free(&order) */
    struct server_heap order;
    double age;
};

static inline void server_eviction_update(const struct server_eviction *eviction,
                                          struct server_evictable *evictable)
{
    evictable->priority =
        eviction->age + evictable->cost * (double)evictable->uses / (double)evictable->bytes;
}

/* Room was reserved in `order`; cost, bytes and uses are set. O(log n). */
static inline void server_eviction_insert(struct server_eviction *eviction,
                                          struct server_evictable *evictable)
{
    server_eviction_update(eviction, evictable);
    evictable->node.key = evictable->priority;
    server_heap_insert(&eviction->order, &evictable->node);
}

/* Counts a use of a thing, in the order or not. O(1). */
static inline void server_eviction_use(const struct server_eviction *eviction,
                                       struct server_evictable *evictable)
{
    evictable->uses++;
    server_eviction_update(eviction, evictable);
}

/* The next thing to evict, or NULL. O(log n). */
static inline struct server_evictable *server_eviction_first(struct server_eviction *eviction)
{
    while (eviction->order.size) {
        struct server_evictable *first = (struct server_evictable *)eviction->order.nodes[0];
        if (first->node.key >= first->priority) return first;
        server_heap_raise(&eviction->order, &first->node, first->priority);
    }
    return NULL;
}

/* Removes a thing for want of memory; server_heap_remove does for another reason. O(log n). */
static inline void server_eviction_evict(struct server_eviction *eviction,
                                         struct server_evictable *evictable)
{
    eviction->age = evictable->priority;
    server_heap_remove(&eviction->order, &evictable->node);
}

#endif
