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
 * Source: W.-H. Chen, "Improvement of the shortest path problem with geodesic-like method". The
 * paper computes the B-spline of least energy among all B-splines of a given order. This
 * implementation extends the paper. Paths are divided into pieces at the surface's lines (lines of
 * constant u or v across which the surface is not smooth). Newton's method is covariant. Paths are
 * refined where the geodesic curvature is large. Exact geodesics on a tessellation serve to find
 * the global minimum (engine/doc/018). Lengths are in the surface's unit, angles in radians. */
#ifndef GD_GEODESIC_LIKE_H
#define GD_GEODESIC_LIKE_H

#include "gd/domain_curve.h"
#include "gd/tessellation.h"

GD_EXTERN_C_BEGIN

#define GD_GEODESIC_TOLERANCE           1e-11
#define GD_GEODESIC_TOLERANCE_LEAST     1e-14
#define GD_GEODESIC_DEGREE              3
#define GD_GEODESIC_DEGREE_LEAST        2
#define GD_GEODESIC_DEGREE_MOST         5
#define GD_GEODESIC_CONTROL_POINTS_MOST 4096
#define GD_GEODESIC_TURN_LIMIT_MOST     4
#define GD_GEODESIC_TURNS_MOST          16

/* If all members are zero, the result is the shortest path, as cubic splines, with the tolerance
 * GD_GEODESIC_TOLERANCE. */
struct gd_geodesic_options {
    /* degree of the spline, GD_GEODESIC_DEGREE_LEAST to GD_GEODESIC_DEGREE_MOST; 0 means
       GD_GEODESIC_DEGREE */
    uint32_t degree;
    /* If not 0, the result is the paper's curve: one B-spline with this number of control points
       (more than the degree), which ignores the surface's lines. 0 means as many control points as
       the tolerance needs. */
    uint32_t control_points;
    /* relative error of the length, GD_GEODESIC_TOLERANCE_LEAST to 1; 0 means
       GD_GEODESIC_TOLERANCE */
    double tolerance;
    /* true if all local minima that the search finds are returned, not only the shortest */
    bool all_minima;
    /* Used with all_minima, on surfaces that are closed in a direction. If not 0, the search also
     * starts from paths of each homotopy class whose winding numbers are within this limit, at most
     * GD_GEODESIC_TURN_LIMIT_MOST. If 0, it starts only from candidates that are found from
     * distances on the tessellation. */
    uint32_t turn_limit;
};

/* The members that a request has in addition to its options. */
struct gd_geodesic_members {
    bool initial, turns, curve; /* `curve`: one of the ends is a curve */
};

/* Returns the name of the first member of the request that trimmed surfaces do not support, such as
 * "degree", and sets *reason to a sentence. Returns NULL if there is none. O(1). */
const char *gd_geodesic_untrimmed_only(const struct gd_geodesic_options *options,
                                       const struct gd_geodesic_members *members,
                                       const char **reason);

struct gd_geodesic_request {
    const struct gd_domain_curve *from, *to;   /* points or curves of the tessellation's surface */
    const struct gd_geodesic_options *options; /* NULL means all zero */
    /* `initial` and `turns` select a class of paths. At most one of the two may be set, and neither
     * of them together with all_minima. The result is then a geodesic of this class, not the
     * shortest path of all classes. */
    /* a curve from `from` to `to`, which is deformed into the result */
    const struct gd_domain_curve *initial;
    /* winding numbers in u and v (see gd_geodesic.turns): at most GD_GEODESIC_TURNS_MOST in closed
       directions, and 0 in others */
    const int32_t *turns;
};

/* A B-spline piece of the result, with clamped knots on [0, 1] and control points (u, v). In closed
 * directions, coordinates may be outside the domain by whole periods. */
struct gd_geodesic_piece {
    uint32_t degree, count;
    double *knots; /* count + degree + 1 */
    double (*points)[2];
};

