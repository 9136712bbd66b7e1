/* Queue: circular buckets of nodes (numbers of sides and vertices). The buckets are in order of
 * distance. Within a bucket the order is first in, first out. If the key of a node decreases, the
 * node gets a second entry, and its old entry becomes stale. The owner of a node stores the bucket
 * in which the node waits, and ignores the node's entries in other buckets. A node whose key is too
 * large for the ring of buckets goes to the last bucket. The order affects the time, but never the
 * exactness, because sides and vertices are processed again when shorter paths reach them. First
 * in, first out keeps the work polynomial if a whole component is in one bucket. One owner, one
 * thread. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "gd/polygons.h"
#include "gd/status.h"

#define GD__QUEUE_BUCKETS 4096 /* a power of two */

struct gd__bucket {
    uint32_t *nodes;
    uint32_t head, count, capacity; /* nodes [head, count) are still to be popped */
};

struct gd__queue {
    struct gd__bucket bucket[GD__QUEUE_BUCKETS];
    /* arrays of emptied buckets for reuse; the newest is taken first, because it is in the cache */
    struct gd__bucket spare[GD__QUEUE_BUCKETS];
    uint32_t spare_count;
    uint32_t current; /* number of the current bucket; no node waits in a lower one */
    uint64_t size;    /* number of entries, including stale ones */
    double buckets_per_length;
    bool out_of_memory; /* sticky; true if an entry was lost for lack of memory */
};

/* Creates an empty queue. Returns NULL if there is no memory. */
struct gd__queue *gd__queue_create(void);
void gd__queue_destroy(struct gd__queue *queue); /* accepts NULL */

/* Removes all entries. The owner of a waiting node must set the node's stored bucket to GD_NONE. */
void gd__queue_clear(struct gd__queue *queue);

/* Sets the width of buckets, > 0. The queue must be empty. */
void gd__queue_set_width(struct gd__queue *queue, double bucket_width);

/* Returns the bucket number of a key. A negative key, which is due to rounding, goes to the first
 * bucket. */
static inline uint32_t gd__queue_number(const struct gd__queue *queue, double key)
{
    const double farthest = 4e9; /* below the largest bucket number */
    double exact = key * queue->buckets_per_length;
    return exact < farthest ? (uint32_t)exact : (uint32_t)farthest;
}

static inline void gd__queue_enter(struct gd__queue *queue, struct gd__bucket *bucket,
                                   uint32_t node, uint32_t number, uint32_t *waiting)
{
    *waiting = number;
    bucket->nodes[bucket->count++] = node;
    queue->size++;
}

/* Enters a node into a bucket whose array is full. */
void gd__queue_enter_full(struct gd__queue *queue, struct gd__bucket *bucket, uint32_t node,
                          uint32_t number, uint32_t *waiting);

/* Enters a node unless the node already waits in the bucket of its key or in an earlier bucket.
 * *waiting is the bucket in which the node waits, or GD_NONE if it does not wait. Amortised O(1).
 */
static inline void gd__queue_push(struct gd__queue *queue, uint32_t node, double key,
                                  uint32_t *waiting)
{
    uint32_t number = gd__queue_number(queue, key), last = queue->current + GD__QUEUE_BUCKETS - 1;
    if (number < queue->current) number = queue->current;
    if (number > last) number = last;
    /* this is false if *waiting is GD_NONE, which is larger than any bucket */
    if (*waiting <= number) return;
    struct gd__bucket *bucket = &queue->bucket[number & (GD__QUEUE_BUCKETS - 1)];
    if (bucket->count < bucket->capacity)
        gd__queue_enter(queue, bucket, node, number, waiting);
    else
        gd__queue_enter_full(queue, bucket, node, number, waiting);
}

/* Removes and returns the first entry; GD_NONE if the queue is empty. The entry is stale unless its
 * node waits in the current bucket. Amortised O(1). */
uint32_t gd__queue_pop(struct gd__queue *queue);

/* Returns the entry `places` positions behind the last popped entry, for prefetching. Returns
 * GD_NONE if this position is in neither the current nor the next bucket. */
static inline uint32_t gd__queue_peek(const struct gd__queue *queue, uint32_t places)
{
    const struct gd__bucket *b = &queue->bucket[queue->current & (GD__QUEUE_BUCKETS - 1)];
    uint32_t at = b->head + places - 1;
    if (at < b->count) return b->nodes[at];
    at -= b->count;
    b = &queue->bucket[(queue->current + 1) & (GD__QUEUE_BUCKETS - 1)];
    return b->head + at < b->count ? b->nodes[b->head + at] : GD_NONE;
}
