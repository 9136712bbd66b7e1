/* Geodesic-like curves: shortest paths on a parametric surface between points and curves, as
 * B-splines in its domain.
 *
 *     struct gd_geodesic_request request = {.from = from, .to = to};
 *     struct gd_geodesics found;
 *     if (gd_geodesic_solve(tessellation, &request, NULL, &found, &detail) == GD_OK) {
 *         printf("%.17g\n", found.items[0].length);
 *         gd_geodesics_free(&found);
 *     }
 *
 * Source: W.-H. Chen, "Improvement of the shortest path problem with geodesic-like method": among
 * the B-splines of a given order, the one of least energy. Beyond it: pieces that join at the
 * surface's lines, a covariant Newton's method, refinement where the curve bends on the surface,
 * and the global minimum by way of exact geodesics on a tessellation (engine/doc/018). Lengths are
 * in the surface's unit, angles in radians. */
#ifndef GD_GEODESIC_LIKE_H
#define GD_GEODESIC_LIKE_H

#include "gd/domain_curve.h"
#include "gd/tessellation.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GD_GEODESIC_TOLERANCE           1e-11
#define GD_GEODESIC_TOLERANCE_LEAST     1e-14
#define GD_GEODESIC_DEGREE              3
#define GD_GEODESIC_DEGREE_LEAST        2
#define GD_GEODESIC_DEGREE_MOST         5
#define GD_GEODESIC_CONTROL_POINTS_MOST 4096

/* All zero: cubic, to GD_GEODESIC_TOLERANCE, the shortest one. */
struct gd_geodesic_options {
    /* of the spline, GD_GEODESIC_DEGREE_LEAST to GD_GEODESIC_DEGREE_MOST; 0: GD_GEODESIC_DEGREE */
    uint32_t degree;
    /* > degree: the paper's curve, one B-spline of so many over all lines; 0: as many as the
       tolerance needs */
    uint32_t control_points;
    /* error of the length, relative, GD_GEODESIC_TOLERANCE_LEAST to 1; 0: GD_GEODESIC_TOLERANCE */
    double tolerance;
    bool all_minima; /* every local minimum that the seeds lead to, not only the shortest */
};

struct gd_geodesic_request {
    const struct gd_domain_curve *from, *to;   /* points or curves of the tessellation's surface */
    const struct gd_geodesic_options *options; /* NULL: all zero */
};

/* A B-spline piece of the answer: clamped knots on [0, 1], points (u, v). Coordinates of closed
 * directions go on beyond their period. */
struct gd_geodesic_piece {
    uint32_t degree, count;
    double *knots; /* count + degree + 1 */
    double (*points)[2];
};

/* What there is to say of a path besides its numbers; bits. */
enum gd_geodesic_warning {
    /* the tolerance was not met: `error` says how far the length is to be trusted */
    GD_GEODESIC_NOT_CONVERGED = 1,
    GD_GEODESIC_BOUNDARY_CONTACT = 2, /* it follows the border of the domain for a while */
    /* it ends in a corner or at an end of a curve, not at a right angle */
    GD_GEODESIC_CURVE_CORNER = 4,
    /* it passes a pole: two pieces meet there with different (u, v) */
    GD_GEODESIC_THROUGH_POLE = 8,
    /* critical, but not proved to be a minimum: the Hessian is not positive definite */
    GD_GEODESIC_NOT_MINIMAL = 16
};

struct gd_geodesic {
    double length;
    double error;                        /* estimate of the length's error, in its unit */
    double from_parameter, to_parameter; /* on the curves, in their ranges; 0 for a point */
    double from_angle, to_angle;         /* between path and curve, 0 to pi; pi / 2 for a point */
    double residual;                     /* norm of the gradient of the length, relative */
    /* int of squared geodesic curvature by arc length: 1/length */
    double curvature;
    /* (2 E - L^2) / L^2 over the pieces: how uneven the speed is */
    double speed_defect;
    uint32_t iterations; /* of Newton's method, in all */
    /* the Hessian is positive definite: a proved local minimum among curves near it */
    bool is_minimum;
    uint32_t warnings;    /* enum gd_geodesic_warning */
    uint32_t piece_count; /* 0 where from and to meet */
    struct gd_geodesic_piece *pieces;
    double meeting[2]; /* (u, v) where they meet, piece_count 0 */
};

struct gd_geodesics {
    uint32_t count; /* at least 1, by length */
    struct gd_geodesic *items;
};

void gd_geodesics_free(struct gd_geodesics *geodesics); /* NULL is harmless */

/* The shortest path between two points or curves of the tessellation's surface; with `all_minima`
 * also longer ones that are local minima. Paths that are no minima are never among minima: when
 * nothing better was found, the answer is one path with GD_GEODESIC_NOT_MINIMAL. Curves that meet:
 * length 0, no pieces. The result does not depend on which of the two is `from`, up to rounding.
 * The search for the global minimum is as good as the tessellation: it must tell the ways around
 * the surface's features apart. `control` and `detail` may be NULL. Errors:
 * GD_INVALID_ARGUMENT (a curve of another surface, options out of range), those of gd_field_build,
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL (no path could be followed at
 * all). Cost: two fields of the tessellation and some 20 Newton steps, milliseconds.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_geodesic_solve(const struct gd_tessellation *tessellation,
                                             const struct gd_geodesic_request *request,
                                             const struct gd_control *control,
                                             struct gd_geodesics *out, struct gd_detail *detail);

/* Points of a path: `count` >= 2 of them at even parameters through all pieces, to `uv` and `xyz`
 * (either may be NULL), from its beginning to its end. GD_INVALID_ARGUMENT: fewer than 2, or a path
 * without pieces. */
GD_MUST_USE enum gd_status gd_geodesic_sample(const struct gd_parametric *surface,
                                              const struct gd_geodesic *geodesic, uint32_t count,
                                              double (*uv)[2], struct gd_vec3 *xyz);

#ifdef __cplusplus
}
#endif

#endif
