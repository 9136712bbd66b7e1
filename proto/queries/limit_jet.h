/* Limit jet: places of a subdivision surface, evaluated, and the place nearest to a point of space.
 */
#ifndef PROTO_LIMIT_JET_H
#define PROTO_LIMIT_JET_H

#include "gd/limit.h"
#include "proto/values/limit_place.h"
#include "proto/http/options.h"

/* The places. As proto_limit_places_locate; invalid_request, too_large. */
bool proto_limit_jets_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_places *out, struct proto_problem *problem);

/* Writes one point, of its fields the wanted ones. Where the jet is singular, du and dv are unit
 * vectors, second derivatives and curvatures are null, and "singular" says so. What there isn't is
 * null: normals at spikes. */
void proto_limit_jet_encode(struct proto_writer *writer, const struct gd_limit_jet *jet,
                            uint32_t fields);

void proto_limit_foot_encode(struct proto_writer *writer, const struct gd_limit_foot *foot,
                             uint32_t fields);

#endif
