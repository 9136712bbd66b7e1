/* Sheets: the faces around an edge of more than two, and which of them stay together. */
#ifndef GD_REPAIR_FACE_PAIRING_H
#define GD_REPAIR_FACE_PAIRING_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/vec.h"

struct gd__edge_face {
    uint32_t side; /* of the face, at the edge */
    /* once consistently oriented the face runs along the edge from its lower end to its higher
       one */
    bool forward;
    struct gd_vec3 across; /* from the edge into the face, any length but zero */
    /* filled here: about the edge, counter-clockwise seen against its direction */
    double angle;
    /* filled here: the side of the face that it stays with, GD_NONE: it gets a border */
    uint32_t partner;
    uint32_t below; /* scratch */
};

/* Sorts the faces around the edge of direction `along` and pairs them, see face_pairing.c. O(n log
 * n). */
void gd__edge_faces_pair(struct gd__edge_face *edge_face, uint32_t count, struct gd_vec3 along);

#endif
