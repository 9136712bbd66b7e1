/* Domain curve: a curve on a parametric surface, given in the parameter domain as a polyline,
 * B-spline, iso-parameter line or single point.
 *
 *     struct gd_domain_curve *line;
 *     if (gd_domain_curve_iso(torus, GD_ISO_U, 0.5, &line, &detail) == GD_OK) …
 *
 * All domain curves are stored as B-splines. A polyline has degree 1, and its corners have the
 * parameters 0, 1, 2, …. An iso-parameter line runs through the whole domain, and its parameter is
 * the coordinate that varies. A curve is closed if its ends are the same point of the surface; in a
 * closed direction, their coordinates may differ by periods. The parameter of a closed curve is
 * periodic. Curves are immutable: any number of threads may read them. A curve keeps its surface
 * alive. */
#ifndef GD_DOMAIN_CURVE_H
#define GD_DOMAIN_CURVE_H

#include "gd/parametric.h"

GD_EXTERN_C_BEGIN

#define GD_DOMAIN_CURVE_COUNT_MAX 65536
/* in a closed direction, a point may be at most this number of periods away from the domain */
#define GD_DOMAIN_CURVE_PERIODS_MAX 1000000

struct gd_domain_curve;

/* The parameter that is constant along an iso-parameter line. */
enum gd_iso { GD_ISO_U, GD_ISO_V };

/* Errors of all constructors: GD_INVALID_ARGUMENT with a sentence (a number that is not finite, a
 * point outside the domain or too many periods away, two equal corners, invalid knots, degree or
 * count out of range), GD_NO_MEMORY. Constructors with `control`, which may be NULL, also return
 * GD_CANCELLED and GD_DEADLINE. A constructor computes where the curve crosses knot lines of the
 * surface; for a long curve this takes up to 0.1 s. The caller owns `*out`. */
GD_MUST_USE enum gd_status gd_domain_curve_point(const struct gd_parametric *surface, double u,
                                                 double v, struct gd_domain_curve **out,
                                                 struct gd_detail *detail);

struct gd_domain_polyline {
    const double (*corners)[2]; /* (u, v) */
    uint32_t count;             /* at least 2 */
};

/* Creates a polyline. In a closed direction, corners may lie outside [low, high], so that a curve
 * can wind around the surface. */
GD_MUST_USE enum gd_status gd_domain_curve_polyline(const struct gd_parametric *surface,
                                                    const struct gd_domain_polyline *polyline,
                                                    const struct gd_control *control,
                                                    struct gd_domain_curve **out,
                                                    struct gd_detail *detail);

struct gd_domain_bspline {
    uint32_t degree;
    const double *knots; /* count + degree + 1 numbers */
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

void gd_domain_curve_release(const struct gd_domain_curve *curve); /* NULL is allowed */

const struct gd_parametric *gd_domain_curve_surface(const struct gd_domain_curve *curve);
bool gd_domain_curve_is_point(const struct gd_domain_curve *curve);
bool gd_domain_curve_is_closed(const struct gd_domain_curve *curve);

/* Returns the range of the curve's parameter. */
void gd_domain_curve_range(const struct gd_domain_curve *curve, double *low, double *high);

/* Sets *inside to true if the curve stays within the loops of a trimmed surface, and otherwise sets
 * `uv` to a place outside. Tests up to 4096 places. A surface that is not trimmed contains all its
 * curves. `control` may be NULL. Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. Thread-safe. */
GD_MUST_USE enum gd_status gd_domain_curve_inside(const struct gd_domain_curve *curve,
                                                  const struct gd_control *control, bool *inside,
                                                  double uv[2]);

/* Computes (u, v) at the parameter `s`. If `s` is out of range, it is wrapped on closed curves and
 * clamped on other curves. O(degree^2). Thread-safe. */
void gd_domain_curve_at(const struct gd_domain_curve *curve, double s, double uv[2]);

GD_EXTERN_C_END

#endif
