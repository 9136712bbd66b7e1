/* Locate: from space to the surface, through the mesh's bounding volume hierarchy. */
#ifndef GD_LOCATE_H
#define GD_LOCATE_H

#include "gd/point.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The point of the surface nearest to `xyz`; ties go to the lowest-numbered face. `max_snap` < 0:
 * any distance will do; else a nearest point farther than it is GD_NOT_ON_SURFACE. Errors:
 * GD_INVALID_ARGUMENT (not finite), GD_NOT_ON_SURFACE. Cost: expected O(log n). Thread-safe. */
GD_MUST_USE enum gd_status gd_locate_nearest(const struct gd_mesh *mesh, struct gd_vec3 xyz,
                                             double max_snap, struct gd_point *out,
                                             struct gd_detail *detail);

/* How far `xyz` is from a point of the surface in a straight line, in the mesh's unit. O(1). */
double gd_locate_distance(const struct gd_mesh *mesh, struct gd_vec3 xyz,
                          const struct gd_point *point);

/* The first point of the surface that the ray meets, from either side; watertight along edges and
 * vertices. A face seen exactly edge-on is met at its border, or at the origin if that lies on it.
 * Errors: GD_INVALID_ARGUMENT (not finite, direction of length zero), GD_NOT_ON_SURFACE (no hit, or
 * an origin beyond 1e75 mean edges). Cost: expected O(log n). Thread-safe. */
GD_MUST_USE enum gd_status gd_locate_first_hit(const struct gd_mesh *mesh, struct gd_vec3 origin,
                                               struct gd_vec3 direction, struct gd_point *out,
                                               struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
