/* See eviction.h. */
#include "server/fields/eviction.h"

#include <stddef.h>

static struct server_evictable *of_node(struct server_heap_node *node)
{
    return (struct server_evictable *)((char *)node - offsetof(struct server_evictable, node));
}

static void set_priority(const struct server_eviction *eviction, struct server_evictable *evictable)
{
    evictable->priority =
        eviction->age + evictable->cost * (double)evictable->uses / (double)evictable->bytes;
}

bool server_eviction_reserve(struct server_eviction *eviction)
{
    return server_heap_reserve(&eviction->order);
}

void server_eviction_insert(struct server_eviction *eviction, struct server_evictable *evictable)
{
    set_priority(eviction, evictable);
    evictable->node.key = evictable->priority;
    server_heap_insert(&eviction->order, &evictable->node);
}

void server_eviction_use(const struct server_eviction *eviction, struct server_evictable *evictable)
{
    evictable->uses++;
    set_priority(eviction, evictable);
}

void server_eviction_remove(struct server_eviction *eviction, struct server_evictable *evictable)
{
    server_heap_remove(&eviction->order, &evictable->node);
}

struct server_evictable *server_eviction_first(struct server_eviction *eviction)
{
    while (eviction->order.size) {
        struct server_evictable *first = of_node(eviction->order.nodes[0]);
        if (first->node.key >= first->priority) return first;
        server_heap_raise(&eviction->order, &first->node, first->priority);
    }
    return NULL;
}

void server_eviction_evict(struct server_eviction *eviction, struct server_evictable *evictable)
{
    eviction->age = evictable->priority;
    server_eviction_remove(eviction, evictable);
}

void server_eviction_free(struct server_eviction *eviction)
{
    server_heap_free(&eviction->order);
}
