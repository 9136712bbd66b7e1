/* Space distance: between points and curves of space, what the geodesic-like method is when the
 * surface is space itself.
 *
 * There the curve of least energy between two fixed ends is the straight segment, so of the
 * method's unknowns only the two ends on the curves remain: W.-H. Chen, "Improvement of the
 * shortest path problem with geodesic-like method", equations (12) to (14) in R^3. */
#ifndef GD_SPACE_DISTANCE_H
#define GD_SPACE_DISTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/status.h"
#include "gd/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GD_SPACE_CURVE_COUNT_MAX 65536

/* A B-spline in space, borrowed; `degree` 0 with one point: a point (no knots). A polyline has
 * degree 1. */
struct gd_space_curve {
    uint32_t degree, count;
    const double *knots; /* count + degree + 1 */
    const struct gd_vec3 *points;
};

struct gd_space_foot {
    double distance;
    double from_parameter, to_parameter; /* 0 for a point */
    struct gd_vec3 from, to;
};

/* The distance of two curves and where it is attained: the global minimum, by branch and bound over
 * the curves' spans (each span lies in the hull of its control points) and Newton's method with the
 * terms of the curves' bend. Of several such places one, always the same. Errors:
 * GD_INVALID_ARGUMENT with a sentence (numbers that are not finite, knots that are no knots, degree
 * or count out of range), GD_NO_MEMORY. Cost: microseconds to milliseconds. Thread-safe. */
GD_MUST_USE enum gd_status gd_space_distance(const struct gd_space_curve *from,
                                             const struct gd_space_curve *to,
                                             struct gd_space_foot *out, struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
