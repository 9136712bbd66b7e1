/* Jet: places of a smooth surface, evaluated, and the place nearest to a point of space. */
#ifndef PROTO_JET_H
#define PROTO_JET_H

#include "gd/limit.h"
#include "proto/http/options.h"
#include "proto/values/limit_place.h"
#include "proto/values/uv.h"

/* Places of a parametric surface, each in its domain, and of a subdivision surface.
 * invalid_request, too_large, point_not_on_surface, insufficient_memory. Freed by proto_uvs_free,
 * and by proto_limit_places_free. */
bool proto_jets_decode(const json_t *document, const struct gd_parametric *surface,
                       struct proto_uvs *out, struct proto_problem *problem);
bool proto_limit_jets_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_places *out, struct proto_problem *problem);

/* A point of space, as {"xyz"} or as {"point"} that `nearest` of meshes takes. invalid_request. */
struct proto_foot_request;
bool proto_foot_decode(const json_t *document, struct proto_foot_request *out,
                       struct proto_problem *problem);

/* Writes one point, of its fields the wanted ones. Normal and curvatures are null where the
 * derivatives are parallel. Where a limit jet is singular, du and dv are unit vectors, second
 * derivatives and curvatures are null, and "singular" says so; at spikes there is no normal. */
void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet,
                      const struct proto_options *options);
void proto_limit_jet_encode(struct proto_writer *writer, const struct gd_limit_jet *jet,
                            const struct proto_options *options);

void proto_foot_encode(struct proto_writer *writer, const struct gd_parametric_foot *foot,
                       const struct proto_options *options);
void proto_limit_foot_encode(struct proto_writer *writer, const struct gd_limit_foot *foot,
                             const struct proto_options *options);

#endif
