/* Seam: the line along which the mesh is cut open. Nodes divide edges into pieces. The seam
 * consists of pieces of edges and of segments of the arrangement.
 *
 * Edge e has the pieces first[e] to first[e + 1] - 1, in order from the origin of its side 0; an
 * edge without nodes is one piece. */
#pragma once

#include "base/arena.h"
#include "cut/arrangement.h"

struct gd__seam {
    const struct gd__nodes *nodes;
    uint32_t *first; /* for each edge, its first piece; one more entry at the end */
    /* nodes on edges, sorted by edge and then by parameter; the nodes of edge e begin at
       first[e] - e */
    uint32_t *edge_node;
    /* for each new node on an edge, 1 + the number of preceding nodes on that edge */
    uint32_t *place;
    uint8_t *is_cut;     /* for each piece, true if it belongs to the seam */
    uint8_t *is_cutting; /* for each segment of the arrangement, true if it belongs to the seam */
    uint32_t cuts;       /* number of pieces and segments of the seam */
};

/* Computes the seam of an arrangement, without parts on the boundary and without dead ends. A dead
 * end is a part of the seam that has a free end: an end that is not on the boundary and belongs to
 * no other part. Linear in the mesh. Errors: GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__seam_make(const struct gd__arrangement *arrangement,
                                         struct gd__arena *arena, struct gd__seam *out);

/* Returns the piece of an edge between two consecutive nodes a and b. */
uint32_t gd__seam_piece(const struct gd__seam *seam, uint32_t edge, uint32_t a, uint32_t b);
