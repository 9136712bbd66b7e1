/* An isoline from the inside: where it crosses edges, and its chains of arcs across faces.
 *
 * DESIGN
 * - The isoline bounds the points below the level, which lie to its left. A vertex is below or not,
 *   by its distance alone; so is a point of an edge, and both faces of an edge see the same
 *   crossings. Around a face there are as many crossings by which lines come in as go out: topology
 *   can't be lost, however rounding falls.
 * - Inside a face the line is made of arcs, each the part of one source's circle, or of a segment's
 *   line, that no other source is nearer to (circle.h). Ends of arcs and crossings are matched by
 *   place, nearest first: so each arc goes on in another one or at a crossing, and what is left
 *   over closes on itself.
 * - Inside unit; places and angles in the face's frame (frame.h). */
#ifndef GD_FIELD_ISOLINE_PARTS_H
#define GD_FIELD_ISOLINE_PARTS_H

#include "field/circle.h"

/* The caller's control, asked whenever the steps since then, of some ten nanoseconds each, make a
 * good part of a millisecond. */
struct gd__pace {
    const struct gd_control *control;
    double fraction; /* of the call that is done */
    size_t held;     /* bytes */
    uint32_t steps;
};

enum { GD__PACE = 1 << 14 };

/* GD_BUDGET, GD_CANCELLED, GD_DEADLINE. */
GD_MUST_USE static inline enum gd_status gd__pace_check(const struct gd__pace *pace)
{
    enum gd_status status = gd_control_afford(pace->control, pace->held);
    return status ? status : gd_control_check(pace->control, pace->fraction);
}

GD_MUST_USE static inline enum gd_status gd__pace_step(struct gd__pace *pace, uint32_t steps)
{
    uint32_t left = GD__PACE - pace->steps;
    pace->steps = steps < left ? pace->steps + steps : 0;
    return steps < left ? GD_OK : gd__pace_check(pace);
}

/* Where the distance along an edge passes the level, in order of the edge; t: from the origin of
 * side 0, in [0, length]. */
struct gd__crossing {
    uint32_t edge;
    double t;
    bool from_below; /* it is below the level before t */
};

/* An arc, from its start to the start of what follows; or, of radius 0, the straight way there,
 * whose centre is its start and which has lengths in place of angles. */
struct gd__piece {
    uint32_t face;
    struct gd_point start;
    struct gd__local centre;
    /* angles from the frame's x axis; to < from only where rounding has to be bridged */
    double radius, from, to;
};

/* Pieces that follow each other through one face, from the crossing by which they come in to the
 * one by which they leave; GD_NONE, both of them: they close. No pieces: the crossings lie in one
 * place. */
struct gd__chain {
    uint32_t entry, exit;
    uint32_t first, count;
    bool has_arcs; /* not all of it is there to bridge rounding */
};

#define GD__CROSSING_BLOCK 64 /* edges */

/* What a trace has found. Crossings of edge e: see gd__edge_crossings. All zero is empty. */
struct gd__parts {
    struct gd__crossing *crossing;
    uint32_t *first_crossing; /* by edge, one more behind each block; set in crossed blocks only */
    bool *is_crossed;         /* by block of edges */
    struct gd__piece *piece;
    struct gd__chain *chain;
    uint32_t crossing_count, crossing_capacity, piece_count, piece_capacity, chain_count,
        chain_capacity;
};

/* The edge's crossings are those from `*first` on, up to `*end`. */
static inline void gd__edge_crossings(const struct gd__parts *parts, uint32_t edge, uint32_t *first,
                                      uint32_t *end)
{
    bool is_crossed = parts->is_crossed[edge / GD__CROSSING_BLOCK];
    *first = is_crossed ? parts->first_crossing[edge] : 0;
    *end = is_crossed ? parts->first_crossing[edge + 1] : 0;
}

/* Scratch of an edge and of a face, reused; all zero is empty. */
struct gd__places {
    double *at;
    uint32_t count, capacity;
};

struct gd__face_scratch {
    struct gd__sources sources;
    struct gd__spans covered, spans;
    struct gd__arc *arc;
    struct gd__end *end;
    struct gd__order *order;
    struct gd__link *link;
    uint32_t arc_count, arc_capacity, end_count, end_capacity, order_capacity, link_count,
        link_capacity;
};

void gd__face_scratch_destroy(struct gd__face_scratch *scratch);

/* isoline_edge.c: appends an edge's crossings. GD_NO_MEMORY, and what the pace says. */
GD_MUST_USE enum gd_status gd__isoline_cross_edge(const struct gd_field *field, uint32_t edge,
                                                  double level, struct gd__pace *pace,
                                                  struct gd__places *places,
                                                  struct gd__parts *parts);

/* isoline_face.c: appends the chains of a face, the crossings of whose edges are there.
 * GD_NO_MEMORY, and what the pace says. */
GD_MUST_USE enum gd_status gd__isoline_cross_face(const struct gd_field *field, uint32_t face,
                                                  double level, struct gd__pace *pace,
                                                  struct gd__face_scratch *scratch,
                                                  struct gd__parts *parts);

static inline struct gd_point gd__crossing_point(const struct gd_mesh *mesh,
                                                 const struct gd__crossing *crossing)
{
    return gd__point_of_edge(mesh, crossing->edge,
                             crossing->t / mesh->side[2 * crossing->edge].length);
}

#endif
