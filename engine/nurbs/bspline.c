#include "nurbs/bspline.h"

/* From the j functions of degree j - 1 to the j + 1 of degree j, in place. */
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

/* From the j values (or derivatives) of degree j - 1 to the derivatives of the j + 1 functions of
 * degree j. */
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
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (t < knots[middle])
            high = middle;
        else
            low = middle;
    }
    return low;
}
