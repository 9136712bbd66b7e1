#include "wedge/queue.h"

#include <stdlib.h>
#include <string.h>

#include "gd/polygons.h"

#define MASK     (GD__QUEUE_BUCKETS - 1)
#define FARTHEST ((double)(INT64_C(1) << 60))

enum gd_status gd__queue_init(struct gd__queue *queue, uint32_t node_count, double bucket_width)
{
    queue->nodes = malloc(sizeof *queue->nodes * (size_t)node_count);
    if (!queue->nodes) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < node_count; i++) queue->nodes[i].bucket = -1;
    memset(queue->head, 0xff, sizeof queue->head);
    memset(queue->tail, 0xff, sizeof queue->tail);
    queue->current = 0;
    queue->size = 0;
    queue->buckets_per_length = 1 / bucket_width;
    return GD_OK;
}

void gd__queue_destroy(struct gd__queue *queue)
{
    free(queue->nodes);
    queue->nodes = NULL;
}

static void unlink_node(struct gd__queue *queue, uint32_t node)
{
    struct gd__queue_node *n = &queue->nodes[node];
    uint32_t slot = n->bucket & MASK;
    if (n->previous != GD_NONE)
        queue->nodes[n->previous].next = n->next;
    else
        queue->head[slot] = n->next;
    if (n->next != GD_NONE)
        queue->nodes[n->next].previous = n->previous;
    else
        queue->tail[slot] = n->previous;
    n->bucket = -1;
    queue->size--;
}

static void append_node(struct gd__queue *queue, uint32_t node, int64_t bucket)
{
    uint32_t slot = bucket & MASK, last = queue->tail[slot];
    queue->nodes[node] = (struct gd__queue_node){.next = GD_NONE, .previous = last, .bucket = bucket};
    if (last != GD_NONE)
        queue->nodes[last].next = node;
    else
        queue->head[slot] = node;
    queue->tail[slot] = node;
    queue->size++;
}

void gd__queue_push(struct gd__queue *queue, uint32_t node, double key)
{
    double exact = key * queue->buckets_per_length;
    int64_t bucket = exact < FARTHEST ? (int64_t)exact : (int64_t)FARTHEST;
    if (bucket < queue->current) bucket = queue->current;
    if (bucket > queue->current + MASK) bucket = queue->current + MASK;
    int64_t waiting = queue->nodes[node].bucket;
    if (waiting >= 0 && waiting <= bucket) return;
    if (waiting >= 0) unlink_node(queue, node);
    append_node(queue, node, bucket);
}

uint32_t gd__queue_pop(struct gd__queue *queue)
{
    if (!queue->size) return GD_NONE;
    while (queue->head[queue->current & MASK] == GD_NONE) queue->current++;
    uint32_t node = queue->head[queue->current & MASK];
    unlink_node(queue, node);
    return node;
}
