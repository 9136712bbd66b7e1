#include "loops/span.h"

#include <string.h>

/* Divides homogeneous coordinates: value, first and second derivative of (x / w, y / w). */
static void project(const double h[3][3], struct gd__span_jet *out)
{
    double w = h[0][2];
    for (int k = 0; k < 2; k++) {
        out->at[k] = h[0][k] / w;
        out->first[k] = (h[1][k] - out->at[k] * h[1][2]) / w;
        out->second[k] = (h[2][k] - 2 * out->first[k] * h[1][2] - out->at[k] * h[2][2]) / w;
    }
}

void gd__span_jet(const struct gd__span *span, double t, struct gd__span_jet *out)
{
    uint32_t d = span->degree;
    double p[GD__SPAN_DEGREE_MAX + 1][3], h[3][3] = {{0}};
    memcpy(p, span->points, (d + 1) * sizeof *p);
    /* de Casteljau's algorithm: differences of the last points give the derivatives */
    for (uint32_t level = d; level > 0; level--) {
        for (int k = 0; k < 3; k++) {
            if (level == 2) h[2][k] = d * (d - 1) * (p[2][k] - 2 * p[1][k] + p[0][k]);
            if (level == 1) h[1][k] = d * (p[1][k] - p[0][k]);
        }
        for (uint32_t i = 0; i < level; i++)
            for (int k = 0; k < 3; k++) p[i][k] += t * (p[i + 1][k] - p[i][k]);
    }
    memcpy(h[0], p[0], sizeof h[0]);
    project((const double(*)[3])h, out);
}
