#include "nurbs/band.h"

#include <math.h>

#include "base/tolerance.h"

bool gd__band_factor(uint32_t size, uint32_t width, double *row)
{
    for (uint32_t i = 0; i < size; i++) {
        double *a = row + (size_t)i * width, diagonal = a[0];
        uint32_t reach = i < width - 1 ? i : width - 1;
        for (uint32_t k = reach; k > 0; k--) {
            const double *b = row + (size_t)(i - k) * width;
            double sum = a[k];
            for (uint32_t m = 1; k + m <= reach; m++) sum -= a[k + m] * b[m];
            a[k] = sum / b[0];
        }
        double pivot = diagonal;
        for (uint32_t k = 1; k <= reach; k++) pivot -= a[k] * a[k];
        if (!(pivot > GD_TOL_PIVOT * fabs(diagonal))) return false;
        a[0] = sqrt(pivot);
    }
    return true;
}

void gd__band_solve(uint32_t size, uint32_t width, const double *row, double *b)
{
    for (uint32_t i = 0; i < size; i++) {
        const double *a = row + (size_t)i * width;
        for (uint32_t k = 1; k < width && k <= i; k++) b[i] -= a[k] * b[i - k];
        b[i] /= a[0];
    }
    for (uint32_t i = size; i-- > 0;) {
        const double *a = row + (size_t)i * width;
        b[i] /= a[0];
        for (uint32_t k = 1; k < width && k <= i; k++) b[i - k] -= a[k] * b[i];
    }
}
