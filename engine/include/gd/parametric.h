/* Parametric surface: a map from a rectangle of parameters (u, v) to space. It is smooth except
 * across its lines (lines of constant u or v). The geodesic-like solver accesses all surfaces
 * through this interface.
 *
 *     struct gd_parametric *torus;
 *     if (gd_parametric_torus(2, 1, &torus, &detail) == GD_OK) {
 *         struct gd_jet jet;
 *         gd_parametric_evaluate(torus, 0.3, 2.0, &jet);
 *         gd_parametric_release(torus);
 *     }
 *
 * Coordinates are in the caller's length unit. A closed direction is periodic: its parameter may be
 * any real number, and the borders at both ends are the same curve. In other directions the
 * parameter lies within [low, high]. A pole is a border that is one point in space. Surfaces are
 * immutable once created: any number of threads may read them. */
#ifndef GD_PARAMETRIC_H
#define GD_PARAMETRIC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/status.h"
#include "gd/trim.h"
#include "gd/vec.h"

GD_EXTERN_C_BEGIN

struct gd_parametric;

/* Position and derivatives at one (u, v). */
struct gd_jet {
    struct gd_vec3 x, u, v, uu, uv, vv;
};

/* One direction of the domain. */
struct gd_axis {
    double low, high; /* low < high */
    /* true if the borders at `low` and `high` are the same curve; the direction is then periodic */
    bool closed;
    /* true if closed and not smooth across the border; always true for a closed direction with
       lines */
    bool seam;
    bool pole_low, pole_high; /* true if the whole border at `low` or `high` is one point */
    uint32_t line_count;
    /* parameters across which the surface is not smooth, increasing, inside (low, high); may be
       NULL */
    const double *lines;
};

/* The evaluator of a user-defined surface. `jet` computes position and derivatives of the smooth
 * piece (cell_u, cell_v) at (u, v). Piece i lies between lines i - 1 and i. A piece is also
 * evaluated slightly beyond its lines, where it must continue smoothly. `jet` must be thread-safe.
 * In a closed direction without a seam, the parameter may be any real number. */
struct gd_evaluator {
    struct gd_axis u, v; /* the lines are borrowed until `destroy` */
    void (*jet)(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                struct gd_jet *out);
    void (*destroy)(void *shape); /* may be NULL */
    void *shape;
    size_t bytes; /* bytes held by `shape` */
};

/* Creates a surface from an evaluator. The surface owns `shape`, also on failure. The caller
 * declares poles and closed directions; the function verifies them by evaluation. Errors:
 * GD_INVALID_ARGUMENT, with a sentence (a wrong declaration, a domain that is not a rectangle, a
 * position that is not finite), GD_NO_MEMORY. Cost: about a hundred evaluations. The caller owns
 * one reference of `*out`. Thread-safe. */
GD_MUST_USE enum gd_status gd_parametric_create(const struct gd_evaluator *evaluator,
                                                struct gd_parametric **out,
                                                struct gd_detail *detail);

struct gd_parametric *gd_parametric_retain(const struct gd_parametric *surface);
void gd_parametric_release(const struct gd_parametric *surface); /* NULL is allowed */
size_t gd_parametric_memsize(const struct gd_parametric *surface);

/* Return the directions of the domain, borrowed and valid as long as the surface. */
const struct gd_axis *gd_parametric_axis_u(const struct gd_parametric *surface);
const struct gd_axis *gd_parametric_axis_v(const struct gd_parametric *surface);

/* Returns an estimate of the surface's extent: the diagonal of the bounding box of a few hundred
 * points. */
double gd_parametric_size(const struct gd_parametric *surface);

/* Returns true if (u, v) is in the domain. If the domain is trimmed, the tolerance is 1e-9 of its
 * width. In a closed direction, every finite number is in the domain. */
bool gd_parametric_contains(const struct gd_parametric *surface, double u, double v);

/* Computes position and derivatives at a point of the domain. On a line, derivatives are those of
 * the piece above it. On the upper border, they are those of the piece below. Trimming loops are
 * ignored. Error: GD_INVALID_ARGUMENT (outside the rectangle). O(degree^2). Thread-safe. */
GD_MUST_USE enum gd_status gd_parametric_evaluate(const struct gd_parametric *surface, double u,
                                                  double v, struct gd_jet *out);

/* Normal and curvatures of a surface at a point. Source: do Carmo, Differential Geometry of Curves
 * and Surfaces, section 3-3. */
