/* Seam: where the mesh comes apart. The pieces that nodes cut edges into, and which of them and of
 * the segments in faces belong to the seam.
 *
 * Edge e has pieces first[e] to first[e + 1] - 1, from the origin of its side 0 on; one when no
 * node lies on it. */
#ifndef GD_CUT_SEAM_H
#define GD_CUT_SEAM_H

#include "cut/arrangement.h"

struct gd__seam { /* all zero: none */
    const struct gd__nodes *nodes;
    uint32_t *first; /* per edge, and one behind the last */
    /* the nodes on edges, by edge, in order of their parameters: those of e from first[e] - e on */
    uint32_t *edge_node;
    uint32_t *place;     /* per new node of an edge: 1 + how many nodes of the edge lie before it */
    uint8_t *is_cut;     /* per piece */
    uint8_t *is_cutting; /* per segment of the arrangement */
    uint32_t cuts;       /* pieces and segments that cut */
};

/* The seam of an arrangement, without what lies on the boundary, and without dead ends: parts with
 * an end that nothing of the seam goes on from and that is not on the boundary either. Linear in
 * the mesh. GD_NO_MEMORY, GD_BUDGET. On failure nothing is held. */
GD_MUST_USE enum gd_status gd__seam_make(const struct gd__arrangement *arrangement,
                                         struct gd__seam *out);
void gd__seam_free(struct gd__seam *seam); /* of one that is all zero: harmless */

/* The piece of an edge between two nodes on it that follow each other. */
uint32_t gd__seam_piece(const struct gd__seam *seam, uint32_t edge, uint32_t a, uint32_t b);

#endif
