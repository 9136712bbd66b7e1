/* Ascent: of vectors at a point, the direction in which they pull most. */
#ifndef GD_TRANSPORT_ASCENT_H
#define GD_TRANSPORT_ASCENT_H

#include "line/turn.h"

/* A pull: a vector's turn, and its length times its weight. */
struct gd__pull {
    double turn, strength;
    double weight;
    double bend; /* length over that of the first segment: 1 where the path is straight */
};

/* The turn on the surface in which the sum of strength_i cos(min(|turn - turn_i|, pi)) is greatest,
 * and that sum: less than 0 where every direction leads away from all. In a plane they are those of
 * the vectors' sum. O(count), at vertices and at the boundary O(count^2). */
double gd__ascent(const struct gd_mesh *mesh, const struct gd_point *point,
                  const struct gd__pull *pulls, uint32_t count, double *turn);

/* Newton's step for the sum of weight times squared distance, whose second derivative is the weight
 * along each vector and weight times bend across:
 * `*turn` is its turn, the result its length. `heading` is the turn of gd__ascent: where the
 * surface is not flat around the point, the step goes that way. O(count). */
double gd__ascent_step(const struct gd_mesh *mesh, const struct gd_point *point,
                       const struct gd__pull *pulls, uint32_t count, double heading, double *turn);

#endif
