/* Jet: requests and answers for the evaluation of points of a smooth surface, and for the surface
 * point nearest to a point in space. */
#pragma once

#include "gd/limit.h"
#include "generated/answers.h"
#include "proto/values/limit_place.h"
#include "proto/values/uv.h"

/* Decode points of a parametric surface, each within its domain, or of a subdivision surface.
 * Problems: invalid_request, too_large, point_not_on_surface, insufficient_memory. The caller frees
 * the result by proto_uvs_free and proto_limit_places_free. */
bool proto_jets_decode(const json_t *document, const struct gd_parametric *surface,
                       struct proto_uvs *out, struct proto_problem *problem);
bool proto_limit_jets_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_places *out, struct proto_problem *problem);

/* Decodes a point of space: {"xyz"}, or {"point"} as in the query `nearest` of meshes. Problem:
 * invalid_request. */
bool proto_foot_decode(const json_t *document, struct proto_point *out,
                       struct proto_problem *problem);
bool proto_foot_parse(const struct proto_parameters *parameters, struct proto_point *out,
                      struct proto_problem *problem);

/* Checks that the distance is at most the point's max_snap. Otherwise fails with
 * point_not_on_surface. */
bool proto_foot_check(const struct proto_point *wanted, double distance,
                      struct proto_problem *problem);

/* Writes the selected fields of one point. If the derivatives at the point are parallel, normal and
 * curvatures are null. Where a limit jet is singular, du and dv are unit vectors, second
 * derivatives and curvatures are null, and "singular" is true. The tip of a spike has no normal. */
void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet,
                      const struct proto_options *options);
void proto_limit_jet_encode(struct proto_writer *writer, const struct gd_limit_jet *jet,
                            const struct proto_options *options);
