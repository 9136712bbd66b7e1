/* Classes: initial paths of a homotopy class, given by winding numbers or by a curve. */
#pragma once

#include "nurbs/seeds.h"

/* A class of paths from parameter s[0] of the first curve to parameter s[1] of the second. The
 * coordinates at the end of a path are those of the second curve at s[1], plus turns[k] periods in
 * direction k. */
struct gd__class {
    int32_t turns[2];
    double s[2];
};

/* Number of initial paths of a class: the straight line of the domain, and arcs on both sides of
 * it. From the straight line, Newton's method may find a geodesic that is not minimal, for example
 * the outer equator of a torus. In this case it finds the minimal paths on both sides from the
 * arcs. */
#define GD__CLASS_SHAPES 3

/* Computes initial path `shape` of a class. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__class_seed(const struct gd_domain_curve *const ends[2],
                                          const struct gd__class *in, uint32_t shape,
                                          struct gd__path_seed *out);

/* Computes an initial path that follows a curve from the first end to the second. Errors:
 * GD_INVALID_ARGUMENT (the curve is a point, or does not run from the first end to the second),
 * GD_NO_MEMORY, and those of the pace. */
GD_MUST_USE enum gd_status gd__initial_seed(const struct gd_domain_curve *const ends[2],
                                            const struct gd_domain_curve *initial,
                                            struct gd__pace *pace, struct gd__path_seed *out,
                                            struct gd_detail *detail);
