/* Portal: a side through which a line enters a face, in the plane of the unfolded faces. */
#pragma once

#include "mesh/local.h"
#include "mesh/topology.h"

/* The line enters the face of `side`. The side's origin is on the left. */
struct gd__portal {
    uint32_t side;
    struct gd__local left, right;
    struct gd__local along; /* unit vector in the direction of the side */
};

/* Returns side 0 of a face as a portal. The plane has the frame of this side. */
struct gd__portal gd__portal_entrance(const struct gd_mesh *mesh, uint32_t face);

/* Computes the position of the portal out->side from the portal before it. `out->side` must be the
 * left or the right edge of the face behind the last portal, or the last portal in the opposite
 * direction. Returns false for any other side, and for a side of the boundary. */
bool gd__portal_next(const struct gd_mesh *mesh, const struct gd__portal *last,
                     struct gd__portal *out);

/* Returns the position, in the plane, of a point of the face behind a portal. */
struct gd__local gd__portal_place(const struct gd_mesh *mesh, const struct gd__portal *portal,
                                  const struct gd_point *point);
