/* Towards: the directions from a point of the surface to points of the faces around it, as angles
 * on the surface. */
#ifndef GD_MESH_TOWARDS_H
#define GD_MESH_TOWARDS_H

#include "mesh/local.h"

/* The angle between the directions from `at` to two other points, each in a face together with it:
 * the lesser of the two ways round, as it is on the surface (around a vertex up to half of its
 * total angle; around a boundary vertex up to all of it). NaN where a point shares no face with it.
 * O(1), at a vertex O(its faces). */
double gd__angle_between(const struct gd_mesh *mesh, const struct gd_point *at,
                         const struct gd_point *a, const struct gd_point *b);

#endif
