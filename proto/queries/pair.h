/* Pair: distance and path between two points, perhaps by way of others. Both take {from, to, via?};
 * the answer of path has the path too.
 *
 * A request's points are its *stops*: from, the points of via in their order, to. What lies between
 * two neighbouring stops is a leg. */
#ifndef PROTO_PAIR_H
#define PROTO_PAIR_H

#include "gd/query.h"
#include "proto/http/options.h"
#include "proto/values/points.h"

#define PROTO_PAIR_VIA 1000 /* most points of via */

/* The stops, from the body of POST and from the query string of GET: at least two. `out` is the
 * caller's to free. invalid_request, too_large, insufficient_memory. */
bool proto_pair_decode(const json_t *document, struct proto_points *out,
                       struct proto_problem *problem);
bool proto_pair_parse(const struct proto_parameters *parameters, struct proto_points *out,
                      struct proto_problem *problem);

/* Writes {"distance", "reason"?, "from", "to", "via"?, "path"?}, of these the fields that were
 * asked for; via only when there are such stops. An infinite distance is null with the reason
 * no_path, and so is its path. */
void proto_pair_encode(struct proto_writer *writer, const struct proto_located_points *stops,
                       const struct gd_pair_answer *answer, const struct proto_options *options);

#endif
