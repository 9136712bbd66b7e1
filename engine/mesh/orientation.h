/* Orientation: which faces to turn over so that neighbours run along their common edge in opposite
 * directions. */
#ifndef GD_MESH_ORIENTATION_H
#define GD_MESH_ORIENTATION_H

#include <stdbool.h>
#include <stdint.h>

#include "base/pace.h"

/* In: all but the last three, which are filled; `flipped` is zeroed. All are the caller's. */
struct gd__orientation {
    const uint32_t (*corner)[3];
    const uint32_t *neighbour; /* per side, as in struct gd__construction */
    uint32_t face_count;
    /* faces in the order in which components begin, GD_NONE is passed over; NULL: by number */
    const uint32_t *seeds;
    uint32_t seed_count;
    /* Called once for each component that has no orientation, with one of the sides where it
     * breaks. May be NULL. */
    void (*contradicted)(void *user, uint32_t side);
    void *user;
    struct gd__pace *pace;

    uint8_t *flipped;    /* per face: turn it over */
    uint32_t *component; /* per face */
    uint32_t component_count, flipped_count;
};

/* Breadth first over each component; the majority of a component's faces is not turned, at a tie
 * its first one is not. GD_NO_MEMORY, and the status of the pace. Linear
 * time. */
enum gd_status gd__orient_faces(struct gd__orientation *orientation);

#endif
