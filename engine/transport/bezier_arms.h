/* Bezier arms: the control polygon of each segment of a spline. Two arms are geodesics along the
 * tangents at the ends; the third arm joins their inner ends. */
#ifndef GD_TRANSPORT_BEZIER_ARMS_H
#define GD_TRANSPORT_BEZIER_ARMS_H

#include "transport/control_points.h"

/* Computes `segments`, one for each path. Before the call, the segments must be all zero, and the
 * knots and paths must be computed. If the executor of the request has a width of 2 or more, two
 * segments are computed at a time, each with half of the budget. If one of them fails, the missing
 * segments are computed one at a time. The result does not depend on the executor. On failure the
 * segments computed so far stay in the array. Errors: GD_INVALID_ARGUMENT (a tangent that crosses
 * too many edges), those of gd_trace_follow and of gd__straighten. */
GD_MUST_USE enum gd_status gd__bezier_arms_make(const struct gd__spline_work *work,
                                                struct gd_spline_segment *segments);

#endif
