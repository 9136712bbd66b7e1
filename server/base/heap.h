/* Heap: nodes by key, the lowest first. Nodes stand inside the objects that they order; the heap
 * holds pointers. Not thread-safe. */
#ifndef SERVER_BASE_HEAP_H
#define SERVER_BASE_HEAP_H

#include <stdbool.h>
#include <stddef.h>

struct server_heap_node {
    double key;
    size_t index; /* the heap's own */
};

struct server_heap {                 /* all zero: empty */
    struct server_heap_node **nodes; /* the lowest is nodes[0] */
    size_t size, capacity;
};

/* Makes room for one more node; false without memory. */
bool server_heap_reserve(struct server_heap *heap);

/* Needs room. Inserting, removing and raising take O(log n). */
void server_heap_insert(struct server_heap *heap, struct server_heap_node *node);
void server_heap_remove(struct server_heap *heap, struct server_heap_node *node);

/* Gives a node of the heap a key that is no lower than its present one. */
void server_heap_raise(struct server_heap *heap, struct server_heap_node *node, double key);

void server_heap_free(struct server_heap *heap); /* the pointers, not the nodes */

#endif
