/* Foot: the point of one face that is nearest to a point of space, and the canonical point that it
 * stands for. */
#ifndef GD_MESH_FOOT_H
#define GD_MESH_FOOT_H

#include "mesh/topology.h"

/* Squared distance from `q` (inside unit) to the face. What neighbours share gives the same value
 * to the last bit from either face. */
double gd__foot_distance(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q);

/* The canonical point of the face nearest to `q`: a vertex or an edge within the rounding of
 * coordinates up to `magnitude` is preferred. */
struct gd_point gd__foot_point(const struct gd_mesh *mesh, uint32_t face, struct gd_vec3 q,
                               double magnitude);

/* Largest absolute coordinate. */
static inline double gd__largest_coordinate(struct gd_vec3 p)
{
    return fmax(fmax(fabs(p.x), fabs(p.y)), fabs(p.z));
}

#endif
