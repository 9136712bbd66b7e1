/* Tangent angle: the angle on the surface between two directions at a point. */
#ifndef GD_MESH_TANGENT_ANGLE_H
#define GD_MESH_TANGENT_ANGLE_H

#include "mesh/local.h"

/* The angle between the directions from `at` to two other points, each in a face together with it:
 * the lesser of the two ways round, as it is on the surface (around a vertex up to half of its
 * total angle; around a boundary vertex up to all of it). NaN where a point shares no face with it.
 * O(1), at a vertex O(its faces). */
double gd__tangent_angle(const struct gd_mesh *mesh, const struct gd_point *at,
                         const struct gd_point *a, const struct gd_point *b);

#endif
