/* Heap: nodes by key, the lowest first. A node stands inside what it orders; the heap holds
 * pointers only. Not thread-safe. */
#ifndef SERVER_BASE_HEAP_H
#define SERVER_BASE_HEAP_H

#include <stdbool.h>
#include <stddef.h>

struct server_heap_node {
    double key;
    size_t index; /* the heap's own */
};

struct server_heap {
    struct server_heap_node **nodes; /* the lowest is nodes[0]; all zero is an empty heap */
    size_t size, capacity;
};

/* Makes room for one more node; false without memory. */
bool server_heap_reserve(struct server_heap *heap);

/* Room was reserved. O(log n). */
void server_heap_insert(struct server_heap *heap, struct server_heap_node *node);

/* The node is in the heap. O(log n). */
void server_heap_remove(struct server_heap *heap, struct server_heap_node *node);

/* Gives a node of the heap a key that is no lower than before. O(log n). */
void server_heap_raise(struct server_heap *heap, struct server_heap_node *node, double key);

void server_heap_free(struct server_heap *heap); /* the pointers; the nodes are their owners' */

#endif
