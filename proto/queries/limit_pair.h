/* Limit pair: distance and shortest path between two places of a subdivision surface. The answer
 * is {"distance", "reason"?, "error_estimate", "relaxed",
 * "mesh_distance", "level", "from", "to", "path"}. */
#ifndef PROTO_LIMIT_PAIR_H
#define PROTO_LIMIT_PAIR_H

#include "gd/limit_shortest.h"
#include "proto/values/limit_place.h"
#include "proto/http/options.h"

struct proto_limit_pair {
    struct gd_limit_point from, to;
    uint32_t level;
};

/* invalid_request, point_not_on_surface. */
bool proto_limit_pair_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_pair *out, struct proto_problem *problem);

/* `ends`: the surface's points at the two places. Without a path the distances are null, with the
 * reason no_path, and so is the path. */
void proto_limit_pair_encode(struct proto_writer *writer, const struct proto_limit_pair *wanted,
                             const struct gd_vec3 ends[2], const struct gd_limit_shortest *found,
                             const struct proto_options *options);

#endif
