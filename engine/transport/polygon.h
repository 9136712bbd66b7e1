/* Polygon: the control polygon of a cubic curve on the surface, and de Casteljau's construction for
 * it. Normalised unit. */
#pragma once

#include "line/straighten.h"

/* The arms are geodesics between consecutive control points. An all-zero struct has no arms. */
struct gd__polygon {
    struct gd__route arms[3];
    double begin, end; /* parameters */
};

void gd__polygon_free(struct gd__polygon *polygon); /* frees the arms and zeroes the struct */

/* Divides the curve at `part` in [0, 1] and computes the control polygons of both parts. Sets
 * *touching to the length of the last line of the construction. This line is tangent to the curve,
 * and its length is a third of the speed, if the parameter runs from 0 to 1. `left` and `right`
 * must be empty; the caller frees them even after a failure. Cost: three straightened lines.
 * Errors: those of gd__straighten. */
GD_MUST_USE enum gd_status gd__polygon_divide(struct gd__straightener *straightener,
                                              const struct gd__polygon *polygon, double part,
                                              struct gd__polygon *left, struct gd__polygon *right,
                                              double *touching);

/* Joins the three arms to one route, forwards or backwards. */
GD_MUST_USE enum gd_status gd__polygon_join(const struct gd__polygon *polygon, bool backwards,
                                            struct gd__route *out,
                                            const struct gd_control *control);

/* Straightens the polygon to the geodesic from its first control point to its last, which replaces
 * `out`. Overwrites `scratch`. */
GD_MUST_USE enum gd_status gd__polygon_chord(struct gd__straightener *straightener,
                                             const struct gd__polygon *polygon,
                                             struct gd__route *scratch, struct gd__route *out);

static inline double gd__polygon_length(const struct gd__polygon *polygon)
{
    return polygon->arms[0].length + polygon->arms[1].length + polygon->arms[2].length;
}

/* Returns an upper bound of the distance of the curve and the polygon from the chord. Both lie in
 * an ellipse whose foci are the chord's ends. The sum of the distances of a point of the ellipse
 * from the foci is the polygon's length. */
static inline double gd__polygon_height(double length, double chord)
{
    return length > chord ? 0.5 * sqrt((length - chord) * (length + chord)) : 0;
}
