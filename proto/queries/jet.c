#include "proto/queries/jet.h"

#include <math.h>

#include "generated/requests.h"
#include "proto/json/member.h"
#include "proto/values/point.h"

/* --- the requests ----------------------------------------------------------------------------- */

bool proto_jets_decode(const json_t *document, const struct gd_parametric *surface,
                       struct proto_uvs *out, struct proto_problem *problem)
{
    struct proto_evaluate_request request;
    if (!proto_evaluate_request_decode(document, &request, problem)) return false;
    struct proto_uvs uvs = request.uv;
    for (uint32_t i = 0; i < uvs.count; i++) {
        char place[PROTO_PLACE];
        if (gd_parametric_contains(surface, uvs.items[i][0], uvs.items[i][1])) continue;
        proto_place_of_element(place, "/uv", i);
        proto_uv_check(surface, uvs.items[i], place, problem);
        proto_uvs_free(&uvs);
        return false;
    }
    *out = uvs;
    return true;
}

/* --- the answers ------------------------------------------------------------------------------ */

static void encode_normal(struct proto_writer *writer, const struct gd_curvature *curvature)
{
    if (curvature->regular)
        proto_member_xyz(writer, "normal", curvature->normal);
    else
        proto_member_null(writer, "normal");
}

void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet, uint32_t fields)
{
    const uint32_t wanted =
        proto_fields_within(fields, PROTO_JET_FIELD_POINTS, ~(uint32_t)PROTO_JET_FIELD_POINTS);
    const struct gd_curvature curvature = gd_jet_curvature(jet);
    proto_write_object_begin(writer);
    if (wanted & PROTO_JET_FIELD_XYZ) proto_member_xyz(writer, "xyz", jet->x);
    if (wanted & PROTO_JET_FIELD_NORMAL) encode_normal(writer, &curvature);
    if (wanted & PROTO_JET_FIELD_DU) proto_member_xyz(writer, "du", jet->u);
    if (wanted & PROTO_JET_FIELD_DV) proto_member_xyz(writer, "dv", jet->v);
    if (wanted & PROTO_JET_FIELD_DUU) proto_member_xyz(writer, "duu", jet->uu);
    if (wanted & PROTO_JET_FIELD_DUV) proto_member_xyz(writer, "duv", jet->uv);
    if (wanted & PROTO_JET_FIELD_DVV) proto_member_xyz(writer, "dvv", jet->vv);
    if (wanted & PROTO_JET_FIELD_GAUSSIAN_CURVATURE)
        proto_member_number(writer, "gaussian_curvature",
                            curvature.regular ? curvature.gaussian : NAN);
    if (wanted & PROTO_JET_FIELD_MEAN_CURVATURE)
        proto_member_number(writer, "mean_curvature", curvature.regular ? curvature.mean : NAN);
    proto_write_object_end(writer);
}

void proto_foot_encode(struct proto_writer *writer, const struct gd_parametric_foot *foot,
                       uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_FOOT_FIELD_UV) {
        proto_write_key(writer, "uv");
        proto_write_numbers(writer, (double[]){foot->u, foot->v}, 2);
    }
    if (fields & PROTO_FOOT_FIELD_XYZ) proto_member_xyz(writer, "xyz", foot->xyz);
    if (fields & PROTO_FOOT_FIELD_DISTANCE) proto_member_number(writer, "distance", foot->distance);
    proto_write_object_end(writer);
}
