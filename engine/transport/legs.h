/* Legs: a spline's segments between its knots: the two geodesics along their tangents, and the one
 * between the ends of these. */
#ifndef GD_TRANSPORT_LEGS_H
#define GD_TRANSPORT_LEGS_H

#include "transport/knots.h"

/* Fills `segments`, one for each hop, all zero before; the knots and the hops have been filled.
 * With the request's executor of width 2 or more two are made at a time, with the same answer, and
 * half of the budget each; what that is too little for is made by itself. On failure those that
 * were made are there all the same. Errors: GD_INVALID_ARGUMENT (a tangent that is no end of),
 * those of gd_trace_follow and of gd__straighten. */
GD_MUST_USE enum gd_status gd__legs_make(const struct gd__knotting *knotting,
                                         struct gd_spline_segment *segments);

#endif
