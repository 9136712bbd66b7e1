/* Limit place: validation of places on a limit surface (gd/limit.h), and angles at a place.
 *
 * Angles are measured in the tangent plane and increase counter-clockwise as seen from outside.
 * Angle zero is the direction of du (gd/limit.h); at a face's first corner it runs along the first
 * edge. */
#ifndef GD_LIMIT_PLACE_H
#define GD_LIMIT_PLACE_H

#include "gd/limit.h"

GD_EXTERN_C_BEGIN

/* Validates a place, and clamps u and v to the face if they are outside by at most 1e-9. `detail`
 * may be NULL. Errors: GD_OUT_OF_RANGE (face or corner), GD_INVALID_ARGUMENT (u, v). O(1).
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_place_check(const struct gd_subdivision *surface,
                                                struct gd_limit_point *place,
                                                struct gd_detail *detail);

/* Returns the unit vector at an angle in the tangent plane. The jet must have a normal. */
struct gd_vec3 gd_limit_direction(const struct gd_limit_jet *jet, double angle);

/* Returns the angle, in [0, 2 pi), of a vector projected onto the tangent plane. Returns 0 if the
 * projection is zero, and NAN if the jet has no normal. */
double gd_limit_angle(const struct gd_limit_jet *jet, struct gd_vec3 vector);

GD_EXTERN_C_END

#endif
