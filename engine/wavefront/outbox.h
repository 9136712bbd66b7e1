/* Outbox: the part of a surface that belongs to one of two wavefronts (partition/partition.h), and
 * the messages from that wavefront to the other one. */
#ifndef GD_WAVEFRONT_OUTBOX_H
#define GD_WAVEFRONT_OUTBOX_H

#include "window/predecessor.h"
#include "window/list.h"

/* Messages in the order in which they were written. */
struct gd__outbox {
    struct gd__vertex_message {
        uint32_t vertex;
        /* true if windows from this vertex with a longer distance already exist */
        bool has_emitted;
        double distance;
        struct gd__predecessor predecessor;
    } * vertices;
    uint32_t vertex_count, vertex_capacity;
    struct gd__list_message {
        /* The message has `count` windows, stored behind the windows of the message before. */
        uint32_t side, count;
    } * lists;
    uint32_t list_count, list_capacity;
    struct gd__stack windows;
};

struct gd__partition {
    /* for each side, the part of its face, 0 or 1; a boundary side has the part of its other
       side */
    const uint8_t *side_part;
    /* for each vertex, bit 1 << part is set for each part that has one of its faces */
    const uint8_t *vertex_parts;
    uint8_t part;
    bool is_common;           /* true if the other wavefront also emits the current windows */
    struct gd__outbox outbox; /* messages to the other part */
};

static inline bool gd__partition_has_side(const struct gd__partition *partition, uint32_t side)
{
    return partition->side_part[side] == partition->part;
}

static inline bool gd__partition_has_vertex(const struct gd__partition *partition, uint32_t vertex)
{
    return partition->vertex_parts[vertex] >> partition->part & 1;
}

static inline bool gd__partition_shares_vertex(const struct gd__partition *partition,
                                               uint32_t vertex)
{
    return partition->vertex_parts[vertex] == 3;
}

/* Appends a message to the other part. Errors: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__partition_send_vertex(struct gd__partition *partition,
                                                     const struct gd__vertex_message *message);
GD_MUST_USE enum gd_status gd__partition_send_windows(struct gd__partition *partition,
                                                      uint32_t side,
                                                      const struct gd__children *children);

void gd__outbox_destroy(struct gd__outbox *outbox);

#endif
