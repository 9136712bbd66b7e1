/* Meet: tests whether two curves of a surface have a common point. */
#ifndef GD_NURBS_MEET_H
#define GD_NURBS_MEET_H

#include "gd/control.h"
#include "nurbs/curve.h"

/* Sets *meet to true, and `s` to the parameters, if the curves have a common point (to
 * GD_TOL_COINCIDE of the surface's size). Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. Cost:
 * about 100,000 distances of points, more for curves with many pieces. */
GD_MUST_USE enum gd_status gd__curves_meet(const struct gd_domain_curve *a,
                                           const struct gd_domain_curve *b,
                                           const struct gd_control *control, bool *meet,
                                           double s[2]);

#endif
