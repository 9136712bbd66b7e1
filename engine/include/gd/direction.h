/* Direction: where a line leaves a point of the surface, as an angle and as a vector of space.
 *
 *     struct gd_direction direction;
 *     if (gd_direction_at_angle(mesh, &point, M_PI_2, &direction, NULL) == GD_OK)
 *         printf("%g\n", direction.xyz.z);
 *
 * Angles grow counter-clockwise as seen from outside. Zero is, with numbers as in the input,
 *     in a face             the direction of its first edge, from its first corner to its second,
 *                           in the order of the input
 *     on an edge            from the lower-numbered vertex to the higher one. The surface is flat
 *                           across an edge: up to pi an angle is in the face to the left of that
 *                           direction, beyond in the one to the right
 *     at an interior vertex the edge to the lowest-numbered neighbour; the total angle counts as
 *                           2 pi, whatever it is
 *     at a boundary vertex  the boundary edge from which the faces around the vertex follow each
 *                           other counter-clockwise; angles are as they are, up to the total one.
 * Vectors are tangent: in the plane of the face into which the direction leads. All functions are
 * thread-safe; `out` is untouched on failure. */
#ifndef GD_DIRECTION_H
#define GD_DIRECTION_H

#include "gd/point.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_direction {
    double angle;        /* radians; in [0, 2 pi), at a boundary vertex in [0, total angle] */
    struct gd_vec3 xyz;  /* of unit length */
    struct gd_face face; /* the one that it leads into; along an edge one of two */
};

/* The direction at an angle: any finite one but at the boundary, where it must be on the surface
 * (to 1e-9). `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (not finite), GD_NOT_ON_SURFACE (it
 * leads over the boundary). O(1), at a vertex O(its faces). */
GD_MUST_USE enum gd_status gd_direction_at_angle(const struct gd_mesh *mesh,
                                                 const struct gd_point *point, double angle,
                                                 struct gd_direction *out,
                                                 struct gd_detail *detail);

/* The direction that a vector of any length has when it is projected onto the surface: in a face at
 * right angles to it; on an edge to that of its faces which it projects into (of two, to the one
 * nearer to it; of none, onto the edge); at a vertex along the normal, the mean of those of the
 * faces weighted by their angles, to the face that it projects into. A vector that is tangent keeps
 * its direction. `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (not finite, or nothing of it is
 * left), GD_NOT_ON_SURFACE (it leads over the boundary). O(1), at a vertex O(its faces). */
GD_MUST_USE enum gd_status gd_direction_along(const struct gd_mesh *mesh,
                                              const struct gd_point *point, struct gd_vec3 vector,
                                              struct gd_direction *out, struct gd_detail *detail);

/* The direction in which a line goes on straight that comes from the direction `back`, which is one
 * of this point: half of the angle around the point further. Where that is over the boundary, the
 * angle is off the surface too (at a vertex: beyond the total one) and the vector is opposite to
 * back's. O(1), at a vertex O(its faces). */
struct gd_direction gd_direction_opposite(const struct gd_mesh *mesh, const struct gd_point *point,
                                          const struct gd_direction *back);

/* The unit vectors of a face (gd_mesh_has_face) from which its directions are counted: at angle a
 * there is cos(a) x + sin(a) y. O(1). */
void gd_direction_axes(const struct gd_mesh *mesh, struct gd_face face, struct gd_vec3 *x,
                       struct gd_vec3 *y);

#ifdef __cplusplus
}
#endif

#endif
