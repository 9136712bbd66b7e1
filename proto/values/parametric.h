/* Parametric: surfaces of known shapes (torus, helicoid, …) in a request (schema Shape). */
#pragma once

#include <jansson.h>

#include "gd/parametric.h"
#include "proto/json/problem.h"

/* Decodes the surface that the value at `place` describes; `*shape` is the shape's static name.
 * Problems: invalid_request, too_large, insufficient_memory. The caller releases `*out`. */
bool proto_parametric_decode(const json_t *value, const char *place, struct gd_parametric **out,
                             const char **shape, struct proto_problem *problem);
