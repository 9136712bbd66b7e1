/* Tangent angle: the angle on the surface between two directions at a point. */
#ifndef GD_MESH_TANGENT_ANGLE_H
#define GD_MESH_TANGENT_ANGLE_H

#include "mesh/local.h"

/* Returns the angle at `at` between the directions to two other points. Each of these must have a
 * common face with `at`. The angle is measured on the surface, and is the smaller of the two angles
 * around the point: at most half of the total angle around a vertex, but up to all of it around a
 * boundary vertex. Returns NaN if there is no common face. O(1); O(faces) at a vertex. */
double gd__tangent_angle(const struct gd_mesh *mesh, const struct gd_point *at,
                         const struct gd_point *a, const struct gd_point *b);

#endif
