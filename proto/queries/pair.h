/* Pair: distance and path between two points, optionally via others. Both queries take {from, to,
 * via?}; the answer of path also has the path.
 *
 * A request's points are its *stops*: from, the points of via in order, to. A leg lies between two
 * consecutive stops. */
#pragma once

#include "gd/query.h"
#include "proto/http/options.h"
#include "proto/values/points.h"

#define PROTO_PAIR_VIA 1000 /* limit on the points of `via` */

/* Decode the stops, at least two, from the body of POST and from the query string of GET. The
 * caller frees `out`. Problems: invalid_request, too_large, insufficient_memory. */
bool proto_pair_decode(const json_t *document, struct proto_points *out,
                       struct proto_problem *problem);
bool proto_pair_parse(const struct proto_parameters *parameters, struct proto_points *out,
                      struct proto_problem *problem);

/* Writes the answer. If there is no path, distance and path are null, and the reason is no_path.
 * The answer contains "via" only if the request does. */
void proto_pair_encode(struct proto_writer *writer, const struct proto_located_points *stops,
                       const struct gd_pair_answer *answer, const struct proto_options *options);
