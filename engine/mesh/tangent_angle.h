/* Tangent angle: the angle on the surface between two directions at a point. */
#pragma once

#include "mesh/local.h"

/* Returns the angle at `at` between the directions to two other points. Each of these must have a
 * common face with `at`. The angle is measured on the surface. At an interior point, the two
 * directions form two angles. The result is the smaller one, which is at most half of the total
 * angle. At a boundary vertex, only one of the two angles is on the surface, and it can be as large
 * as the total angle. Returns NaN if there is no common face. O(1); O(faces) at a vertex. */
double gd__tangent_angle(const struct gd_mesh *mesh, const struct gd_point *at,
                         const struct gd_point *a, const struct gd_point *b);
