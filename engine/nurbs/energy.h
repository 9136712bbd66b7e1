/* Energy of a piece, E = 1/2 int |d/dt x(c)|^2 dt, with its gradient and covariant Hessian by the
 * control points.
 *
 * Source: W.-H. Chen, "Improvement of the shortest path problem with geodesic-like method", (9)
 * with the derivative that print lost; the Hessian is the second variation of energy, int |V'|^2 -
 * K |V x T|^2, do Carmo, Riemannian Geometry, section 9.2. */
#ifndef GD_NURBS_ENERGY_H
#define GD_NURBS_ENERGY_H

#include "nurbs/chain.h"

/* NEWTON: the covariant Hessian, which has directions of descent where the piece is too long to be
 * shortest. GAUSS: int J^T J, J = d/dq of d/dt x, which is always positive. */
enum gd__hessian { GD__HESSIAN_NEWTON, GD__HESSIAN_GAUSS };

/* Of n points: unknown 2 i + k is coordinate k of point i. */
struct gd__energy {
    double value;
    double *gradient; /* 2 n */
    double *hessian;  /* 2 n rows of a band matrix, gd__energy_width wide */
};

static inline uint32_t gd__energy_width(const struct gd__chain *chain)
{
    return 2 * chain->degree + 2;
}

/* E alone. O(spans). All of these end early when the chain's watch says so. */
double gd__energy_value(const struct gd__chain *chain, const struct gd__piece *piece);

/* All of it, into arrays of the caller's. O(spans degree^2). */
void gd__energy_expand(const struct gd__chain *chain, const struct gd__piece *piece,
                       enum gd__hessian kind, struct gd__energy *out);

/* int of squared geodesic curvature by arc length over one span, and the span's length. do Carmo,
 * Curves and Surfaces, section 4-4. */
void gd__energy_bend(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                     double *bend, double *length);

/* By how much the length of a span that gd__energy_bend gives is off: against the same rule on both
 * halves. */
double gd__energy_uneven(const struct gd__chain *chain, const struct gd__piece *piece,
                         uint32_t span, double length);

#endif
