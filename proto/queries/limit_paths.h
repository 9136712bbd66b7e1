/* Limit paths: geodesics of a subdivision surface. Traces from a place are answered by {"start",
 * "paths"}, and "level" unless they are smooth; the shortest path between two places by {"distance",
 * "reason"?, "error_estimate", "relaxed", "mesh_distance", "level", "from", "to", "path"}. */
#ifndef PROTO_LIMIT_PATHS_H
#define PROTO_LIMIT_PATHS_H

#include "gd/limit_mesh.h"
#include "gd/limit_path.h"
#include "gd/limit_shortest.h"
#include "gd/trace.h"
#include "proto/http/options.h"
#include "proto/queries/trace.h"
#include "proto/values/limit_place.h"

struct proto_limit_trace { /* all zero is an empty one */
    struct proto_limit_trace_request request;
    struct gd_limit_point start;
    uint32_t count; /* directions, or those of the fan */
    uint32_t level; /* of the mesh, if it isn't smooth */
};

/* A level that the mesh of this surface can have: the member if it is there, else the usual one.
 * invalid_request. */
bool proto_limit_level_decode(const json_t *document, const struct gd_subdivision *surface,
                              uint32_t *out, struct proto_problem *problem);

/* invalid_request, point_not_on_surface, too_large, insufficient_memory. Freed by
 * proto_limit_trace_free. */
bool proto_limit_trace_decode(const json_t *document, const struct gd_subdivision *surface,
                              struct proto_limit_trace *out, struct proto_problem *problem);
void proto_limit_trace_free(struct proto_limit_trace *trace); /* a second time is harmless */

/* The i-th direction as a vector of space, in the tangent plane of the start's jet but for vectors,
 * which are as they came. */
struct gd_vec3 proto_limit_trace_direction(const struct proto_limit_trace *trace,
                                           const struct gd_limit_jet *start, uint32_t i);

/* Writes {"length", "points", "end_direction", "end_reason"}: of a path on the mesh, whose points
 * are told in space as they lie on the mesh; of one on the surface itself. `end`: the surface's jet
 * where it ends. Points by the geometry as in a path (path.h). */
void proto_limit_trace_encode_mesh(struct proto_writer *writer, const struct gd_limit_mesh *fine,
                                   const struct gd_trace *trace, const struct gd_limit_jet *end,
                                   enum proto_geometry geometry);
void proto_limit_trace_encode_smooth(struct proto_writer *writer, const struct gd_limit_path *path,
                                     const struct gd_limit_jet *end, enum proto_geometry geometry);

/* Writes an array of steps, or of their positions. */
void proto_limit_steps_encode(struct proto_writer *writer, const struct gd_limit_step *steps,
                              uint32_t count, enum proto_geometry geometry);

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
