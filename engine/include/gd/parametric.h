/* Parametric surface: a map from a rectangle (u, v) to space, smooth between its lines. What the
 * geodesic-like solver sees of any surface.
 *
 *     struct gd_parametric *torus;
 *     if (gd_parametric_torus(2, 1, &torus, &detail) == GD_OK) {
 *         struct gd_jet jet;
 *         gd_parametric_evaluate(torus, 0.3, 2.0, &jet);
 *         gd_parametric_release(torus);
 *     }
 *
 * Coordinates are in the caller's length unit. A closed direction is periodic: any real parameter
 * is taken, its ends are one curve. Other parameters lie within [low, high]. A border that is one
 * point of space is a pole. Surfaces are immutable once made: any number of threads may read
 * them. */
#ifndef GD_PARAMETRIC_H
#define GD_PARAMETRIC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/control.h"
#include "gd/status.h"
#include "gd/vec.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_parametric;

/* Position and derivatives at a place. */
struct gd_jet {
    struct gd_vec3 x, u, v, uu, uv, vv;
};

/* One direction of the domain. */
struct gd_axis {
    double low, high; /* low < high */
    bool closed;      /* the borders at low and high are one curve: periodic */
    /* closed, and smooth there on both sides only; always true when there are lines */
    bool seam;
    bool pole_low, pole_high; /* the whole border at low, at high is one point */
    uint32_t line_count;
    /* increasing, inside (low, high): there the surface is smooth on both sides only; NULL
       without */
    const double *lines;
};

/* A surface by its evaluator. `jet` gives position and derivatives of the smooth piece number
 * (cell_u, cell_v) at (u, v): piece i lies between lines i - 1 and i, and is asked a little beyond
 * them too, where it goes on smoothly. It must be thread-safe. In a closed direction without seam
 * (u, v) are any reals. */
struct gd_evaluator {
    struct gd_axis u, v; /* the lines are borrowed until `destroy` */
    void (*jet)(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                struct gd_jet *out);
    void (*destroy)(void *shape); /* may be NULL */
    void *shape;
    size_t bytes; /* that `shape` holds */
};

/* A surface from an evaluator; its shape is the surface's from then on, also on failure. Poles and
 * closed directions are as the caller says; which is checked by evaluation: GD_INVALID_ARGUMENT,
 * with a sentence, when they are not, when the domain is no rectangle or when a position is no
 * number. GD_NO_MEMORY. Cost: some hundred evaluations. The caller owns one reference of `*out`. */
GD_MUST_USE enum gd_status gd_parametric_create(const struct gd_evaluator *evaluator,
                                                struct gd_parametric **out,
                                                struct gd_detail *detail);

struct gd_parametric *gd_parametric_retain(const struct gd_parametric *surface);
void gd_parametric_release(const struct gd_parametric *surface); /* NULL is harmless */
size_t gd_parametric_memsize(const struct gd_parametric *surface);

/* The directions: borrowed, valid as long as the surface. */
const struct gd_axis *gd_parametric_axis_u(const struct gd_parametric *surface);
const struct gd_axis *gd_parametric_axis_v(const struct gd_parametric *surface);

/* A length of the order of the surface's extent: the diagonal of the box of a few hundred of its
 * points. */
double gd_parametric_size(const struct gd_parametric *surface);

/* Is (u, v) in the domain? In closed directions every finite number is. */
bool gd_parametric_contains(const struct gd_parametric *surface, double u, double v);

/* Position and derivatives at a place of the domain. On a line they are those of the piece above
 * it, on the upper border those below. GD_INVALID_ARGUMENT: outside. O(degree^2). */
GD_MUST_USE enum gd_status gd_parametric_evaluate(const struct gd_parametric *surface, double u,
                                                  double v, struct gd_jet *out);

/* Normal and curvatures from a jet. do Carmo, Differential Geometry of Curves and Surfaces, section
 * 3-3. */
struct gd_curvature {
    struct gd_vec3 normal; /* unit, u-derivative times v-derivative */
    /* 1/length^2; 1/length, positive where the surface bends towards the normal */
    double gaussian, mean;
    /* false: the derivatives are parallel, at a pole for instance; all else is zero then */
    bool regular;
};

struct gd_curvature gd_jet_curvature(const struct gd_jet *jet);

struct gd_parametric_foot {
    double u, v;
    struct gd_vec3 xyz;
    double distance;
};

/* The point of the surface nearest to `xyz`: the global one, looked for by Newton's method from
 * every place of a dense grid that can be near it.
 * `control` and `detail` may be NULL. Errors: GD_INVALID_ARGUMENT (not finite), GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: some thousand evaluations. Piegl and Tiller, The
 * NURBS Book, section 6.1. */
GD_MUST_USE enum gd_status gd_parametric_nearest(const struct gd_parametric *surface,
                                                 struct gd_vec3 xyz,
                                                 const struct gd_control *control,
                                                 struct gd_parametric_foot *out,
                                                 struct gd_detail *detail);

/* --- surfaces of known shape
 * ------------------------------------------------------------------------------------------ Each:
 * GD_INVALID_ARGUMENT with a sentence when a number is not finite or outside its range,
 * GD_NO_MEMORY. */

/* ((R + r cos v) cos u, (R + r cos v) sin u, r sin v), 0 < r < R; both directions closed with
 * period 2 pi. */
GD_MUST_USE enum gd_status gd_parametric_torus(double major, double minor,
                                               struct gd_parametric **out,
                                               struct gd_detail *detail);

/* (v cos u, v sin u, pitch u), for u in [u_low, u_high] and v in [v_low, v_high]; pitch is not
 * zero. */
GD_MUST_USE enum gd_status gd_parametric_helicoid(double pitch, const double u_range[2],
                                                  const double v_range[2],
                                                  struct gd_parametric **out,
                                                  struct gd_detail *detail);

#define GD_GRAPH_DEGREE_MAX 16

/* z = sum of coefficients[i * (degree_v + 1) + j] u^i v^j; all coefficients zero: a plane. */
struct gd_graph {
    uint32_t degree_u, degree_v; /* at most GD_GRAPH_DEGREE_MAX */
    const double *coefficients;
    const double *u_range, *v_range; /* low and high of each */
};

/* (u, v, z): the graph of a polynomial. The arrays are borrowed for the call. */
GD_MUST_USE enum gd_status gd_parametric_graph(const struct gd_graph *graph,
                                               struct gd_parametric **out,
                                               struct gd_detail *detail);

/* A profile in the plane of (radius, height): a clamped or unclamped B-spline or NURBS curve. */
struct gd_profile {
    uint32_t degree, count;
    const double *knots;       /* count + degree + 1 */
    const double (*points)[2]; /* radius >= 0, height */
    const double *weights;     /* > 0; NULL: all 1 */
};

/* (r(v) cos u, r(v) sin u, h(v)): u is the angle, closed with period 2 pi, v the profile's
 * parameter. An end of the profile on the axis is a pole; the radius must not vanish elsewhere. */
GD_MUST_USE enum gd_status gd_parametric_revolution(const struct gd_profile *profile,
                                                    struct gd_parametric **out,
                                                    struct gd_detail *detail);

#ifdef __cplusplus
}
#endif

#endif
