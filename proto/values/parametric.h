/* Parametric: surfaces of known shape in a request,
 *
 *     {"torus": {"major", "minor"}} | {"helicoid": {"pitch", "u", "v"}} | {"graph":
 * {"coefficients", "u", "v"}} |
 *     {"revolution": {"degree", "knots", "control_points", "weights"?}}
 *
 * and the domain of any parametric surface in an answer. */
#ifndef PROTO_PARAMETRIC_H
#define PROTO_PARAMETRIC_H

#include <jansson.h>

#include "gd/parametric.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

#define PROTO_PROFILE_POINTS 4096 /* most control points of a profile */

/* The surface that the value at `place` describes, and the static name of its shape.
 * invalid_request, too_large, insufficient_memory. The caller releases `*out`. */
bool proto_parametric_decode(const json_t *value, const char *place, struct gd_parametric **out,
                             const char **shape, struct proto_problem *problem);

/* Writes {"u": {"range", "closed", "pieces", "pole_low", "pole_high"}, "v": {…}}. */
void proto_domain_encode(struct proto_writer *writer, const struct gd_parametric *surface);

#endif
