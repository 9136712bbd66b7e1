/* Anchor: how a point hangs on the vertices of the faces that contain it. */
#ifndef GD_MESH_ANCHOR_H
#define GD_MESH_ANCHOR_H

#include "mesh/topology.h"

/* Where a point lies: vertices of the faces that contain it and the straight ways to them. */
struct gd__anchor {
    uint32_t corner[4]; /* GD_NONE fills */
    double leg[4];
    struct gd_vec3 position; /* inside unit */
};
struct gd__anchor gd__anchor(const struct gd_mesh *mesh, const struct gd_point *point);

#endif
