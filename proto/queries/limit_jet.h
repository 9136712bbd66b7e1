/* Limit jet: places of a subdivision surface, evaluated, and the place nearest to a point of space.
 *
 *     evaluate   {"points": [place…]}  -> {"points": [{"xyz", "normal", "du", "dv", "duu", "duv",
 *                                                    "dvv", "curvatures"}…]}
 *     nearest    {"xyz": [x, y, z]}    -> {"face", "uv", "xyz", "distance"}: the request is
 *                                         proto_foot_decode's (jet.h) */
#ifndef PROTO_LIMIT_JET_H
#define PROTO_LIMIT_JET_H

#include "gd/limit.h"
#include "proto/values/limit_place.h"
#include "proto/http/options.h"

/* The places. As proto_limit_places_decode. */
bool proto_limit_jets_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_places *out, struct proto_problem *problem);

/* Fields of the answer, as bits of proto_options.fields: its own one, which alone is all of them,
 * and those of each point. */
enum proto_limit_jet_field {
    PROTO_LIMIT_JET_FIELD_POINTS = 1 << 0,
    PROTO_LIMIT_JET_FIELD_XYZ = 1 << 1,
    PROTO_LIMIT_JET_FIELD_NORMAL = 1 << 2,
    PROTO_LIMIT_JET_FIELD_DU = 1 << 3,
    PROTO_LIMIT_JET_FIELD_DV = 1 << 4,
    PROTO_LIMIT_JET_FIELD_DUU = 1 << 5,
    PROTO_LIMIT_JET_FIELD_DUV = 1 << 6,
    PROTO_LIMIT_JET_FIELD_DVV = 1 << 7,
    PROTO_LIMIT_JET_FIELD_CURVATURES = 1 << 8,
    PROTO_LIMIT_JET_FIELD_SINGULAR = 1 << 9
};
extern const char *const proto_limit_jet_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes one point, of its fields the wanted ones. Where the jet is singular, du and dv are unit
 * vectors, second derivatives and curvatures are null, and "singular" says so. What there isn't is
 * null: normals at spikes. */
void proto_limit_jet_encode(struct proto_writer *writer, const struct gd_limit_jet *jet,
                            uint32_t fields);

enum proto_limit_foot_field {
    PROTO_LIMIT_FOOT_FIELD_FACE = 1 << 0,
    PROTO_LIMIT_FOOT_FIELD_CORNER = 1 << 1,
    PROTO_LIMIT_FOOT_FIELD_UV = 1 << 2,
    PROTO_LIMIT_FOOT_FIELD_XYZ = 1 << 3,
    PROTO_LIMIT_FOOT_FIELD_DISTANCE = 1 << 4
};
extern const char *const proto_limit_foot_fields[];

void proto_limit_foot_encode(struct proto_writer *writer, const struct gd_limit_foot *foot,
                             uint32_t fields);

#endif
