/* Surface ray: a straight line that is traced from face to face. It enters the face of `side`
 * across that side, at distance `t` from the side's origin. Its direction (dx, dy) in the side's
 * frame is a unit vector with dy >= 0. To cross a face, the ray needs no rotation in space and
 * reads only one record of the mesh. */
#pragma once

#include "mesh/topology.h"

struct gd__surface_ray {
    uint32_t side; /* a side without a face means that the line has reached the boundary */
    double t, dx, dy;
};

/* The crossing of a face: `edge` is the length of the edge by which the line leaves, `run` the
 * line's length in the face. If the line meets the end of an edge up to rounding, the ray's t may
 * be outside the edge or NaN, and `run` is undefined. */
struct gd__face_crossing {
    double edge, run;
};

static inline void gd__surface_ray_turn(struct gd__surface_ray *walk, double x, double y)
{
    /* one step of Newton's method in each face keeps the length of the vector at 1 */
    double length = x * x + y * y, scale = 1.5 - 0.5 * length;
    walk->dx = x * scale;
    walk->dy = y * scale;
}

/* Crosses the face of the ray's side. `s` is the record of this side. The ray leaves by the left
 * edge (from the origin to the apex) or by the right edge (from the apex to the destination). Let u
 * be the unit vector along the edge, and d the direction. Then |u x d| is the new dy, and one
 * division gives both t and run. A line from the side's origin leaves by the right edge. */
static inline struct gd__face_crossing gd__surface_ray_cross(const struct gd_side *s,
                                                             struct gd__surface_ray *walk)
{
    double t = walk->t, dx = walk->dx, dy = walk->dy;
    double px = s->left_length * s->left_x, py = s->left_length * s->left_y; /* apex */
    if ((px - t) * dy - py * dx > 0 && t > 0) {
        double sine = s->left_x * dy - s->left_y * dx, inverse = 1 / sine;
        walk->side = s->left;
        walk->t = t * dy * inverse;
        gd__surface_ray_turn(walk, s->left_x * dx + s->left_y * dy, sine);
        return (struct gd__face_crossing){s->left_length, t * s->left_y * inverse};
    }
    double sine = s->right_x * dy - s->right_y * dx, inverse = 1 / sine, rest = s->length - t;
    walk->side = s->right;
    walk->t = s->right_length - rest * dy * inverse;
    gd__surface_ray_turn(walk, s->right_x * dx + s->right_y * dy, sine);
    return (struct gd__face_crossing){s->right_length, -rest * s->right_y * inverse};
}
