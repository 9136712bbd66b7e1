/* Closest point: the point of one face that is nearest to a point of space, as a canonical point of
 * the mesh. */
#ifndef GD_MESH_CLOSEST_POINT_H
#define GD_MESH_CLOSEST_POINT_H

#include "mesh/topology.h"

/* Squared distance from `q` (inside unit) to the face. What neighbours share gives the same value
 * to the last bit from either face. */
double gd__face_square_distance(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q);

/* The canonical point of the face nearest to `q`: a vertex or an edge within the rounding of
 * coordinates up to `magnitude` is preferred. */
struct gd_point gd__face_closest_point(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q,
                                       double magnitude);

/* Largest absolute coordinate. */
static inline double gd__largest_coordinate(struct gd_vec3 p)
{
    return fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
}

#endif
