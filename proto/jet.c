#include "proto/jet.h"

#include "proto/decode.h"
#include "proto/member.h"
#include "proto/point.h"

const char *const proto_jet_fields[] = {
    "points", "xyz", "normal", "du", "dv", "duu", "duv", "dvv", "gaussian_curvature", "mean_curvature", NULL};
const char *const proto_foot_fields[] = {"uv", "xyz", "distance", NULL};

/* --- the requests ------------------------------------------------------------------------------------------------- */

bool proto_jets_decode(const json_t *document, const struct gd_parametric *surface, struct proto_uvs *out,
                       struct proto_problem *problem)
{
    static const char *const members[] = {"uv", NULL};
    struct proto_uvs uvs;
    if (!proto_decode_object(document, "", members, problem) ||
        !proto_uvs_decode(document, "", "uv", PROTO_JETS, &uvs, problem))
        return false;
    for (uint32_t i = 0; i < uvs.count; i++) {
        char place[PROTO_UV_PLACE];
        if (gd_parametric_contains(surface, uvs.items[i][0], uvs.items[i][1])) continue;
        proto_place_of_element(place, "/uv", i);
        proto_uv_check(surface, uvs.items[i], place, problem);
        proto_uvs_free(&uvs);
        return false;
    }
    *out = uvs;
    return true;
}

bool proto_foot_decode(const json_t *document, struct gd_vec3 *out, struct proto_problem *problem)
{
    static const char *const members[] = {"xyz", NULL};
    double xyz[3];
    if (!proto_decode_object(document, "", members, problem) ||
        !proto_decode_numbers(document, "", "xyz", 3, xyz, problem))
        return false;
    *out = (struct gd_vec3){xyz[0], xyz[1], xyz[2]};
    return true;
}

/* --- the answers -------------------------------------------------------------------------------------------------- */

static void encode_vector(struct proto_writer *writer, const char *key, struct gd_vec3 vector, bool is_wanted)
{
    if (!is_wanted) return;
    proto_write_key(writer, key);
    proto_xyz_encode(writer, vector);
}

static void encode_curvature(struct proto_writer *writer, const char *key, double value, bool is_regular,
                             bool is_wanted)
{
    if (!is_wanted) return;
    proto_write_key(writer, key);
    if (is_regular)
        proto_write_number(writer, value);
    else
        proto_write_null(writer);
}

static void encode_normal(struct proto_writer *writer, const struct gd_curvature *curvature)
{
    proto_write_key(writer, "normal");
    if (curvature->regular)
        proto_xyz_encode(writer, curvature->normal);
    else
        proto_write_null(writer);
}

void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet, uint32_t fields)
{
    const uint32_t wanted = proto_fields_within(fields, PROTO_JET_FIELD_POINTS, ~(uint32_t)PROTO_JET_FIELD_POINTS);
    const struct gd_curvature curvature = gd_jet_curvature(jet);
    proto_write_object_begin(writer);
    encode_vector(writer, "xyz", jet->x, wanted & PROTO_JET_FIELD_XYZ);
    if (wanted & PROTO_JET_FIELD_NORMAL) encode_normal(writer, &curvature);
    encode_vector(writer, "du", jet->u, wanted & PROTO_JET_FIELD_DU);
    encode_vector(writer, "dv", jet->v, wanted & PROTO_JET_FIELD_DV);
    encode_vector(writer, "duu", jet->uu, wanted & PROTO_JET_FIELD_DUU);
    encode_vector(writer, "duv", jet->uv, wanted & PROTO_JET_FIELD_DUV);
    encode_vector(writer, "dvv", jet->vv, wanted & PROTO_JET_FIELD_DVV);
    encode_curvature(writer, "gaussian_curvature", curvature.gaussian, curvature.regular,
                     wanted & PROTO_JET_FIELD_GAUSSIAN);
    encode_curvature(writer, "mean_curvature", curvature.mean, curvature.regular, wanted & PROTO_JET_FIELD_MEAN);
    proto_write_object_end(writer);
}

void proto_foot_encode(struct proto_writer *writer, const struct gd_parametric_foot *foot, uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_FOOT_FIELD_UV) {
        proto_write_key(writer, "uv");
        proto_write_numbers(writer, (double[]){foot->u, foot->v}, 2);
    }
    encode_vector(writer, "xyz", foot->xyz, fields & PROTO_FOOT_FIELD_XYZ);
    if (fields & PROTO_FOOT_FIELD_DISTANCE) proto_member_number(writer, "distance", foot->distance);
    proto_write_object_end(writer);
}
