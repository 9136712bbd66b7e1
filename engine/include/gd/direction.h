/* Direction: a tangent direction at a point of the surface, as an angle and as a vector in space.
 *
 *     struct gd_direction direction;
 *     if (gd_direction_at_angle(mesh, &point, M_PI_2, &direction, NULL) == GD_OK)
 *         printf("%g\n", direction.xyz.z);
 *
 * Angles increase counter-clockwise as seen from outside. The direction of angle zero depends on
 * the point (indices and order are those of the input):
 *     in a face             the direction of its first edge, from its first corner to its second,
 *                           in the order of the input
 *     on an edge            from the lower-numbered vertex to the higher one. The surface is flat
 *                           across an edge: angles up to pi lead into the face to the left of that
 *                           direction, others into the face to the right
 *     at an interior vertex the edge to the lowest-numbered neighbour; any total angle
 *                           is scaled to 2 pi
 *     at a boundary vertex  the boundary edge from which the faces around the vertex follow each
 *                           other counter-clockwise; angles are not scaled, and are at most
 *                           the total angle.
 * A vector lies in the plane of the face into which the direction leads. All functions are
 * thread-safe; `out` is untouched on failure. */
#ifndef GD_DIRECTION_H
#define GD_DIRECTION_H

#include "gd/point.h"

GD_EXTERN_C_BEGIN

struct gd_direction {
    double angle;       /* radians; in [0, 2 pi), or at a boundary vertex in [0, total angle] */
    struct gd_vec3 xyz; /* unit vector */
    /* the face into which the direction leads; along an edge, one of its two faces */
    struct gd_face face;
};

/* Computes the direction at an angle. The angle may be any finite number. At the boundary, the
 * direction must lead into the surface, with a tolerance of 1e-9. `detail` may be NULL. Errors:
 * GD_INVALID_ARGUMENT (not finite), GD_NOT_ON_SURFACE (the direction leads over the boundary).
 * O(1); O(faces) at a vertex. */
GD_MUST_USE enum gd_status gd_direction_at_angle(const struct gd_mesh *mesh,
                                                 const struct gd_point *point, double angle,
                                                 struct gd_direction *out,
                                                 struct gd_detail *detail);

/* Computes the direction of a vector of any length, projected onto the surface. In a face the
 * projection is perpendicular. On an edge, the vector is projected perpendicularly into each of the
 * two faces. If both projections lead into their faces, the projection that turns the vector less
 * is used. If neither does, the vector is projected onto the edge. At a vertex the vector is
 * projected along the vertex normal (the mean of the faces' normals weighted by angle) into the
 * face that the projection meets. If the vector is already tangent, its direction does not change.
 * `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (the vector is not finite, or its projection
 * vanishes), GD_NOT_ON_SURFACE (the direction leads over the boundary). O(1); O(faces) at a
 * vertex. */
GD_MUST_USE enum gd_status gd_direction_along(const struct gd_mesh *mesh,
                                              const struct gd_point *point, struct gd_vec3 vector,
                                              struct gd_direction *out, struct gd_detail *detail);

/* Returns the straight continuation of a line that arrives at the point. `back` is the direction
 * from the point back along the line. The angles of the continuation and of `back` differ by pi.
 * Except at a boundary vertex, pi is half of the total angle. If the continuation leads over the
 * boundary, its angle is not an angle on the surface (at a vertex, it is larger than the total
 * angle), and its vector is the negative of the vector of `back`. O(1); O(faces) at a vertex. */
struct gd_direction gd_direction_opposite(const struct gd_mesh *mesh, const struct gd_point *point,
                                          const struct gd_direction *back);

/* Computes the unit vectors x and y of a face: the direction at angle a is cos(a) x + sin(a) y. The
 * face must exist (gd_mesh_has_face). O(1). */
void gd_direction_axes(const struct gd_mesh *mesh, struct gd_face face, struct gd_vec3 *x,
                       struct gd_vec3 *y);

GD_EXTERN_C_END

#endif
