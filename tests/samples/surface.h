/* Surface: a closed triangle mesh in the making, whose edges can be collapsed and flipped.
 *
 * Slot s = 3 f + k of `corners` names the half-edge from corner k of face f to the next one; `twin`
 * of a slot is the same edge seen from the other face. Removed faces and vertices leave holes in
 * the arrays until surface_finish. */
#ifndef TESTS_SAMPLES_SURFACE_H
#define TESTS_SAMPLES_SURFACE_H

#include <stdbool.h>

#include "gd/polygons.h"
#include "gd/status.h"

struct surface {
    double (*positions)[3];
    uint32_t vertex_count, face_slots; /* sizes of the arrays, holes included */
    uint32_t faces;                    /* that are left */
    uint32_t *corners;                 /* three a face; GD_NONE: a removed face */
    uint32_t *twin;                    /* per slot */
    /* per vertex: a slot that starts there; GD_NONE: a removed vertex */
    uint32_t *outgoing;
};

static inline uint32_t surface_next(uint32_t slot)
{
    return slot % 3 == 2 ? slot - 2 : slot + 1;
}

static inline uint32_t surface_previous(uint32_t slot)
{
    return slot % 3 == 0 ? slot + 2 : slot - 1;
}

static inline uint32_t surface_destination(const struct surface *surface, uint32_t slot)
{
    return surface->corners[surface_next(slot)];
}

/* The corner of the slot's face that is opposite to it. */
static inline uint32_t surface_apex(const struct surface *surface, uint32_t slot)
{
    return surface->corners[surface_previous(slot)];
}

/* The next slot around the origin of `slot`. */
static inline uint32_t surface_turn(const struct surface *surface, uint32_t slot)
{
    return surface->twin[surface_previous(slot)];
}

double surface_length(const struct surface *surface, uint32_t slot);

/* Number of edges at the vertex. */
uint32_t surface_valence(const struct surface *surface, uint32_t vertex);

/* Takes the arrays of a closed 2-manifold triangle mesh over, which is left empty. GD_NO_MEMORY:
 * the mesh is untouched. */
GD_MUST_USE enum gd_status surface_start(struct gd_polygons *mesh, struct surface *out);

/* Gives the mesh back without holes, to be freed by gd_polygons_free. */
void surface_finish(struct surface *surface, struct gd_polygons *out);

/* Joins the ends of the slot's edge at its middle: the destination goes, with two faces. False, and
 * nothing is changed, where that would break the manifold or turn a face over. */
bool surface_collapse(struct surface *surface, uint32_t slot);

/* Turns the slot's edge into the other diagonal of its two faces. False, and nothing is changed,
 * where there is such an edge already or a corner would be left with fewer than three faces. */
bool surface_flip(struct surface *surface, uint32_t slot);

#endif
