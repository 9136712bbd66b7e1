/* Spline: a geodesic Hermite spline, a smooth curve on the surface through given points.
 *
 *     struct gd_spline_request request = {
 *         .points = points, .count = 5, .closed = true, .alpha = 0.5};
 *     struct gd_spline spline;
 *     if (gd_spline_build(mesh, &request, NULL, &spline, &detail) == GD_OK) {
 *         struct gd_spline_line line;
 *         struct gd_spline_sampling sampling = {.spline = &spline, .per_segment = 16};
 *         if (gd_spline_sample(mesh, &sampling, NULL, &line, &detail) == GD_OK) {
 *             printf("%u points, length %g\n", line.path.count, line.path.length);
 *             gd_spline_line_free(&line);
 *         }
 *         gd_spline_free(&spline);
 *     }
 *
 * Source: "Geodesic Hermite splines on triangular meshes", equations 4 to 6. Point i has the
 * parameter u_i = u_(i-1) + d(p_i, p_(i-1))^alpha and a tangent v_i, the derivative by the
 * parameter. Let D = u_(i+1) - u_i. Between points i and i + 1 the curve is the cubic geodesic
 * Bezier curve with the control points p_i, p_i (+) (D/3) v_i, p_(i+1) (+) (-D/3) v_(i+1), p_(i+1):
 * geodesics replace straight lines. On a flat surface it is the classical Hermite spline.
 * gd/vector.h defines (+) and (-).
 *
 * The curve is the limit of repeated halving of the control polygons by de Casteljau's construction
 * with parameter 1/2. Each new geodesic of the construction is the part of the polygon between its
 * ends, straightened. These geodesics change continuously where shortest paths would jump. Halving
 * stops when a polygon is so close to its chord that the construction is accurate for any
 * parameter. */
#ifndef GD_SPLINE_H
#define GD_SPLINE_H

#include "gd/curve.h"
#include "gd/executor.h"
#include "gd/landmarks.h"
#include "gd/vector.h"

GD_EXTERN_C_BEGIN

enum gd_tangent_rule {
    /* (1-c) ((p_(i+1) (-) p_i) - (p_(i-1) (-) p_i)) / (u_(i+1) - u_(i-1)), where c is `tension`.
       Points in reverse order give the same curve in reverse. */
    GD_TANGENT_SYMMETRIC,
    /* (1-c) (p_(i+1) (-) p_(i-1)) / (u_(i+1) - u_(i-1)), transported from p_(i-1) to p_i: equation
       5 */
    GD_TANGENT_PAPER
};

enum gd_end_rule {
    GD_END_NATURAL, /* (3/2) (p_1 (-) p_0) / D - v_1 / 2; the curvature at the end is 0 */
    GD_END_ZERO     /* zero tangent, as in the paper */
};

struct gd_spline_request {
    /* borrowed; at least 2, all on one component; consecutive points differ */
    const struct gd_point *points;
    uint32_t count;
    /* true if the last point is joined to the first, which is not repeated; a closed spline of two
       points runs from the first to the second and back */
    bool closed;
    double alpha; /* in [0, 1]: 0 uniform, 1/2 centripetal, 1 chordal */
    /* c, from 0 (Catmull-Rom) to 1 (tangents of inner points are 0, and the curve is a geodesic
       polyline) */
    double tension;
    enum gd_tangent_rule tangent_rule;
    enum gd_end_rule end_rule;
    /* One tangent for each point; only its angle and length are used. NULL means that the rules
       determine all tangents. */
    const struct gd_vector *tangents;
    /* for each point, true if its entry of `tangents` is used; NULL means that all entries are
       used */
    const bool *is_given;
    /* landmarks of the same mesh, which make searches faster; may be NULL */
    const struct gd_landmarks *landmarks;
    /* only used by gd_spline_curve, which ignores sampling->spline */
    const struct gd_spline_sampling *sampling;
    /* With an executor, two searches run at a time, and then two segments are computed at a time.
     * NULL means one at a time. The result is the same. */
    const struct gd_executor *executor;
};

/* A point of the spline. */
struct gd_spline_knot {
    double parameter;
    struct gd_vector tangent;
    /* `angle_jump` is the angle between the arriving and the leaving curve, in radians.
       `speed_jump` is the difference of their speeds, divided by the greater speed. Both are
       measured on the control polygon. They are 0 at the ends of an open spline. They are not 0 at
       a knot with a clipped arm. If the speed is 0, the angle is that between the limits of the
       curve's tangents. */
    double angle_jump;
    double speed_jump;
};

