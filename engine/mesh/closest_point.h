/* Closest point: the point of one face that is nearest to a point in space, as a canonical point of
 * the mesh. */
#pragma once

#include "mesh/topology.h"

/* Returns the squared distance from `q` (normalised unit) to the face. If the nearest point lies on
 * a common vertex or edge of two faces, both faces give the same value to the last bit. */
double gd__face_square_distance(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q);

/* Returns the canonical point of the face nearest to `q`. If a vertex or an edge is within the
 * rounding error of coordinates up to `magnitude`, returns the point of that vertex or edge. */
struct gd_point gd__face_closest_point(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q,
                                       double magnitude);

/* Returns the largest absolute coordinate. */
static inline double gd__largest_coordinate(struct gd_vec3 p)
{
    return fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
}
