/* Parametric: surfaces of known shapes (torus, sphere, …) in a request (schema NurbsFile), and the
 * domain of any parametric surface in an answer. */
#ifndef PROTO_PARAMETRIC_H
#define PROTO_PARAMETRIC_H

#include <jansson.h>

#include "gd/parametric.h"
#include "proto/json/problem.h"
#include "proto/json/writer.h"

#define PROTO_PROFILE_POINTS 4096 /* most control points of a profile */

/* Decodes the surface that the value at `place` describes; `*shape` is the shape's static name.
 * Problems: invalid_request, too_large, insufficient_memory. The caller releases `*out`. */
bool proto_parametric_decode(const json_t *value, const char *place, struct gd_parametric **out,
                             const char **shape, struct proto_problem *problem);

void proto_domain_encode(struct proto_writer *writer, const struct gd_parametric *surface);

#endif
