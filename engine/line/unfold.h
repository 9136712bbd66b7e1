/* Unfold: places the faces that a line crosses in one plane. */
#pragma once

#include "gd/path.h"
#include "line/turn.h"

/* The straight line from the first to the last of several points. Normalised unit. */
struct gd__straight {
    /* If the distance of the points is below rounding, the length is 0, and `ahead` and `back` are
     * an arbitrary direction and its opposite. */
    double length;
    /* `ahead`: turn at the first point towards the last; `back`: turn at the last point towards the
     * first */
    double ahead, back;
};

/* Computes the straight line for at least two points of a path. All points except the first and the
 * last must be points of edges. Error: GD_INTERNAL (two consecutive points have no common face).
 * O(count). */
GD_MUST_USE enum gd_status gd__unfold(const struct gd_mesh *mesh, const struct gd_point *points,
                                      uint32_t count, struct gd__straight *out);