struct gd_curvature {
    struct gd_vec3 normal; /* unit vector along the cross product of the u- and v-derivatives */
    /* gaussian in 1/length^2; mean in 1/length, positive where the surface bends towards the
       normal */
    double gaussian, mean;
    /* false if the derivatives are parallel, for instance at a pole; all other members are zero */
    bool regular;
};

struct gd_curvature gd_jet_curvature(const struct gd_jet *jet);

struct gd_parametric_closest {
    double u, v;
    struct gd_vec3 xyz;
    double distance;
};

/* Computes the point of the surface that is globally closest to `xyz`. On a trimmed surface, this
 * is the closest point within the loops. Applies Newton's method from every grid point that may be
 * near the minimum, and along loops. `control` and `detail` may be NULL. Errors:
 * GD_INVALID_ARGUMENT (not finite, or the square of the distance overflows), GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: about a thousand evaluations. Source: Piegl and
 * Tiller, The NURBS Book, section 6.1. Thread-safe. */
GD_MUST_USE enum gd_status gd_parametric_nearest(const struct gd_parametric *surface,
                                                 struct gd_vec3 xyz,
                                                 const struct gd_control *control,
                                                 struct gd_parametric_closest *out,
                                                 struct gd_detail *detail);

/* --- trimmed surfaces: see gd/trim.h ---------------------------------------------------------- */

/* Creates a trimmed surface, which keeps `surface` alive. `surface` must not be trimmed. `control`
 * and `fault` may be NULL. Errors: GD_INVALID_ARGUMENT (a fault: counts, degrees, knots or weights
 * out of range; a loop that is not closed, that leaves the domain, or that crosses or touches
 * itself or another loop; a hole outside the outer loop or inside another hole), GD_NO_MEMORY,
 * GD_CANCELLED, GD_DEADLINE. The caller owns one reference of `*out`. Cost: a few milliseconds.
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_parametric_trim(const struct gd_parametric *surface,
                                              const struct gd_trims *trims,
                                              const struct gd_control *control,
                                              struct gd_parametric **out,
                                              struct gd_trim_fault *fault);

/* Returns the number of trimming loops, or 0 if the surface is not trimmed. Sets *has_outer to true
 * if the first loop is the outer loop. */
uint32_t gd_parametric_loops(const struct gd_parametric *surface, bool *has_outer);

/* --- analytic surfaces ------------------------------------------------------------------------ */

/* Errors of the following functions: GD_INVALID_ARGUMENT, with a sentence (a number that is not
 * finite or outside its range), GD_NO_MEMORY. */

/* Creates a torus: ((R + r cos v) cos u, (R + r cos v) sin u, r sin v), 0 < r < R; both directions
 * are closed with period 2 pi. */
GD_MUST_USE enum gd_status gd_parametric_torus(double major, double minor,
                                               struct gd_parametric **out,
                                               struct gd_detail *detail);

/* Creates a helicoid: (v cos u, v sin u, pitch u), for u in u_range and v in v_range; pitch is not
 * zero. */
GD_MUST_USE enum gd_status gd_parametric_helicoid(double pitch, const double u_range[2],
                                                  const double v_range[2],
                                                  struct gd_parametric **out,
                                                  struct gd_detail *detail);

#define GD_GRAPH_DEGREE_MAX 16

/* A polynomial that gives the height z = sum of coefficients[i * (degree_v + 1) + j] u^i v^j. */
struct gd_graph {
    uint32_t degree_u, degree_v; /* at most GD_GRAPH_DEGREE_MAX */
    const double *coefficients;
    const double *u_range, *v_range; /* {low, high} */
};

/* Creates the graph of a polynomial: (u, v, z). The arrays are borrowed for the call. */
GD_MUST_USE enum gd_status gd_parametric_graph(const struct gd_graph *graph,
                                               struct gd_parametric **out,
                                               struct gd_detail *detail);

/* A profile in the plane of (radius, height): a clamped or unclamped B-spline or NURBS curve. */
struct gd_profile {
    uint32_t degree, count;
    const double *knots;       /* count + degree + 1 */
    const double (*points)[2]; /* radius >= 0, height */
    const double *weights;     /* > 0; NULL means all 1 */
};

/* Creates a surface of revolution: (r(v) cos u, r(v) sin u, h(v)); u is the angle, closed with
 * period 2 pi; v is the profile's parameter. If an end of the profile is on the axis, it is a pole.
 * Elsewhere the radius must not be 0. */
GD_MUST_USE enum gd_status gd_parametric_revolution(const struct gd_profile *profile,
                                                    struct gd_parametric **out,
                                                    struct gd_detail *detail);

GD_EXTERN_C_END

#endif
