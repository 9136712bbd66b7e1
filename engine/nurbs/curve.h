/* Domain curve: its smooth intervals, and evaluation. */
#pragma once

#include "base/arena.h"
#include "gd/domain_curve.h"
#include "nurbs/surface.h"

struct gd_domain_curve {
    const struct gd_parametric *surface;
    uint32_t degree, count;
    double *knots;
    double (*points)[2];
    bool is_point, closed;
    double low, high;
    double winding[2]; /* for a closed curve, the change of (u, v) after one period */
    /* The curve is smooth and stays in one cell of the surface between consecutive breaks. */
    uint32_t break_count; /* at least 2 */
    double *breaks;
};

/* Place and two derivatives by the parameter. */
struct gd__curve_jet {
    double at[2], first[2], second[2];
};

/* Evaluates a curve. On a closed curve s may be outside the range; each period beyond it adds
 * `winding` to (u, v). */
void gd__curve_jet(const struct gd_domain_curve *curve, double s, struct gd__curve_jet *out);

/* Evaluates the polynomial between breaks[i] and breaks[i + 1], also at these breaks and slightly
 * outside. */
void gd__curve_jet_in(const struct gd_domain_curve *curve, uint32_t i, double s,
                      struct gd__curve_jet *out);

/* Lists parameters in ascending order: at least `each` in each interval and at least `least` on the
 * whole curve, but not many more than `most`. The end of a closed curve is included only if
 * `with_end` is set. The list of a point has only the parameter 0. Returns NULL, and sets *count to
 * 0, if arena->status is set. */
struct gd__curve_places {
    uint32_t each, least, most;
    bool with_end;
};
double *gd__curve_places(const struct gd_domain_curve *curve, const struct gd__curve_places *wanted,
                         struct gd__arena *arena, uint32_t *count);

/* Returns the interval of breaks that contains s, which must be in range. */
uint32_t gd__curve_interval(const struct gd_domain_curve *curve, double s);

/* Returns s, moved into the range: wrapped for a closed curve, clamped for another one. Sets *turns
 * to the number of periods that were removed. */
double gd__curve_reduce(const struct gd_domain_curve *curve, double s, double *turns);
