/* Jet: places of a parametric surface, evaluated, and the place nearest to a point of space.
 */
#ifndef PROTO_JET_H
#define PROTO_JET_H

#include "proto/http/options.h"
#include "proto/values/uv.h"

/* Each place lies in the surface's domain. invalid_request, too_large, point_not_on_surface,
 * insufficient_memory. Freed by proto_uvs_free. */
bool proto_jets_decode(const json_t *document, const struct gd_parametric *surface,
                       struct proto_uvs *out, struct proto_problem *problem);

/* Writes one point, of its fields the wanted ones. Normal and curvatures are null where the
 * derivatives are parallel. */
void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet, uint32_t fields);

void proto_foot_encode(struct proto_writer *writer, const struct gd_parametric_foot *foot,
                       uint32_t fields);

#endif
