/* Domain curve: a curve on a parametric surface, given in its parameter domain: polyline, B-spline,
 * iso-parameter line, or a single point.
 *
 *     struct gd_domain_curve *line;
 *     if (gd_domain_curve_iso(torus, GD_ISO_U, 0.5, &line, &detail) == GD_OK) …
 *
 * All are B-splines: a polyline has degree 1 and its corners at the integers 0, 1, 2, …; an iso
 * line runs through the whole domain, and its parameter is the other coordinate. A curve whose ends
 * are one place of the surface (also by way of a closed direction) is closed: its parameter is
 * periodic. Curves are immutable once made: any number of threads may read them. They keep their
 * surface alive. */
#ifndef GD_DOMAIN_CURVE_H
#define GD_DOMAIN_CURVE_H

#include "gd/parametric.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GD_DOMAIN_CURVE_COUNT_MAX 65536
/* that a place may lie away from the domain in a closed direction */
#define GD_DOMAIN_CURVE_PERIODS_MAX 1000000

struct gd_domain_curve;

/* Which parameter stays. */
enum gd_iso { GD_ISO_U, GD_ISO_V };

/* Errors of all: GD_INVALID_ARGUMENT with a sentence (a number that is not finite, a place outside
 * the domain or too many periods away from it, two corners in one place, knots that are no knots,
 * degree or count out of range), GD_NO_MEMORY; and with `control`, which may be NULL, GD_CANCELLED,
 * GD_DEADLINE: where a long curve crosses lines of the surface takes up to a tenth of a second to
 * find. The caller owns one reference of `*out`. */
GD_MUST_USE enum gd_status gd_domain_curve_point(const struct gd_parametric *surface, double u,
                                                 double v, struct gd_domain_curve **out,
                                                 struct gd_detail *detail);

struct gd_domain_polyline {
    const double (*corners)[2]; /* (u, v) */
    uint32_t count;             /* at least 2 */
};

/* In closed directions corners may leave [low, high]: so a curve winds around. */
GD_MUST_USE enum gd_status gd_domain_curve_polyline(const struct gd_parametric *surface,
                                                    const struct gd_domain_polyline *polyline,
                                                    const struct gd_control *control,
                                                    struct gd_domain_curve **out,
                                                    struct gd_detail *detail);

struct gd_domain_bspline {
    uint32_t degree;
    const double *knots; /* count + degree + 1 */
    const double (*points)[2];
    uint32_t count;
};

GD_MUST_USE enum gd_status gd_domain_curve_bspline(const struct gd_parametric *surface,
                                                   const struct gd_domain_bspline *spline,
                                                   const struct gd_control *control,
                                                   struct gd_domain_curve **out,
                                                   struct gd_detail *detail);

GD_MUST_USE enum gd_status gd_domain_curve_iso(const struct gd_parametric *surface,
                                               enum gd_iso fixed, double at,
                                               struct gd_domain_curve **out,
                                               struct gd_detail *detail);

struct gd_domain_curve *gd_domain_curve_retain(const struct gd_domain_curve *curve);
void gd_domain_curve_release(const struct gd_domain_curve *curve); /* NULL is harmless */
size_t gd_domain_curve_memsize(const struct gd_domain_curve *curve);

const struct gd_parametric *gd_domain_curve_surface(const struct gd_domain_curve *curve);
bool gd_domain_curve_is_point(const struct gd_domain_curve *curve);
bool gd_domain_curve_is_closed(const struct gd_domain_curve *curve);

/* The parameter's range. */
void gd_domain_curve_range(const struct gd_domain_curve *curve, double *low, double *high);

/* (u, v) at a parameter, which is wrapped on closed curves and clamped on others. */
void gd_domain_curve_at(const struct gd_domain_curve *curve, double s, double uv[2]);

#ifdef __cplusplus
}
#endif

#endif
