/* Trim: the loops of a trimmed surface. A trimmed surface is the part of a parametric surface that
 * is inside an outer loop and outside holes. gd_parametric_trim (gd/parametric.h) makes it.
 *
 *     struct gd_trim_curve circle = {.degree = 2, .count = 9, .points = …, .weights = …, …};
 *     struct gd_trim_loop hole = {&circle, 1};
 *     struct gd_trims trims = {.loops = &hole, .count = 1};
 *     if (gd_parametric_trim(plane, &trims, NULL, &trimmed, &fault) == GD_OK) …
 *
 * A loop is a closed chain of polylines and rational B-spline curves in the parameter plane. A
 * trimmed surface is a gd_parametric: gd_parametric_contains and gd_parametric_nearest respect the
 * loops, gd_tessellation_build triangulates the domain up to its loops, and gd_geodesic_solve finds
 * the shortest paths that do not leave the domain. gd_parametric_evaluate ignores the loops. */
#ifndef GD_TRIM_H
#define GD_TRIM_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/status.h"

GD_EXTERN_C_BEGIN

#define GD_TRIM_LOOPS_MAX  256
#define GD_TRIM_CURVES_MAX 1024 /* largest number of curves in one loop */
#define GD_TRIM_POINTS_MAX 4096 /* largest number of points in all loops */
#define GD_TRIM_DEGREE_MAX 15

/* A part of a loop. If `knots` is NULL, a curve of degree 1 is a polyline, and a curve of higher
 * degree is a Bézier curve with degree + 1 points. */
struct gd_trim_curve {
    uint32_t degree, count;
    const double (*points)[2]; /* (u, v), not multiplied by weights */
    const double *weights;     /* > 0; NULL means that all are 1 */
    const double *knots;       /* count + degree + 1 */
};

/* Each curve ends where the next curve begins; the last one ends where the first one begins. */
struct gd_trim_loop {
    const struct gd_trim_curve *curves;
    uint32_t count;
};

/* Borrowed for the call. Loops may run in either direction. */
struct gd_trims {
    const struct gd_trim_loop *loops;
    uint32_t count; /* at least 1 */
    /* True if loops[0] is the outer loop. False if all loops are holes; the domain then extends to
       the borders of the surface and across the seams of closed directions. Holes must not touch
       the borders or cross the seams. */
    bool has_outer;
};

/* The first fault: the numbers of the loop and of its curve, and a sentence. */
struct gd_trim_fault {
    uint32_t loop, curve;
    struct gd_detail detail;
};

GD_EXTERN_C_END

#endif
