/* NURBS: a tensor-product rational B-spline surface as a parametric surface.
 *
 * Source: L. Piegl, W. Tiller, The NURBS Book, chapters 2 to 4. gd_parametric_trim
 * (gd/parametric.h) adds trimming loops. */
#ifndef GD_NURBS_H
#define GD_NURBS_H

#include "gd/parametric.h"

GD_EXTERN_C_BEGIN

#define GD_NURBS_DEGREE_MAX 15
#define GD_NURBS_COUNT_MAX  4096 /* largest number of control points in one direction */

/* Conventions for knots and weights. */
enum gd_nurbs_convention {
    /* points not multiplied by weights, n + degree + 1 knots for n control points */
    GD_NURBS_CANONICAL,
    GD_NURBS_THREE, /* three.js: the same as canonical */
    GD_NURBS_VERB,  /* verb-nurbs: points multiplied by their weights */
    /* openNURBS: points multiplied by their weights, n + degree - 1 knots (without the superfluous
       first and last knots) */
    GD_NURBS_RHINO
};

/* Borrowed for the call. */
struct gd_nurbs_data {
    enum gd_nurbs_convention convention;
    uint32_t degree_u, degree_v;
    uint32_t count_u, count_v; /* control points */
    const double *knots_u, *knots_v;
    uint32_t knot_count_u, knot_count_v;
    const double (*points)[3]; /* point (i, j) at i * count_v + j; i counts in u */
    const double *weights;     /* in the order of `points`; NULL means that all are 1 */
};

/* The flaws that data can have. X(NAME, name) */
#define GD_NURBS_FLAW_MAP(X)                                                                       \
    X(NONE, none)                                                                                  \
    X(DEGREE, degree)                                                                              \
    X(CONTROL_COUNT, control_count)                                                                \
    X(KNOT_COUNT, knot_count)                                                                      \
    X(NON_FINITE, non_finite)                                                                      \
    X(DECREASING_KNOTS, decreasing_knots)                                                          \
    X(KNOT_MULTIPLICITY, knot_multiplicity)                                                        \
    X(EMPTY_DOMAIN, empty_domain)                                                                  \
    X(WEIGHT, weight)                                                                              \
    X(EXTENT, extent)

enum gd_nurbs_flaw {
#define GD_NURBS_FLAW_ENUM(NAME, name) GD_NURBS_FLAW_##NAME,
    GD_NURBS_FLAW_MAP(GD_NURBS_FLAW_ENUM)
#undef GD_NURBS_FLAW_ENUM
};

/* Returns the flaw's name in snake_case ("decreasing_knots"), a static string. */
const char *gd_nurbs_flaw_name(enum gd_nurbs_flaw flaw);

/* Returns the first flaw of the data, and writes a sentence about its location to the detail.
 * Returns GD_NURBS_FLAW_NONE if the data is valid. `detail` may be NULL. O(data). Thread-safe. */
enum gd_nurbs_flaw gd_nurbs_inspect(const struct gd_nurbs_data *data, struct gd_detail *detail);

/* Creates the surface. Closed directions (both borders are the same curve) and poles (a border that
 * is one point) are recognised. The interior knots are the surface's lines (see gd/parametric.h).
 * Errors: GD_INVALID_ARGUMENT (a flaw, with the sentence of gd_nurbs_inspect), GD_NO_MEMORY. The
 * caller owns one reference of `*out`. O(data). Thread-safe. */
GD_MUST_USE enum gd_status gd_nurbs_create(const struct gd_nurbs_data *data,
                                           struct gd_parametric **out, struct gd_detail *detail);

/* Returns true if gd_nurbs_create made the surface. In this case, sets `counts` to the numbers of
 * control points in u and v. O(1). */
bool gd_nurbs_counts(const struct gd_parametric *surface, uint32_t counts[2]);

/* Returns control point (i, j) of such a surface; i and j are below the counts. It equals the point
 * of the input up to rounding. O(1). Thread-safe. */
struct gd_vec3 gd_nurbs_control_point(const struct gd_parametric *surface, uint32_t i, uint32_t j);

GD_EXTERN_C_END

#endif
