/* Energy of a piece, E = 1/2 int |d/dt x(c)|^2 dt, with its gradient and covariant Hessian with
 * respect to the control points.
 *
 * Source: W.-H. Chen, "Improvement of the shortest path problem with geodesic-like method",
 * equation (9), with a derivative that is missing in the printed equation. The Hessian is the
 * second variation of energy, int |V'|^2 - K |V x T|^2, do Carmo, Riemannian Geometry, section
 * 9.2. */
#pragma once

#include "nurbs/chain.h"

/* NEWTON: the covariant Hessian. It is indefinite if the piece is longer than a shortest path can
 * be. GAUSS: the integral of J^T J, where J is the derivative of the velocity d/dt x by the control
 * points. It is always positive semidefinite. */
enum gd__hessian { GD__HESSIAN_NEWTON, GD__HESSIAN_GAUSS };

/* Energy and derivatives for n control points. Unknown 2 i + k is coordinate k of point i. */
struct gd__energy {
    double value;
    double *gradient; /* 2 n numbers */
    double *hessian;  /* 2 n rows of a band matrix of width gd__energy_width */
};

static inline uint32_t gd__energy_width(const struct gd__chain *chain)
{
    return 2 * chain->degree + 2;
}

/* Computes only E. O(spans). All functions of this file end early if the chain's pace stops. */
double gd__energy_value(const struct gd__chain *chain, const struct gd__piece *piece);

/* Computes energy, gradient and Hessian. The caller provides the arrays. O(spans degree^2). */
void gd__energy_expand(const struct gd__chain *chain, const struct gd__piece *piece,
                       enum gd__hessian kind, struct gd__energy *out);

/* Integrates the squared geodesic curvature over the arc length of one span, and computes the
 * span's length. Source: do Carmo, Curves and Surfaces, section 4-4. */
void gd__energy_bend(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                     double *bend, double *length);

/* Returns the length of a span, by Gauss's rule of `gauss` points on each of `parts` equal
 * parts. */
double gd__energy_length(const struct gd__chain *chain, const struct gd__piece *piece,
                         uint32_t span, int gauss, int parts);
