#include "wavefront/queue.h"

#include <stdlib.h>
#include <string.h>

#define MASK     (GD__QUEUE_BUCKETS - 1)
#define SMALLEST 256 /* smallest capacity of a bucket's array */

struct gd__queue *gd__queue_create(void)
{
    return calloc(1, sizeof(struct gd__queue));
}

void gd__queue_destroy(struct gd__queue *queue)
{
    if (!queue) return;
    for (uint32_t i = 0; i < GD__QUEUE_BUCKETS; i++) free(queue->bucket[i].nodes);
    for (uint32_t i = 0; i < queue->spare_count; i++) free(queue->spare[i].nodes);
    free(queue);
}

/* Keeps the array of an emptied bucket for reuse. */
static void bucket_retire(struct gd__queue *queue, struct gd__bucket *bucket)
{
    if (bucket->capacity)
        queue->spare[queue->spare_count++] =
            (struct gd__bucket){.nodes = bucket->nodes, .capacity = bucket->capacity};
    *bucket = (struct gd__bucket){0};
}

void gd__queue_clear(struct gd__queue *queue)
{
    for (uint32_t i = 0; i < GD__QUEUE_BUCKETS; i++) bucket_retire(queue, &queue->bucket[i]);
    queue->current = 0;
    queue->size = 0;
    queue->out_of_memory = false;
}

void gd__queue_set_width(struct gd__queue *queue, double bucket_width)
{
    queue->buckets_per_length = 1 / bucket_width;
}

static bool make_room(struct gd__queue *queue, struct gd__bucket *bucket)
{
    if (!bucket->capacity && queue->spare_count) {
        *bucket = queue->spare[--queue->spare_count];
        return true;
    }
    /* nodes are pushed into the bucket while it is being emptied */
    if (bucket->head > bucket->capacity / 2) {
        memmove(bucket->nodes, bucket->nodes + bucket->head,
                sizeof *bucket->nodes * (bucket->count - bucket->head));
        bucket->count -= bucket->head;
        bucket->head = 0;
        return true;
    }
    uint32_t capacity = bucket->capacity ? 2 * bucket->capacity : SMALLEST;
    uint32_t *nodes = realloc(bucket->nodes, sizeof *nodes * (size_t)capacity);
    if (!nodes) return false;
    bucket->nodes = nodes;
    bucket->capacity = capacity;
    return true;
}

void gd__queue_enter_full(struct gd__queue *queue, struct gd__bucket *bucket, uint32_t node,
                          uint32_t number, uint32_t *waiting)
{
    if (make_room(queue, bucket))
        gd__queue_enter(queue, bucket, node, number, waiting);
    else
        queue->out_of_memory = true;
}

uint32_t gd__queue_pop(struct gd__queue *queue)
{
    if (!queue->size) return GD_NONE;
    struct gd__bucket *bucket = &queue->bucket[queue->current & MASK];
    while (bucket->head == bucket->count) {
        bucket_retire(queue, bucket);
        bucket = &queue->bucket[++queue->current & MASK];
    }
    queue->size--;
    return bucket->nodes[bucket->head++];
}
