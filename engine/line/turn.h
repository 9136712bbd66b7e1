/* Turn: a direction at a point as one number. It is the unscaled angle on the surface,
 * counter-clockwise, from a zero that depends on the kind of point:
 *
 *     in a face     from its side 0
 *     on an edge    from the direction of its side 2e; turns below pi lead into that side's face,
 *                   others into the other face
 *     at a vertex   from the first entry of its fan, as gd_fan.angle
 *
 * Conversions to the angles of the interface (gd/direction.h) are exact up to the rounding of the
 * angle. */
#pragma once

#include "gd/direction.h"
#include "mesh/polar.h"

/* Returns the total angle around a point: 2 pi, or at a vertex the sum of the angles of its
 * faces. */
double gd__turn_total(const struct gd_mesh *mesh, const struct gd_point *point);

/* Returns true for an interior point: not on a boundary edge and not a boundary vertex. */
bool gd__turn_is_closed(const struct gd_mesh *mesh, const struct gd_point *point);

/* Reduces a turn to [0, total) at an interior point. Returns it unchanged at the boundary. */
double gd__turn_reduce(const struct gd_mesh *mesh, const struct gd_point *point, double turn);

/* Returns the ratio of turn to angle: 1, except for interior vertices. */
double gd__turn_scale(const struct gd_mesh *mesh, const struct gd_point *point);

/* Convert between a direction's angle and its turn. At a boundary vertex, angles outside the
 * surface stay unchanged. O(1); O(faces) at a vertex. */
double gd__turn_of_angle(const struct gd_mesh *mesh, const struct gd_point *point, double angle);
double gd__turn_to_angle(const struct gd_mesh *mesh, const struct gd_point *point, double turn);

/* Returns the direction with that turn. If the turn is outside the surface, its vector lies in the
 * plane of the nearest face. */
struct gd_direction gd__turn_direction(const struct gd_mesh *mesh, const struct gd_point *point,
                                       double turn);

/* Returns the turn of the direction (x, y) in the frame of `side`. The point must lie in the side's
 * face or on its border. If the direction leads out of the face, it is unfolded into the
 * neighbouring faces. Of the turns that differ by multiples of 2 pi, returns the one nearest to
 * those that lead into the face. */
double gd__turn_in_face(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t side,
                        double x, double y);

/* Returns the angle at `at` between the directions to two other points. Each of these must have a
 * common face with `at`. The angle is measured on the surface. At an interior point, the two
 * directions form two angles. The result is the smaller one, which is at most half of the total
 * angle. At a boundary vertex, only one of the two angles is on the surface, and it can be as large
 * as the total angle. Returns NaN if there is no common face. O(1); O(faces) at a vertex. */
double gd__turn_between(const struct gd_mesh *mesh, const struct gd_point *at,
                        const struct gd_point *a, const struct gd_point *b);

/* A ray in the face into which a turn leads. `side` is a side of this face. The ray begins at (x,
 * y) in the frame of `side`. If the ray begins at a vertex, the side begins at this vertex. If the
 * ray begins on an edge, the side is one of the edge's two sides. */
struct gd__ray {
    uint32_t side;
    double x, y, dx, dy;
};

struct gd__ray gd__turn_ray(const struct gd_mesh *mesh, const struct gd_point *point, double turn);
