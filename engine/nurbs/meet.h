/* Meet: finds common points of two curves of a surface. */
#pragma once

#include "gd/control.h"
#include "nurbs/curve.h"

struct gd__meeting {
    double s[2]; /* parameters on both curves */
};

/* Finds at most `most` common points of the curves, in any order. The tolerance is GD_TOL_COINCIDE
 * of the surface's size. The same point may be listed twice. Errors: GD_NO_MEMORY, GD_CANCELLED,
 * GD_DEADLINE. Cost: about 100,000 distances between points, more for curves with many pieces. */
GD_MUST_USE enum gd_status gd__curves_meetings(const struct gd_domain_curve *a,
                                               const struct gd_domain_curve *b,
                                               const struct gd_control *control,
                                               struct gd__meeting *out, uint32_t most,
                                               uint32_t *count);
