/* Anchor: the vertices around a point, with their straight distances from it. */
#pragma once

#include "mesh/topology.h"

/* The vertices of the faces that contain a point, and the lengths of the straight segments to
 * them. */
struct gd__anchor {
    uint32_t corner[4]; /* padded by GD_NONE */
    double leg[4];
    struct gd_vec3 position; /* normalised unit */
};
struct gd__anchor gd__anchor(const struct gd_mesh *mesh, const struct gd_point *point);
