/* B-spline basis: the degree + 1 functions that do not vanish on a knot span, with two derivatives.
 * Piegl and Tiller, The NURBS Book, section 2.2-2.5.
 *
 * On a span, the functions are polynomials. Outside the span, the same polynomials are
 * evaluated. */
#pragma once

#include "gd/status.h"

#define GD__DEGREE_MAX 15
#define GD__ORDER_MAX  (GD__DEGREE_MAX + 1)

struct gd__basis {
    double value[GD__ORDER_MAX], first[GD__ORDER_MAX], second[GD__ORDER_MAX];
};

/* Computes the functions of control points span - degree … span at `t`, where knots[span] <
 * knots[span + 1]. O(degree^2). */
void gd__basis(uint32_t degree, const double *knots, uint32_t span, double t,
               struct gd__basis *out);

/* Adds to `out` the sum of weight[i] * points[i], i <= degree. */
static inline void gd__basis_sum(uint32_t degree, const double *weight, const double (*points)[2],
                                 double out[2])
{
    for (uint32_t i = 0; i <= degree; i++)
        for (int k = 0; k < 2; k++) out[k] += weight[i] * points[i][k];
}

/* Returns the last i in [low, high) with sorted[i] <= t; `low` if there is none. O(log(high -
 * low)). */
static inline uint32_t gd__interval(const double *sorted, uint32_t low, uint32_t high, double t)
{
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (t < sorted[middle])
            high = middle;
        else
            low = middle;
    }
    return low;
}

/* Returns the span that contains `t`, which must be in the domain [knots[degree], knots[count]]. At
 * the upper end, returns the last span. O(log count). */
uint32_t gd__basis_span(uint32_t degree, uint32_t count, const double *knots, double t);

/* Validates the count + degree + 1 knots of a curve. Error: GD_INVALID_ARGUMENT (a knot is not
 * finite or is less than the previous one, an inner knot is repeated so often that the curve is not
 * continuous, or the domain is empty). */
GD_MUST_USE enum gd_status gd__knots_check(uint32_t degree, uint32_t count, const double *knots,
                                           struct gd_detail *detail);
