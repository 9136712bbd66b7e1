/* Jet: places of a parametric surface, evaluated, and the place nearest to a point of space.
 *
 *     evaluate   {"uv": [[u, v]…]}   -> {"points": [{"xyz", "normal", "du", "dv", "duu", "duv",
 *                                                  "dvv", "gaussian_curvature",
 *                                                  "mean_curvature"}…]}
 *     nearest    {"xyz": [x, y, z]}  -> {"uv", "xyz", "distance"} */
#ifndef PROTO_JET_H
#define PROTO_JET_H

#include "proto/http/options.h"
#include "proto/values/uv.h"

#define PROTO_JETS 100000 /* most places of a request */

/* Each place lies in the surface's domain. invalid_request, too_large, point_not_on_surface,
 * insufficient_memory. Freed by proto_uvs_free. */
bool proto_jets_decode(const json_t *document, const struct gd_parametric *surface,
                       struct proto_uvs *out, struct proto_problem *problem);

/* Fields of the answer, as bits of proto_options.fields: its own one, which alone is all of them,
 * and those of each point. */
enum proto_jet_field {
    PROTO_JET_FIELD_POINTS = 1 << 0,
    PROTO_JET_FIELD_XYZ = 1 << 1,
    PROTO_JET_FIELD_NORMAL = 1 << 2,
    PROTO_JET_FIELD_DU = 1 << 3,
    PROTO_JET_FIELD_DV = 1 << 4,
    PROTO_JET_FIELD_DUU = 1 << 5,
    PROTO_JET_FIELD_DUV = 1 << 6,
    PROTO_JET_FIELD_DVV = 1 << 7,
    PROTO_JET_FIELD_GAUSSIAN = 1 << 8,
    PROTO_JET_FIELD_MEAN = 1 << 9
};
extern const char *const proto_jet_fields[]; /* NULL-terminated, for proto_options_parse */

/* Writes one point, of its fields the wanted ones. Normal and curvatures are null where the
 * derivatives are parallel. */
void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet, uint32_t fields);

/* The point of space. invalid_request. */
bool proto_foot_decode(const json_t *document, struct gd_vec3 *out, struct proto_problem *problem);

enum proto_foot_field {
    PROTO_FOOT_FIELD_UV = 1 << 0,
    PROTO_FOOT_FIELD_XYZ = 1 << 1,
    PROTO_FOOT_FIELD_DISTANCE = 1 << 2
};
extern const char *const proto_foot_fields[];

void proto_foot_encode(struct proto_writer *writer, const struct gd_parametric_foot *foot,
                       uint32_t fields);

#endif
