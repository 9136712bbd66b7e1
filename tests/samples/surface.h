/* Surface: a closed triangle mesh whose edges can be collapsed and flipped.
 *
 * Slot s = 3 f + k of `corners` is the half-edge from corner k of face f to the next corner. The
 * `twin` of a slot is the other half-edge of its edge. Removed faces and vertices stay in the
 * arrays until surface_finish. */
#pragma once

#include <stdbool.h>

#include "gd/polygons.h"
#include "gd/status.h"

struct surface {
    double (*positions)[3];
    uint32_t vertex_count, face_slots; /* sizes of the arrays, including removed elements */
    uint32_t faces;                    /* number of remaining faces */
    uint32_t *corners;                 /* three for each face; GD_NONE for a removed face */
    uint32_t *twin;                    /* for each slot, the other half-edge of its edge */
    /* for each vertex, a slot that starts there; GD_NONE for a removed vertex */
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

/* Returns the corner of the slot's face opposite to the slot. */
static inline uint32_t surface_apex(const struct surface *surface, uint32_t slot)
{
    return surface->corners[surface_previous(slot)];
}

/* Returns the next slot around the origin of `slot`. */
static inline uint32_t surface_turn(const struct surface *surface, uint32_t slot)
{
    return surface->twin[surface_previous(slot)];
}

double surface_length(const struct surface *surface, uint32_t slot);

/* Returns the number of edges at the vertex. */
uint32_t surface_valence(const struct surface *surface, uint32_t vertex);

/* Takes ownership of the arrays of a closed 2-manifold triangle mesh, and leaves the mesh empty. On
 * GD_NO_MEMORY the mesh is unchanged. */
GD_MUST_USE enum gd_status surface_start(struct gd_polygons *mesh, struct surface *out);

/* Moves the mesh to *out without removed elements. The caller frees it by gd_polygons_free. */
void surface_finish(struct surface *surface, struct gd_polygons *out);

/* Collapses the slot's edge to its midpoint. This removes the destination and two faces. Returns
 * false and changes nothing if that would break the manifold or turn a face over. */
bool surface_collapse(struct surface *surface, uint32_t slot);

/* Replaces the slot's edge by the other diagonal of its two faces. Returns false and changes
 * nothing if this diagonal is an edge already, or if a corner would have fewer than three faces. */
bool surface_flip(struct surface *surface, uint32_t slot);
