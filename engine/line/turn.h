/* Turn: a direction at a point as one number, the angle on the surface itself: never scaled,
 * counter-clockwise, from a zero inside the mesh.
 *
 *     in a face     from its side 0
 *     on an edge    from the direction of its side 2e; below pi in that side's face, beyond in the
 *                   other one
 *     at a vertex   from the first entry of its fan, as gd_fan.angle
 *
 * Conversions to the angles that callers know (gd/direction.h) are exact up to the rounding of the
 * angle. */
#ifndef GD_LINE_TURN_H
#define GD_LINE_TURN_H

#include "gd/direction.h"
#include "mesh/topology.h"

/* The angle around a point that counts as all around: 2 pi, at a vertex the sum of its corners. */
double gd__turn_total(const struct gd_mesh *mesh, const struct gd_point *point);

/* Is there surface all around? Not on boundary edges and at boundary vertices. */
bool gd__turn_is_closed(const struct gd_mesh *mesh, const struct gd_point *point);

/* The same turn in [0, total), where there is surface all around; else, at a boundary vertex, as it
 * is. */
double gd__turn_reduce(const struct gd_mesh *mesh, const struct gd_point *point, double turn);

/* Turn over angle: 1, but for interior vertices. */
double gd__turn_scale(const struct gd_mesh *mesh, const struct gd_point *point);

/* From the angle of a direction and back. At a boundary vertex angles off the surface stay what
 * they are. O(1), at a vertex O(its faces). */
double gd__turn_of_angle(const struct gd_mesh *mesh, const struct gd_point *point, double angle);
double gd__turn_to_angle(const struct gd_mesh *mesh, const struct gd_point *point, double turn);

/* The direction with that turn. Off the surface its vector lies in the plane of the nearest
 * face. */
struct gd_direction gd__turn_direction(const struct gd_mesh *mesh, const struct gd_point *point,
                                       double turn);

/* Of the direction (x, y) in the frame of `side`, in whose closed face the point lies. Of turns
 * that are the same but for whole turns of the plane, the one nearest to the face: what leads out
 * of it is laid into the faces beside. */
double gd__turn_in_face(const struct gd_mesh *mesh, const struct gd_point *point, uint32_t side,
                        double x, double y);

/* The angle that is the same but for whole turns of the plane, and nearest to [0, extent]. */
static inline double gd__turn_nearest(double angle, double extent)
{
    return remainder(angle - 0.5 * extent, 2 * M_PI) + 0.5 * extent;
}

/* A line in the face into which a turn leads: from (x, y) in the frame of `side`. At a vertex that
 * side goes out from it, on an edge it is one of its two. */
struct gd__ray {
    uint32_t side;
    double x, y, dx, dy;
};

struct gd__ray gd__turn_ray(const struct gd_mesh *mesh, const struct gd_point *point, double turn);

#endif
