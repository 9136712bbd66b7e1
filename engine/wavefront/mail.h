/* Mail: the part of a surface that belongs to one of two wavefronts (partition/partition.h), and what one
 * wavefront writes to the other. */
#ifndef GD_WAVEFRONT_MAIL_H
#define GD_WAVEFRONT_MAIL_H

#include "window/predecessor.h"
#include "window/list.h"

/* Letters, in the order in which they were written. */
struct gd__mail {
    struct gd__vertex_letter {
        uint32_t vertex;
        bool has_emitted; /* before: windows are on their way that began with a longer distance */
        double distance;
        struct gd__predecessor predecessor;
    } * vertices;
    uint32_t vertex_count, vertex_capacity;
    struct gd__list_letter {
        uint32_t side, count; /* so many of the windows, behind those of the letter before */
    } * lists;
    uint32_t list_count, list_capacity;
    struct gd__stack windows;
};

struct gd__partition {
    /* per side: the part of its face, 0 or 1; a boundary side has that of its other side */
    const uint8_t *side_part;
    const uint8_t *vertex_parts; /* per vertex: bits 1 << part of its faces */
    uint8_t part;
    bool is_common;       /* what is emitted now, the other part's wavefront emits too */
    struct gd__mail mail; /* to the other part */
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

/* Writes to the other part. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__partition_send_vertex(struct gd__partition *partition,
                                                     const struct gd__vertex_letter *letter);
GD_MUST_USE enum gd_status gd__partition_send_windows(struct gd__partition *partition,
                                                      uint32_t side,
                                                      const struct gd__children *children);

void gd__mail_destroy(struct gd__mail *mail);

#endif
