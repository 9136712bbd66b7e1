#include "nurbs/bspline.h"

#include <math.h>

/* Computes the j + 1 functions of degree j from the j functions of degree j - 1, in place. */
static void raise_degree(uint32_t j, const double *knots, uint32_t span, double t, double *n)
{
    double saved = 0;
    for (uint32_t r = 0; r < j; r++) {
        double right = knots[span + 1 + r] - t, left = t - knots[span + 1 + r - j];
        double part = n[r] / (right + left);
        n[r] = saved + right * part;
        saved = left * part;
    }
    n[j] = saved;
}

/* Computes the derivatives of the j + 1 functions of degree j from the values (or derivatives) of
 * the j functions of degree j - 1. */
static void differentiate(uint32_t j, const double *knots, uint32_t span, const double *lower,
                          double *out)
{
    double before = 0;
    for (uint32_t r = 0; r < j; r++) {
        double part = j * lower[r] / (knots[span + 1 + r] - knots[span + 1 + r - j]);
        out[r] = before - part;
        before = part;
    }
    out[j] = before;
}

void gd__basis(uint32_t degree, const double *knots, uint32_t span, double t, struct gd__basis *out)
{
    double n[GD__ORDER_MAX] = {1}, slope[GD__ORDER_MAX];
    for (uint32_t i = 0; i <= degree; i++) out->first[i] = out->second[i] = 0;
    for (uint32_t j = 1; j <= degree; j++) {
        if (j + 1 == degree) {
            differentiate(j, knots, span, n, slope);
            differentiate(degree, knots, span, slope, out->second);
        }
        if (j == degree) differentiate(j, knots, span, n, out->first);
        raise_degree(j, knots, span, t, n);
    }
    for (uint32_t i = 0; i <= degree; i++) out->value[i] = n[i];
}

uint32_t gd__basis_span(uint32_t degree, uint32_t count, const double *knots, double t)
{
    uint32_t low = degree, high = count;
    if (t >= knots[count]) {
        for (high--; knots[high] >= knots[count];) high--;
        return high;
    }
    return gd__interval(knots, low, high, t);
}

enum gd_status gd__knots_check(uint32_t degree, uint32_t count, const double *knots,
                               struct gd_detail *detail)
{
    for (uint32_t i = 0; i < count + degree + 1; i++)
        if (!isfinite(knots[i]) || (i && knots[i] < knots[i - 1]))
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "knot %u of the curve is not finite or less than the one before", i);
    for (uint32_t i = degree + 1; i + degree < count; i++)
        if (knots[i] == knots[i + degree])
            return gd_fail(detail, GD_INVALID_ARGUMENT,
                           "knot %u of the curve is repeated more than %u times", i, degree);
    if (!(knots[degree] < knots[count]))
        return gd_fail(detail, GD_INVALID_ARGUMENT, "the curve's knots leave it no domain");
    return GD_OK;
}