/* Warnings about a path, as bits of a number. */
enum gd_geodesic_warning {
    /* The tolerance was not met; `error` bounds the error of the length. If Newton's method did not
       converge, this bound is the length without the distance of the ends in space. This is the
       case if the shortest path bends where two creases of the surface cross. */
    GD_GEODESIC_NOT_CONVERGED = 1,
    GD_GEODESIC_BOUNDARY_CONTACT = 2, /* part of the path follows the border of the domain */
    /* the path ends at a corner or an end of a curve, so its angle with the curve may not be a
       right angle */
    GD_GEODESIC_CURVE_CORNER = 4,
    /* the path passes a pole, where two pieces with different (u, v) meet */
    GD_GEODESIC_THROUGH_POLE = 8,
    /* the path is a critical point of the length, but not a proven minimum, because the Hessian is
       not positive definite */
    GD_GEODESIC_NOT_MINIMAL = 16,
    /* the path belongs to a family of equally long paths, of which only one is listed */
    GD_GEODESIC_FAMILY = 32
};

struct gd_geodesic {
    double length;
    double error;                        /* estimated error of the length, in the same unit */
    double from_parameter, to_parameter; /* parameters on the curves; 0 for a point */
    /* angles between path and curves, in [0, pi]; pi / 2 for a point */
    double from_angle, to_angle;
    double residual; /* relative norm of the gradient of the length */
    /* integral of the squared geodesic curvature over arc length, in 1/length */
    double curvature;
    /* sum of |2 E - L^2| over the pieces (with energy E and length L), divided by the square of the
       path's length; 0 for constant speed */
    double speed_defect;
    uint32_t iterations; /* total number of Newton steps */
    /* true if the Hessian is positive definite, so that the path is a proven local minimum */
    bool is_minimum;
    uint32_t warnings;    /* enum gd_geodesic_warning */
    uint32_t piece_count; /* 0 if `from` and `to` meet */
    struct gd_geodesic_piece *pieces;
    /* Winding numbers. If the path begins at the coordinates (u, v) of `from`, it ends at the
       coordinates of `to` plus these numbers of periods. If the path joins closed curves, the
       winding numbers depend on the parameters of its ends. */
    int32_t turns[2];
    double meeting[2]; /* (u, v) where `from` and `to` meet, if piece_count is 0 */
};

struct gd_geodesics {
    uint32_t count; /* at least 1 */
    struct gd_geodesic *items;
};

void gd_geodesics_free(struct gd_geodesics *geodesics); /* NULL is allowed */

/* Computes the shortest path between two points or curves of the tessellation's surface. With
 * `all_minima`, also computes longer local minima, sorted by length. These paths do not cross
 * `from` or `to` between their ends. Only one path of each family of equally long paths is listed.
 * If no path is a minimum, the result is one path with GD_GEODESIC_NOT_MINIMAL. If `from` and `to`
 * meet, the path has length 0 and no pieces. If `from` and `to` are exchanged, the result changes
 * only by rounding. The function finds the global minimum if the tessellation is fine enough to
 * distinguish the routes around the surface's features. `control` and `detail` may be NULL; the
 * caller frees `*out` by gd_geodesics_free. Errors: GD_INVALID_ARGUMENT (a curve of another
 * surface, options out of range), those of gd_field_build, GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE, GD_INTERNAL (no path converged). Cost: milliseconds, for two fields of the
 * tessellation and about 20 Newton steps. Thread-safe. */
GD_MUST_USE enum gd_status gd_geodesic_solve(const struct gd_tessellation *tessellation,
                                             const struct gd_geodesic_request *request,
                                             const struct gd_control *control,
                                             struct gd_geodesics *out, struct gd_detail *detail);

/* Samples a path at `count` >= 2 equally spaced parameters over all pieces, including both ends.
 * Writes the points to `uv` and `xyz`, each of which may be NULL. Error: GD_INVALID_ARGUMENT (count
 * < 2, or a path without pieces). O(count). Thread-safe. */
GD_MUST_USE enum gd_status gd_geodesic_sample(const struct gd_parametric *surface,
                                              const struct gd_geodesic *geodesic, uint32_t count,
                                              double (*uv)[2], struct gd_vec3 *xyz);

GD_EXTERN_C_END

#endif
