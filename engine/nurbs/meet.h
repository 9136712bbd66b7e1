/* Meet: do two curves of a surface have a point in common? */
#ifndef GD_NURBS_MEET_H
#define GD_NURBS_MEET_H

#include "gd/control.h"
#include "nurbs/curve.h"

/* `*meet`: they do (to GD_TOL_COINCIDE of the surface's size), at parameters `s`. GD_NO_MEMORY,
 * GD_CANCELLED, GD_DEADLINE. Cost: some 100,000 distances of points, more for curves of many
 * pieces. */
GD_MUST_USE enum gd_status gd__curves_meet(const struct gd_domain_curve *a,
                                           const struct gd_domain_curve *b,
                                           const struct gd_control *control, bool *meet,
                                           double s[2]);

#endif
