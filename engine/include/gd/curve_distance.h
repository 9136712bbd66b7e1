/* Curve distance: how far two curves on a surface are from each other, at the least and at the
 * most; exact, not sampled.
 *
 *     gd_curve_seeds(&a, 0, seeds);                     // the field of one curve, built once
 *     ... gd_field_build(mesh, &request, NULL, &field_of_a, NULL);
 *     struct gd_curve_distance distance;
 *     if (gd_curve_distance(field_of_a, &a, &b, NULL, &distance) == GD_OK) {
 *         ...
 *         gd_curve_distance_free(&distance);
 *     }
 *
 * Along each segment of the other curve the field's distance is the lower envelope of those to few
 * sources, whose extremes are found in closed form. `control` may be NULL. Thread-safe. */
#ifndef GD_CURVE_DISTANCE_H
#define GD_CURVE_DISTANCE_H

#include "gd/curve.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A place on a curve. */
struct gd_curve_place {
    struct gd_point point;
    double parameter; /* part of the curve's length that lies before it, in [0, 1] */
    /* the least between the path and the curve there, in [0, pi]: pi / 2 where the curve is smooth;
       NaN where there is no path to measure (the curves meet), or none was wanted */
    double angle;
};

struct gd_curve_distance {
    /* INFINITY: no path leads from one to the other, and the rest is without meaning */
    double distance;
    struct gd_curve_place a, b;
    struct gd_path path; /* from a to b */
};

/* frees the path; NULL is harmless */
void gd_curve_distance_free(struct gd_curve_distance *distance);

/* The least distance between a point of `a` and one of `b`. `field`: of gd_curve_seeds(a, 0).
 * Curves that meet: 0, and a point in which they do. Errors: GD_INVALID_ARGUMENT (the field has not
 * as many seeds), GD_BEYOND_REACH (a partial field), GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE,
 * GD_INTERNAL (a path's length is not the distance). O(wedges of the edges around b). */
GD_MUST_USE enum gd_status gd_curve_distance(const struct gd_field *field, const struct gd_curve *a,
                                             const struct gd_curve *b,
                                             const struct gd_control *control,
                                             struct gd_curve_distance *out);

/* The one-sided Hausdorff distance from b to a: the greatest that a point of `b` has from `a`, that
 * point, and the point of `a` nearest to it. INFINITY: from a part of b no path leads to a. Errors
 * and cost: the same. */
GD_MUST_USE enum gd_status gd_curve_farthest(const struct gd_field *field, const struct gd_curve *a,
                                             const struct gd_curve *b,
                                             const struct gd_control *control,
                                             struct gd_curve_distance *out);

#ifdef __cplusplus
}
#endif

#endif
