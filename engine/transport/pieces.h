/* Pieces: divides a curve by arc length and straightens each piece. Normalised unit. */
#pragma once

#include "gd/curve.h"
#include "line/straighten.h"

/* Converts a curve to a route. If the curve is closed, the route ends at its first point. Errors:
 * GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__route_of_curve(const struct gd_mesh *mesh,
                                              const struct gd_curve *curve,
                                              const struct gd_control *control,
                                              struct gd__route *out);

/* Moves the route's points into a curve, and leaves the route empty. */
struct gd_curve gd__route_take_curve(struct gd__route *route, bool closed);

/* Divides a route at ascending lengths from 0 to its whole length, and straightens each piece.
 * Replaces `out` by the joined pieces. Writes the points of division, one for each length, to
 * `marks`, which may be NULL. Errors: those of gd__straighten. */
GD_MUST_USE enum gd_status gd__pieces_tighten(struct gd__straightener *straightener,
                                              const struct gd__route *route, const double *lengths,
                                              uint32_t count, struct gd__route *out,
                                              struct gd_point *marks);
