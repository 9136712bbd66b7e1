/* Ascent: the direction at a point in which the sum of given vectors' components is greatest. */
#pragma once

#include "line/turn.h"

/* A weighted vector: `turn` is its direction (line/turn.h), `strength` its length times its
 * weight. */
struct gd__pull {
    double turn, strength;
    double weight;
    /* length of the vector's path, divided by the length of the path's first segment: 1 for a
       straight path */
    double bend;
};

/* Finds the turn with the greatest sum of strength_i cos(min(|turn - turn_i|, pi)). Returns this
 * sum. If it is negative, every direction leads away from the vectors. In a plane, the turn and the
 * sum are the direction and the length of the sum of the vectors. O(count); O(count^2) at vertices
 * and at the boundary. */
double gd__ascent(const struct gd_mesh *mesh, const struct gd_point *point,
                  const struct gd__pull *pulls, uint32_t count, double *turn);

/* Computes Newton's step for half the sum of weight times squared distance. The second derivative
 * of a term is `weight` along the term's vector and `weight * bend` across it. Returns the step's
 * length and sets *turn to its turn. `heading` is the turn from gd__ascent. At a vertex and at the
 * boundary, the step uses this turn instead of Newton's, because the surface is not flat around
 * such a point. O(count). */
double gd__ascent_step(const struct gd_mesh *mesh, const struct gd_point *point,
                       const struct gd__pull *pulls, uint32_t count, double heading, double *turn);
