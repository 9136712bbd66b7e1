/* Queue: circular buckets of small integers (sides and vertices), in order of distance up to a
 * bucket's width.
 *
 * An entry that moves forward is entered again and its old place becomes stale: each node's owner
 * keeps the bucket it waits in, and passes over what it no longer waits for. Order within a bucket
 * is first in, first out, and a key beyond the ring waits in its last bucket: propagation corrects
 * itself, so order costs time, never exactness, and first-in-first-out keeps a bucket that holds a
 * whole component polynomial. One owner, one thread. */
#ifndef GD_WAVEFRONT_QUEUE_H
#define GD_WAVEFRONT_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/polygons.h"
#include "gd/status.h"

#define GD__QUEUE_BUCKETS 4096 /* a power of two */

struct gd__bucket {
    uint32_t *nodes;
    uint32_t head, count, capacity; /* nodes [head, count) wait */
};

struct gd__queue {
    struct gd__bucket bucket[GD__QUEUE_BUCKETS];
    /* arrays of buckets that ran empty, for the next ones: the newest first, as it is in the
       cache */
    struct gd__bucket spare[GD__QUEUE_BUCKETS];
    uint32_t spare_count;
    uint32_t current; /* number of the bucket at hand; nothing waits in a lower one */
    uint64_t size;    /* entries, stale ones too */
    double buckets_per_length;
    bool out_of_memory; /* sticky: an entry was lost */
};

/* An empty one; NULL without memory. */
struct gd__queue *gd__queue_create(void);
void gd__queue_destroy(struct gd__queue *queue); /* NULL is harmless */

/* Removes all entries; the owners of nodes that wait forget it themselves. */
void gd__queue_clear(struct gd__queue *queue);

/* The width of buckets, > 0, of an empty queue. */
void gd__queue_set_width(struct gd__queue *queue, double bucket_width);

/* Nothing much nearer than that key will be entered in the empty queue: it need not begin at zero,
 * from where its ring may not reach so far. */
void gd__queue_begin(struct gd__queue *queue, double key);

/* The bucket of a key; one that rounding has made less than zero goes to the first. */
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

/* The same where the bucket's array is full. */
void gd__queue_enter_full(struct gd__queue *queue, struct gd__bucket *bucket, uint32_t node,
                          uint32_t number, uint32_t *waiting);

/* Enters the node, which waits in bucket *waiting (GD_NONE: in none), unless that comes no later
 * than its key. Amortised O(1). */
static inline void gd__queue_push(struct gd__queue *queue, uint32_t node, double key,
                                  uint32_t *waiting)
{
    uint32_t number = gd__queue_number(queue, key), last = queue->current + GD__QUEUE_BUCKETS - 1;
    if (number < queue->current) number = queue->current;
    if (number > last) number = last;
    if (*waiting <= number) return; /* GD_NONE is larger than any */
    struct gd__bucket *bucket = &queue->bucket[number & (GD__QUEUE_BUCKETS - 1)];
    if (bucket->count < bucket->capacity)
        gd__queue_enter(queue, bucket, node, number, waiting);
    else
        gd__queue_enter_full(queue, bucket, node, number, waiting);
}

/* Takes the first entry of the buckets before number `end`; GD_NONE when they are empty. It is
 * stale unless its node waits in the current bucket. Amortised O(1). */
uint32_t gd__queue_pop(struct gd__queue *queue, uint32_t end);

/* Number of the first bucket that is not empty; GD_NONE when all are. */
uint32_t gd__queue_first(const struct gd__queue *queue);

/* The entry so many places behind the one that was popped last, if it is in the current or the next
 * bucket, else GD_NONE: a hint. */
static inline uint32_t gd__queue_peek(const struct gd__queue *queue, uint32_t places)
{
    const struct gd__bucket *b = &queue->bucket[queue->current & (GD__QUEUE_BUCKETS - 1)];
    uint32_t at = b->head + places - 1;
    if (at < b->count) return b->nodes[at];
    at -= b->count;
    b = &queue->bucket[(queue->current + 1) & (GD__QUEUE_BUCKETS - 1)];
    return b->head + at < b->count ? b->nodes[b->head + at] : GD_NONE;
}

#endif
