/* Curve distance: the exact least distance between two curves on a surface, and the greatest
 * distance that a point of one curve has from the other curve.
 *
 *     gd_curve_seeds(&a, 0, seeds);                     // the field of one curve, built once
 *     ... gd_field_build(mesh, &request, NULL, &field_of_a, NULL);
 *     struct gd_curve_distance distance;
 *     if (gd_curve_distance(field_of_a, &a, &b, NULL, &distance) == GD_OK) {
 *         ...
 *         gd_curve_distance_free(&distance);
 *     }
 *
 * Along a segment of the other curve, the field's distance is the minimum of the distances from a
 * few sources. The least and the greatest value of this minimum are computed by closed formulas. In
 * all functions `control` may be NULL. Thread-safe. */
#ifndef GD_CURVE_DISTANCE_H
#define GD_CURVE_DISTANCE_H

#include "gd/curve.h"

GD_EXTERN_C_BEGIN

/* A point of a curve. */
struct gd_curve_place {
    struct gd_point point;
    /* arc length from the curve's start, as a fraction of its length, in [0, 1] */
    double parameter;
    /* Least angle between the path and the curve at this point, in [0, pi]: pi / 2 where the curve
       is smooth. NaN if the curves meet. */
    double angle;
};

struct gd_curve_distance {
    /* INFINITY if there is no path between the curves; the other members are then undefined */
    double distance;
    struct gd_curve_place a, b;
    struct gd_path path; /* from a to b */
};

/* Frees the path. NULL is allowed. */
void gd_curve_distance_free(struct gd_curve_distance *distance);

/* Computes the least distance between a point of `a` and a point of `b`. `field` must have the
 * seeds gd_curve_seeds(a, 0). If the curves meet, the distance is 0 and the two points are the same
 * point. Errors: GD_INVALID_ARGUMENT (the field has another number of seeds), GD_BEYOND_REACH (a
 * partial field), GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL (the path's length differs
 * from the distance). O(wedges of the edges around b). */
GD_MUST_USE enum gd_status gd_curve_distance(const struct gd_field *field, const struct gd_curve *a,
                                             const struct gd_curve *b,
                                             const struct gd_control *control,
                                             struct gd_curve_distance *out);

/* Computes the one-sided Hausdorff distance from b to a, that is, the greatest distance of a point
 * of `b` from `a`. Also computes that point, and its nearest point on `a`. The distance is INFINITY
 * if a part of b has no path to a. Errors and cost: those of gd_curve_distance. */
GD_MUST_USE enum gd_status gd_curve_farthest(const struct gd_field *field, const struct gd_curve *a,
                                             const struct gd_curve *b,
                                             const struct gd_control *control,
                                             struct gd_curve_distance *out);

GD_EXTERN_C_END

#endif
