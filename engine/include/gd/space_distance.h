/* Space distance: the distance between points or curves in space, by the geodesic-like method with
 * space as the surface.
 *
 * In space the curve of least energy between two fixed ends is the straight segment, so the only
 * unknowns are the ends' parameters on the curves: W.-H. Chen, "Improvement of the shortest path
 * problem with geodesic-like method", equations (12) to (14) in R^3. */
#ifndef GD_SPACE_DISTANCE_H
#define GD_SPACE_DISTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/status.h"
#include "gd/vec.h"

GD_EXTERN_C_BEGIN

#define GD_SPACE_CURVE_COUNT_MAX 65536

/* A B-spline in space, borrowed. Degree 0 with one point and no knots represents a point. Degree 1
 * represents a polyline. */
struct gd_space_curve {
    uint32_t degree, count;
    const double *knots; /* count + degree + 1 */
    const struct gd_vec3 *points;
};

struct gd_space_closest {
    double distance;
    double from_parameter, to_parameter; /* 0 for a point */
    struct gd_vec3 from, to;
};

/* Computes the distance of two curves and their closest points. The method finds the global
 * minimum: branch and bound over the curves' spans (a span lies in the convex hull of its control
 * points), then Newton's method with second derivatives. The choice between several closest pairs
 * is deterministic. Errors: GD_INVALID_ARGUMENT with a sentence (numbers that are not finite,
 * invalid knots, degree or count out of range), GD_NO_MEMORY. Cost: microseconds to milliseconds.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_space_distance(const struct gd_space_curve *from,
                                             const struct gd_space_curve *to,
                                             struct gd_space_closest *out,
                                             struct gd_detail *detail);

GD_EXTERN_C_END

#endif
