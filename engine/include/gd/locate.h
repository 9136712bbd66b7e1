/* Locate: finds the point of the surface that is nearest to a point in space, or the first point
 * that a ray hits. Uses the mesh's bounding volume hierarchy. */
#ifndef GD_LOCATE_H
#define GD_LOCATE_H

#include "gd/point.h"

GD_EXTERN_C_BEGIN

/* Finds the point of the surface that is nearest to `xyz`. In a tie, finds the point in the face
 * with the lowest number. If `max_snap` >= 0 and the nearest point is farther than `max_snap`, the
 * error is GD_NOT_ON_SURFACE. `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (not finite),
 * GD_NOT_ON_SURFACE. Cost: expected O(log n). Thread-safe. */
GD_MUST_USE enum gd_status gd_locate_nearest(const struct gd_mesh *mesh, struct gd_vec3 xyz,
                                             double max_snap, struct gd_point *out,
                                             struct gd_detail *detail);

/* Returns the straight-line distance from `xyz` to a point of the surface, in the mesh's unit.
 * O(1). */
double gd_locate_distance(const struct gd_mesh *mesh, struct gd_vec3 xyz,
                          const struct gd_point *point);

/* Finds the first point where a ray meets the surface, from either side. Rounding never makes a ray
 * miss the surface at an edge or a vertex. If the ray lies in a face's plane, the result is the
 * point where the ray meets the face's border, or the ray's origin if the origin lies on the face.
 * Errors: GD_INVALID_ARGUMENT (not finite, direction of length zero), GD_NOT_ON_SURFACE (no hit, or
 * an origin beyond 1e75 mean edges). Cost: expected O(log n). Thread-safe. */
GD_MUST_USE enum gd_status gd_locate_first_hit(const struct gd_mesh *mesh, struct gd_vec3 origin,
                                               struct gd_vec3 direction, struct gd_point *out,
                                               struct gd_detail *detail);

GD_EXTERN_C_END

#endif
