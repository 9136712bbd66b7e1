/* Limit paths: traces and shortest paths on a subdivision surface. */
#pragma once

#include "gd/limit_mesh.h"
#include "gd/limit_path.h"
#include "gd/limit_shortest.h"
#include "gd/trace.h"
#include "proto/http/options.h"
#include "proto/queries/trace.h"
#include "proto/values/limit_place.h"

struct proto_limit_trace { /* all zero means empty */
    struct proto_limit_trace_request request;
    struct gd_limit_point start;
    uint32_t count; /* number of directions that the request lists, or of its fan */
    uint32_t level; /* level of the mesh, if the trace is not on the smooth surface */
};

/* Reads the optional level of the surface's mesh, or sets the default. Problem: invalid_request. */
bool proto_limit_level_decode(const json_t *document, const struct gd_subdivision *surface,
                              uint32_t *out, struct proto_problem *problem);

struct proto_limit_level {
    uint32_t level;
    bool for_traces, for_paths;
};

/* Decodes a request to build a level in advance. Problem: invalid_request. */
bool proto_limit_level_request(const json_t *document, const struct gd_subdivision *surface,
                               struct proto_limit_level *out, struct proto_problem *problem);

/* Decodes the body of a request. Problems: invalid_request, point_not_on_surface, too_large,
 * insufficient_memory. The caller frees the result by proto_limit_trace_request_free. */
bool proto_limit_trace_decode(const json_t *document, const struct gd_subdivision *surface,
                              struct proto_limit_trace *out, struct proto_problem *problem);

/* Returns the i-th direction as a vector of space. Vectors of the request are returned unchanged;
 * all others lie in the tangent plane of the start's jet. */
struct gd_vec3 proto_limit_trace_direction(const struct proto_limit_trace *trace,
                                           const struct gd_limit_jet *start, uint32_t i);

/* Write a path that was traced on the mesh, as points of the mesh, or on the surface itself. `end`
 * is the surface's jet at the path's end. The geometry selects the form of points, as in path.h. */
void proto_limit_trace_encode_mesh(struct proto_writer *writer, const struct gd_limit_mesh *fine,
                                   const struct gd_trace *trace, const struct gd_limit_jet *end,
                                   enum proto_geometry geometry);
void proto_limit_trace_encode_smooth(struct proto_writer *writer, const struct gd_limit_path *path,
                                     const struct gd_limit_jet *end, enum proto_geometry geometry);

struct proto_limit_pair {
    struct gd_limit_point from, to;
    uint32_t level;
};

/* Decodes the body of a request. Problems: invalid_request, point_not_on_surface. */
bool proto_limit_pair_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_pair *out, struct proto_problem *problem);

/* Writes the answer. `ends` are the surface's points at the two ends. If there is no path,
 * distances and path are null, and the reason is no_path. */
void proto_limit_pair_encode(struct proto_writer *writer, const struct proto_limit_pair *wanted,
                             const struct gd_vec3 ends[2], const struct gd_limit_shortest *found,
                             const struct proto_options *options);
