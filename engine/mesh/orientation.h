/* Orientation: determines the faces to flip so that neighbours traverse their common edge in
 * opposite directions. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "base/pace.h"

/* All members except the last three are input. The caller owns all arrays and zeroes `flipped`. */
struct gd__orientation {
    const uint32_t (*corner)[3];
    const uint32_t *neighbour; /* for each side, as in struct gd__construction */
    uint32_t face_count;
    /* The search of a component starts at the first of these faces that belongs to the component.
       GD_NONE is skipped. NULL means all faces in the order of their numbers. */
    const uint32_t *seeds;
    uint32_t seed_count;
    /* Called once for each non-orientable component, with a side where the two faces cannot be
     * oriented consistently. May be NULL. */
    void (*contradicted)(void *user, uint32_t side);
    void *user;
    struct gd__pace *pace;

    uint8_t *flipped;    /* for each face, 1 if it must be flipped */
    uint32_t *component; /* for each face, the number of its component */
    uint32_t component_count, flipped_count;
};

/* Orients the faces, breadth-first over each component. In each component at most half of the faces
 * are flipped. If exactly half of them are, the first face is not flipped. Errors: GD_NO_MEMORY,
 * and those of the pace. Linear time. */
enum gd_status gd__orient_faces(struct gd__orientation *orientation);
