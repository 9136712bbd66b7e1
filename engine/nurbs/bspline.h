/* B-spline basis: the degree + 1 functions that do not vanish on a knot span, with two derivatives.
 * Piegl and Tiller, The NURBS Book, section 2.2-2.5.
 *
 * They are evaluated as polynomials of the span, also beyond it. */
#ifndef GD_NURBS_BSPLINE_H
#define GD_NURBS_BSPLINE_H

#include <stdbool.h>
#include <stdint.h>

#define GD__DEGREE_MAX 15
#define GD__ORDER_MAX  (GD__DEGREE_MAX + 1)

struct gd__basis {
    double value[GD__ORDER_MAX], first[GD__ORDER_MAX], second[GD__ORDER_MAX];
};

/* The functions of control points span - degree … span at `t`; knots[span] < knots[span + 1].
 * O(degree^2). */
void gd__basis(uint32_t degree, const double *knots, uint32_t span, double t,
               struct gd__basis *out);

/* The span of `t` in the domain [knots[degree], knots[count]]: the last one at its upper end. O(log
 * count). */
uint32_t gd__basis_span(uint32_t degree, uint32_t count, const double *knots, double t);

#endif
