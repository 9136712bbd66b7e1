/* Pieces: a curve divided by arc length, and each piece pulled tight. Inside unit. */
#ifndef GD_TRANSPORT_PIECES_H
#define GD_TRANSPORT_PIECES_H

#include "gd/curve.h"
#include "line/straighten.h"

/* The curve's points as a route; of a closed one the first is there again at the end. GD_NO_MEMORY,
 * GD_BUDGET. */
GD_MUST_USE enum gd_status gd__route_of_curve(const struct gd_mesh *mesh,
                                              const struct gd_curve *curve,
                                              const struct gd_control *control,
                                              struct gd__route *out);

/* The route's points as a curve, which takes them; leaves an empty route. */
struct gd_curve gd__route_take_curve(struct gd__route *route, bool closed);

/* Divides a route at ascending lengths behind its beginning, from 0 to its whole length, and pulls
 * tight what is between those that follow each other: all of it as `out`, which is filled anew.
 * `marks` (NULL: not wanted): the points of division, one a length. Errors: those of
 * gd__straighten. */
GD_MUST_USE enum gd_status gd__pieces_tighten(struct gd__straightener *straightener,
                                              const struct gd__route *route, const double *lengths,
                                              uint32_t count, struct gd__route *out,
                                              struct gd_point *marks);

#endif
