/* Eviction: of things that can be made again, which goes first when memory is short.
 *
 * GreedyDual-Size-Frequency (Cherkasova, "Improving WWW proxies performance with
 * GreedyDual-Size-Frequency caching policy", 1998). Priority = age + what it takes to make x uses /
 * bytes, age = priority of the last one that went, so that what was dear but is no longer used goes
 * too. Since priorities only grow, the order is brought up to date when it is asked for.
 *
 * A node stands inside what it orders. Not thread-safe. */
#ifndef SERVER_FIELDS_EVICTION_H
#define SERVER_FIELDS_EVICTION_H

#include <stdint.h>

#include "server/base/heap.h"

struct server_evictable {
    struct server_heap_node node; /* its key is an earlier priority */
    double priority;              /* now */
    double cost;                  /* to make it again, nanoseconds */
    size_t bytes;
    uint64_t uses;
};

struct server_eviction { /* all zero is empty */
    struct server_heap order;
    double age;
};

/* Makes room for one more; false without memory. */
bool server_eviction_reserve(struct server_eviction *eviction);

/* Room was reserved; cost, bytes and uses are set. O(log n), as the others are. */
void server_eviction_insert(struct server_eviction *eviction, struct server_evictable *evictable);

/* Counts a use, whether it is in the order or not. O(1). */
void server_eviction_use(const struct server_eviction *eviction,
                         struct server_evictable *evictable);

/* It is in the order: takes it out, because it goes for another reason. */
void server_eviction_remove(struct server_eviction *eviction, struct server_evictable *evictable);

/* The one to go first, or NULL when there is none. */
struct server_evictable *server_eviction_first(struct server_eviction *eviction);

/* Takes it out, because memory is short. */
void server_eviction_evict(struct server_eviction *eviction, struct server_evictable *evictable);

void server_eviction_free(struct server_eviction *eviction);

#endif