struct gd_spline_segment {
    struct gd_point control[4];
    struct gd_path arms[3]; /* geodesics between consecutive control points, in the caller's unit */
    double begin, end;      /* parameters of control[0] and control[3] */
    double distance;        /* distance between control[0] and control[3] */
    /* true if a tangent leads over the boundary; its arm then ends at the boundary */
    bool is_clipped;
    /* true if control[0] and control[3] lie on each other's cut locus: another path between them is
       equally short, so the curve may jump if a point is moved */
    bool is_cut;
};

/* Owns its arrays. */
struct gd_spline {
    bool closed;
    uint32_t count; /* number of segments */
    struct gd_spline_segment *segments;
    /* count + 1 knots; the last knot of a closed spline is its first knot, one period later */
    struct gd_spline_knot *knots;
};

/* Frees the arrays and zeroes the struct. NULL is allowed. */
void gd_spline_free(struct gd_spline *spline);

/* Builds the spline of a request. The caller frees `*out` by gd_spline_free. `control` and `detail`
 * may be NULL. If one point causes an error, detail->elements[0][0] is its number and detail->count
 * is 1. Errors: GD_INVALID_ARGUMENT (too few points, equal consecutive points, alpha or tension
 * outside 0 to 1, a tangent that is not finite or whose geodesic crosses too many edges, points on
 * different components), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, and those of
 * gd_pair_solve. Cost: a search and two traces for each segment; with GD_TANGENT_PAPER one more
 * search for each inner point. An executor of width 2 or more halves the time and takes up to twice
 * the memory, within the same budget. Thread-safe. */
GD_MUST_USE enum gd_status gd_spline_build(const struct gd_mesh *mesh,
                                           const struct gd_spline_request *request,
                                           const struct gd_control *control, struct gd_spline *out,
                                           struct gd_detail *detail);

#define GD_SPLINE_PLACES (1u << 20) /* largest number of places of one sampling */

enum gd_spline_evaluation {
    GD_SPLINE_HALVING,
    /* De Casteljau's construction at each parameter, from the segment's four control points, as the
       paper defines the curve. In the plane, the result equals that of halving. On curved surfaces
       it differs, and the speed jumps where geodesics of the construction jump. */
    GD_SPLINE_DE_CASTELJAU
};

/* Parameters at which to sample a spline. Exactly one of per_segment, even, tolerance, spacing and
 * parameters is not 0. */
struct gd_spline_sampling {
    const struct gd_spline *spline;
    uint32_t per_segment; /* number of equal steps of the parameter for each segment */
    uint32_t even;        /* total number of equal steps of arc length */
    /* largest distance between polyline and curve, in the unit of the mesh. The surface's curvature
       within a step can make the distance larger. */
    double tolerance;
    /* Arc length of a step. All steps have the same arc length, with an error of about 1e-6. The
       arc length is as near to `spacing` as a whole number of steps allows. */
    double spacing;
    const double *parameters; /* ascending, within the range of the knots */
    uint32_t count;           /* number of `parameters` */
    /* GD_SPLINE_DE_CASTELJAU only with per_segment or parameters */
    enum gd_spline_evaluation evaluation;
};

/* A sampled point of the curve. */
struct gd_spline_place {
    double parameter;
    struct gd_point point;
    /* unit tangent of the curve; also defined where the speed is 0 */
    struct gd_direction tangent;
    double speed; /* length of the curve per unit of the parameter */
    double along; /* length of the line's path up to this place */
};

struct gd_spline_line {
    struct gd_path path; /* the path through all places, which are joined by geodesics */
    struct gd_spline_place *places;
    uint32_t count;
    double step; /* with `even` or `spacing`, arc length between two places; otherwise 0 */
};

void gd_spline_line_free(struct gd_spline_line *line); /* NULL is allowed */

/* Samples a spline as a polyline through the sampled places. The caller frees `*out` by
 * gd_spline_line_free. Errors: GD_INVALID_ARGUMENT (none or several of the members that select
 * parameters are set, or a number is out of range), GD_TOO_LARGE (more than GD_SPLINE_PLACES),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL. Cost: about four straightened
 * lines for each halving and three for each place; a straightened line takes O(crossed faces).
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_spline_sample(const struct gd_mesh *mesh,
                                            const struct gd_spline_sampling *sampling,
                                            const struct gd_control *control,
                                            struct gd_spline_line *out, struct gd_detail *detail);

/* Builds and samples a spline as a curve (gd/curve.h); the caller frees `*out` by gd_curve_free.
 * Errors: those of gd_spline_build and gd_spline_sample. Thread-safe. */
GD_MUST_USE enum gd_status gd_spline_curve(const struct gd_mesh *mesh,
                                           const struct gd_spline_request *request,
                                           const struct gd_control *control, struct gd_curve *out,
                                           struct gd_detail *detail);

GD_EXTERN_C_END

#endif
