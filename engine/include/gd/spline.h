/* Spline: a geodesic Hermite spline, that is a smooth curve on the surface through given points.
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
 * parameter u_i = u_(i-1) + d(p_i, p_(i-1))^alpha and a tangent v_i, a vector by unit of the
 * parameter. Between two points the curve is the cubic of Bezier with the control points p_i,
 * p_i (+) (D/3) v_i, p_(i+1) (+) (-D/3) v_(i+1), p_(i+1), D being the difference of their
 * parameters: lines become geodesics. Where the surface is flat it is the classical Hermite spline.
 *
 * Between control points the curve is what halving them for ever leads to: de Casteljau's
 * construction with parameter 1/2, geodesics being those that the polygon becomes when it is pulled
 * tight (so that they don't jump where shortest paths do). Halving stops where a polygon departs so
 * little from its chord that the construction may be used with any parameter. */
#ifndef GD_SPLINE_H
#define GD_SPLINE_H

#include "gd/curve.h"
#include "gd/executor.h"
#include "gd/landmarks.h"
#include "gd/vector.h"

#ifdef __cplusplus
extern "C" {
#endif

enum gd_tangent_rule {
    /* (1-c) (p_(i+1) (-) p_i - p_(i-1) (-) p_i) / (u_(i+1) - u_(i-1)): reversed points, reversed
       curve */
    GD_TANGENT_SYMMETRIC,
    /* (1-c) (p_(i+1) (-) p_(i-1)) / (u_(i+1) - u_(i-1)), moved from p_(i-1) to p_i: equation 5 */
    GD_TANGENT_PAPER
};

enum gd_end_rule {
    GD_END_NATURAL, /* (3/2) (p_1 (-) p_0) / D - v_1 / 2: the curve ends straight */
    GD_END_ZERO     /* the paper's: no tangent */
};

struct gd_spline_request {
    /* at least 2, consecutive ones apart and of one component; borrowed */
    const struct gd_point *points;
    uint32_t count;
    /* the last is joined to the first, which is not repeated; two points: there and back */
    bool closed;
    double alpha; /* from 0 to 1: 0 uniform, 1/2 centripetal, 1 chordal */
    /* c: 0 (Catmull and Rom) to 1: the tangents of inner points are 0, the curve is a geodesic
       polyline */
    double tension;
    enum gd_tangent_rule tangent_rule;
    enum gd_end_rule end_rule;
    /* one for each point; NULL: by the rules. Only angles and lengths are read */
    const struct gd_vector *tangents;
    /* whether a point's tangent counts; NULL: all of `tangents` do */
    const bool *is_given;
    const struct gd_landmarks *landmarks;      /* of this mesh: searches are narrower; NULL: none */
    const struct gd_spline_sampling *sampling; /* of gd_spline_curve, which sets its spline */
    /* two searches, then two segments at a time; NULL: one after the other. The answer is the
       same */
    const struct gd_executor *executor;
};

/* What the spline has at a point. */
struct gd_spline_knot {
    double parameter;
    struct gd_vector tangent;
    /* radians between the curve that comes and the one that goes, and the difference of their
       speeds relative to the greater one, as measured on the control polygon; 0 at ends: a clipped
       leg shows here */
    double angle_jump;
    double speed_jump;
};

struct gd_spline_segment {
    struct gd_point control[4];
    struct gd_path legs[3]; /* geodesics between them, in the caller's unit */
    double begin, end;      /* parameters */
    double distance;        /* between control[0] and control[3] */
    bool is_clipped;        /* a tangent leads over the boundary: its leg ends there */
    /* control[0] and control[3] lie on each other's cut locus: another way between them is as
       short, so that the curve may jump there when a point is moved */
    bool is_cut;
};

/* Owns its arrays. */
struct gd_spline {
    bool closed;
    uint32_t count; /* segments */
    struct gd_spline_segment *segments;
    /* count + 1; of a closed one the last is the first again, one period later */
    struct gd_spline_knot *knots;
};

void gd_spline_free(struct gd_spline *spline); /* frees the arrays and zeroes; NULL is harmless */

/* The spline of a request. `control` and `detail` may be NULL. Where a point is at fault,
 * detail->elements[0][0] is its number and detail->count 1.
 * Errors: GD_INVALID_ARGUMENT (too few points, points that repeat the one before, alpha or tension
 * outside 0 to 1, a tangent that is not finite or so long that its geodesic is no end of, points
 * that no path joins), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, and what gd_pair_solve
 * says. Cost: a search a segment (by the paper's rule one more an inner point), and two traces.
 * With an executor of width 2 or more all this takes about half as long and up to twice the memory,
 * within the same budget. Thread-safe. */
GD_MUST_USE enum gd_status gd_spline_build(const struct gd_mesh *mesh,
                                           const struct gd_spline_request *request,
                                           const struct gd_control *control, struct gd_spline *out,
                                           struct gd_detail *detail);

#define GD_SPLINE_PLACES (1u << 20) /* most places of one sampling */

/* Where the curve is looked at: exactly one of the members after `spline` is not 0. */
struct gd_spline_sampling {
    const struct gd_spline *spline;
    uint32_t per_segment; /* equal steps of the parameter, so many a segment */
    uint32_t even;        /* equal arc lengths, so many in all: constant speed */
    /* a length: the polyline departs from the curve by no more, but for the surface's curvature
       within a step of it */
    double tolerance;
    /* a length: equal arc lengths as near to it as a whole number of them allows; to about 1e-6 of
       it */
    double spacing;
    const double *parameters; /* ascending, within the knots' */
    uint32_t count;           /* of them */
};

/* A place of the curve. */
struct gd_spline_place {
    double parameter;
    struct gd_point point;
    /* where the speed is 0: the direction in which the curve goes on */
    struct gd_direction tangent;
    double speed; /* length by unit of the parameter */
};

struct gd_spline_line {
    struct gd_path path; /* through all places, joined by geodesics */
    struct gd_spline_place *places;
    uint32_t count;
    double step; /* arc length between two places, of `even` and `spacing`; else 0 */
};

void gd_spline_line_free(struct gd_spline_line *line); /* NULL is harmless */

/* The curve as a polyline, and its places. Errors: GD_INVALID_ARGUMENT (none or several ways of
 * sampling, a number that is out of range), GD_TOO_LARGE (more than GD_SPLINE_PLACES),
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL. Cost: about four lines pulled
 * tight a halving, each O(faces that it crosses); three a place. Thread-safe. */
GD_MUST_USE enum gd_status gd_spline_sample(const struct gd_mesh *mesh,
                                            const struct gd_spline_sampling *sampling,
                                            const struct gd_control *control,
                                            struct gd_spline_line *out, struct gd_detail *detail);

/* The same as a curve (gd/curve.h), for all that takes one; the caller frees it by gd_curve_free.
 * Errors: those of both. */
GD_MUST_USE enum gd_status gd_spline_curve(const struct gd_mesh *mesh,
                                           const struct gd_spline_request *request,
                                           const struct gd_control *control, struct gd_curve *out,
                                           struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
