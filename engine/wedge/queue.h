/* Queue: circular buckets with decrease-key over small integers (sides and vertices), in order of distance up to a bucket's width.
 *
 * Order within a bucket is first in, first out, and a key beyond the ring waits in its last bucket: propagation corrects itself, so order
 * costs time, never exactness, and first-in-first-out keeps a bucket that holds a whole component polynomial. One owner, one thread. */
#ifndef GD_WEDGE_QUEUE_H
#define GD_WEDGE_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/status.h"

#define GD__QUEUE_BUCKETS 4096 /* a power of two */

struct gd__queue_node {
    uint32_t next, previous; /* within its bucket, GD_NONE ends */
    int64_t bucket;          /* absolute number; -1: not queued */
};

struct gd__queue {
    struct gd__queue_node *nodes;
    uint32_t head[GD__QUEUE_BUCKETS], tail[GD__QUEUE_BUCKETS];
    int64_t current; /* no node waits in a lower bucket */
    uint64_t size;
    double buckets_per_length;
};

/* For node numbers < node_count and buckets of that width > 0. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__queue_init(struct gd__queue *queue, uint32_t node_count, double bucket_width);
void gd__queue_destroy(struct gd__queue *queue);

/* Queues the node, or moves it forward if it waits with a larger key; a smaller key it has already stays. O(1). */
void gd__queue_push(struct gd__queue *queue, uint32_t node, double key);

/* Takes the first node; GD_NONE when empty. */
uint32_t gd__queue_pop(struct gd__queue *queue);

/* The node that a pop would take if it waits in the current bucket, else GD_NONE: a hint for prefetching. */
static inline uint32_t gd__queue_peek(const struct gd__queue *queue)
{
    return queue->head[queue->current & (GD__QUEUE_BUCKETS - 1)];
}

#endif
