/* Face pairing: decides which of the faces around an edge of more than two faces stay joined. */
#ifndef GD_REPAIR_FACE_PAIRING_H
#define GD_REPAIR_FACE_PAIRING_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/vec.h"

struct gd__edge_face {
    uint32_t side; /* the face's side at the edge */
    /* true if the face, once oriented consistently, runs along the edge from the lower to the
     * higher vertex */
    bool forward;
    struct gd_vec3 across; /* vector from the edge into the face, of any length except zero */
    /* output: angle about the edge, counter-clockwise as seen against the edge's direction */
    double angle;
    /* output: the side of the face to which this face stays joined, or GD_NONE if the face gets a
       border */
    uint32_t partner;
    uint32_t below; /* scratch */
};

/* Sorts the faces around an edge and pairs them (see face_pairing.c). `along` is the direction of
 * the edge. O(n log n). */
void gd__edge_faces_pair(struct gd__edge_face *edge_face, uint32_t count, struct gd_vec3 along);

#endif
