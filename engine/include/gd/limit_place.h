/* Limit place: is there such a place on a limit surface, and which directions lead away from it.
 *
 * Angles at a place are those of its tangent plane: they grow counter-clockwise as seen from
 * outside, and zero is the direction of du (gd/limit.h), along the face's first edge at its first
 * corner. */
#ifndef GD_LIMIT_PLACE_H
#define GD_LIMIT_PLACE_H

#include "gd/limit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Is it a place of the surface? u and v that are outside of their face by no more than 1e-9 are
 * moved into it. `detail` may be NULL. Errors: GD_OUT_OF_RANGE (face or corner),
 * GD_INVALID_ARGUMENT (u, v). O(1). Thread-safe. */
GD_MUST_USE enum gd_status gd_limit_place_check(const struct gd_subdivision *surface,
                                                struct gd_limit_point *place,
                                                struct gd_detail *detail);

/* The unit vector at an angle in the tangent plane of a jet, which has a normal. */
struct gd_vec3 gd_limit_direction(const struct gd_limit_jet *jet, double angle);

/* The angle of a vector that is projected onto the tangent plane, in [0, 2 pi); 0 when nothing of
 * it is left; NAN without a normal. */
double gd_limit_angle(const struct gd_limit_jet *jet, struct gd_vec3 vector);

#ifdef __cplusplus
}
#endif

#endif
