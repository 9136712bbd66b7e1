/* The inside of a domain curve: its smooth spans, and where they lie on the surface. */
#ifndef GD_NURBS_CURVE_H
#define GD_NURBS_CURVE_H

#include <stdatomic.h>

#include "gd/domain_curve.h"
#include "nurbs/surface.h"

struct gd_domain_curve {
    const struct gd_parametric *surface;
    uint32_t degree, count;
    double *knots;
    double (*points)[2];
    bool is_point, closed;
    double low, high;
    double winding[2]; /* closed: by how much (u, v) has moved after one turn: whole periods */
    /* The curve is smooth, and stays in one cell of the surface, between consecutive breaks. */
    uint32_t break_count; /* at least 2 */
    double *breaks;
    _Atomic uint32_t references;
};

/* Place and two derivatives at a parameter. */
struct gd__curve_jet {
    double at[2], first[2], second[2];
};

/* At any parameter: on a closed curve beyond its range too, where (u, v) goes on by `winding`. */
void gd__curve_jet(const struct gd_domain_curve *curve, double s, struct gd__curve_jet *out);

/* The same, by the polynomial that the curve is between breaks[i] and breaks[i + 1]; s may lie on
 * either, or a little outside. */
void gd__curve_jet_in(const struct gd_domain_curve *curve, uint32_t i, double s,
                      struct gd__curve_jet *out);

/* The interval of breaks that s (in range) lies in. */
uint32_t gd__curve_interval(const struct gd_domain_curve *curve, double s);

/* Wrapped (closed) or clamped into the range; `*turns`: how often it was wrapped. */
double gd__curve_reduce(const struct gd_domain_curve *curve, double s, double *turns);

#endif
