/* Parts of an isoline: its crossings of edges, and its chains of arcs across faces.
 *
 * DESIGN
 * - The points below the level lie to the left of the isoline. A vertex counts as below if its
 *   stored distance is below the level. For a point of an edge the test is made once for both
 *   faces. Therefore as many lines enter a face as leave it: rounding cannot change the topology.
 * - Inside a face the line consists of arcs. An arc is a part of one source's circle, or of a
 *   segment's parallel line, where no other source is nearer (circle.h). Ends of arcs and crossings
 *   are matched by position, nearest pairs first, so that each arc continues in another arc or at a
 *   crossing. Arcs without crossings form closed loops.
 * - Normalised unit. Positions and angles are in the face's frame (face_frame.h). */
#pragma once

#include "base/arena.h"
#include "base/pace.h"
#include "field/circle.h"

/* A point where the distance along an edge passes the level. t is measured from the origin of side
 * 0, in [0, length]. Crossings are sorted along the edge. */
struct gd__crossing {
    uint32_t edge;
    double t;
    bool from_below; /* the edge is below the level before t */
};

/* An arc, from its start to the start of the next piece. Radius 0 means a straight line between
 * these two positions; `centre` is the line's start, and `from` and `to` are lengths along the
 * line. */
struct gd__isoline_piece {
    uint32_t face;
    struct gd_point start;
    struct gd__local centre;
    /* Angles are measured from the frame's x axis. to < from only if the piece bridges a gap due to
       rounding. */
    double radius, from, to;
};

/* Consecutive pieces through one face, from the crossing where the line enters to the crossing
 * where it leaves. If both crossings are GD_NONE, the line is closed. If there are no pieces, both
 * crossings are at the same position. */
struct gd__isoline_chain {
    uint32_t entry, exit;
    uint32_t first, count;
    bool has_arcs; /* false if all pieces bridge gaps due to rounding */
};

#define GD__CROSSING_BLOCK 64 /* edges */

/* All crossings and chains of an isoline. For the crossings of an edge see gd__edge_crossings. An
 * all-zero struct is empty. */
struct gd__isoline_parts {
    struct gd__arena arena;
    struct gd__crossing *crossing;
    /* for each block of edges, index of its first entry in first_crossing, or GD_NONE if the block
       has no crossings */
    uint32_t *block;
    /* for each block with crossings: the first crossing of each edge, and the end of the last */
    uint32_t *first_crossing;
    struct gd__isoline_piece *piece;
    struct gd__isoline_chain *chain;
    uint32_t first_count, first_capacity, crossing_count, crossing_capacity, piece_count,
        piece_capacity, chain_count, chain_capacity;
};

/* Returns the range [*first, *end) of an edge's crossings. */
static inline void gd__edge_crossings(const struct gd__isoline_parts *parts, uint32_t edge,
                                      uint32_t *first, uint32_t *end)
{
    uint32_t at = parts->block[edge / GD__CROSSING_BLOCK];
    bool is_crossed = at != GD_NONE;
    at += edge % GD__CROSSING_BLOCK;
    *first = is_crossed ? parts->first_crossing[at] : 0;
    *end = is_crossed ? parts->first_crossing[at + 1] : 0;
}

/* Reused scratch for an edge and for a face. An all-zero struct is empty. */
struct gd__places {
    double *at;
    uint32_t count, capacity;
};

struct gd__face_scratch {
    struct gd__sources sources;
    struct gd__arc *arc;
    struct gd__end *end;
    struct gd__order *order;
    struct gd__link *link;
    uint32_t arc_count, arc_capacity, end_count, end_capacity, order_capacity, link_count,
        link_capacity;
};

void gd__face_scratch_destroy(struct gd__face_scratch *scratch);

/* isoline_edge.c: appends the crossings of an edge. Errors: GD_NO_MEMORY, and those of the pace. */
GD_MUST_USE enum gd_status gd__isoline_cross_edge(const struct gd_field *field, uint32_t edge,
                                                  double level, struct gd__pace *pace,
                                                  struct gd__places *places,
                                                  struct gd__isoline_parts *parts);

/* isoline_face.c: appends the chains of a face. The crossings of the face's edges must exist.
 * Errors: GD_NO_MEMORY, and those of the pace. */
GD_MUST_USE enum gd_status gd__isoline_cross_face(const struct gd_field *field, uint32_t face,
                                                  double level, struct gd__pace *pace,
                                                  struct gd__face_scratch *scratch,
                                                  struct gd__isoline_parts *parts);

static inline struct gd_point gd__crossing_point(const struct gd_mesh *mesh,
                                                 const struct gd__crossing *crossing)
{
    return gd__point_of_edge(mesh, crossing->edge,
                             crossing->t / mesh->side[2 * crossing->edge].length);
}
