/* See heap.h. A binary heap in an array: the children of i are 2i + 1 and 2i + 2. */
#include "server/base/heap.h"

#include <stdlib.h>

static void node_place(struct server_heap *heap, size_t index, struct server_heap_node *node)
{
    heap->nodes[index] = node;
    node->index = index;
}

static void node_rise(struct server_heap *heap, struct server_heap_node *node)
{
    size_t index = node->index;
    for (; index > 0; index = (index - 1) / 2) {
        struct server_heap_node *parent = heap->nodes[(index - 1) / 2];
        if (parent->key <= node->key) break;
        node_place(heap, index, parent);
    }
    node_place(heap, index, node);
}

static void node_sink(struct server_heap *heap, struct server_heap_node *node)
{
    size_t index = node->index;
    for (;;) {
        size_t child = 2 * index + 1;
        if (child >= heap->size) break;
        if (child + 1 < heap->size && heap->nodes[child + 1]->key < heap->nodes[child]->key)
            child++;
        if (heap->nodes[child]->key >= node->key) break;
        node_place(heap, index, heap->nodes[child]);
        index = child;
    }
    node_place(heap, index, node);
}

bool server_heap_reserve(struct server_heap *heap)
{
    if (heap->size < heap->capacity) return true;
    size_t capacity = heap->capacity ? 2 * heap->capacity : 64;
    struct server_heap_node **nodes = realloc(heap->nodes, capacity * sizeof *nodes);
    if (!nodes) return false;
    heap->nodes = nodes;
    heap->capacity = capacity;
    return true;
}

void server_heap_insert(struct server_heap *heap, struct server_heap_node *node)
{
    node_place(heap, heap->size++, node);
    node_rise(heap, node);
}

void server_heap_remove(struct server_heap *heap, struct server_heap_node *node)
{
    struct server_heap_node *last = heap->nodes[--heap->size];
    if (last == node) return;
    node_place(heap, node->index, last);
    node_rise(heap, last);
    node_sink(heap, last);
}

void server_heap_raise(struct server_heap *heap, struct server_heap_node *node, double key)
{
    node->key = key;
    node_sink(heap, node);
}

void server_heap_free(struct server_heap *heap)
{
    free(heap->nodes);
    *heap = (struct server_heap){0};
}
