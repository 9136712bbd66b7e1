/* Polygon: the control polygon of a cubic on the surface, and de Casteljau's construction on it.
 * Inside unit. */
#ifndef GD_TRANSPORT_POLYGON_H
#define GD_TRANSPORT_POLYGON_H

#include "line/straighten.h"

/* All zero is none. The legs are geodesics, each from one control point to the next. */
struct gd__polygon {
    struct gd__route legs[3];
    double begin, end; /* parameters */
};

void gd__polygon_free(struct gd__polygon *polygon); /* leaves none */

/* The polygons of the curve's part before and behind `part` of it, in [0, 1], and the leg that
 * touches it there: its length is a third of the speed for a parameter that runs from 0 to 1. Three
 * lines are pulled tight. `left` and `right` must be none, on failure too they are to be freed.
 * Errors: those of gd__straighten. */
GD_MUST_USE enum gd_status gd__polygon_divide(struct gd__straightener *straightener,
                                              const struct gd__polygon *polygon, double part,
                                              struct gd__polygon *left, struct gd__polygon *right,
                                              double *touching);

/* The three legs behind each other, or from the end to the beginning, joined to a route. */
GD_MUST_USE enum gd_status gd__polygon_join(const struct gd__polygon *polygon, bool backwards,
                                            struct gd__route *out,
                                            const struct gd_control *control);

/* The line from the first control point to the last that the polygon becomes when it is pulled
 * tight. `scratch` is filled anew, too. */
GD_MUST_USE enum gd_status gd__polygon_chord(struct gd__straightener *straightener,
                                             const struct gd__polygon *polygon,
                                             struct gd__route *scratch, struct gd__route *out);

static inline double gd__polygon_length(const struct gd__polygon *polygon)
{
    return polygon->legs[0].length + polygon->legs[1].length + polygon->legs[2].length;
}

/* How far curve and polygon may be from the chord: all of them lie in the ellipse about its ends
 * whose points' distances from them add up to the polygon's length. */
static inline double gd__polygon_height(double length, double chord)
{
    return length > chord ? 0.5 * sqrt((length - chord) * (length + chord)) : 0;
}

#endif
