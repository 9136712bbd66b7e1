#include "proto/queries/limit_jet.h"

#include <math.h>

#include "proto/json/member.h"
#include "proto/values/point.h"

bool proto_limit_jets_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_places *out, struct proto_problem *problem)
{
    struct proto_limit_evaluate_request request;
    if (!proto_limit_evaluate_request_decode(document, &request, problem)) return false;
    bool ok = proto_limit_places_locate(surface, &request.points, out, problem);
    proto_limit_evaluate_request_free(&request);
    return ok;
}

static void encode_vector(struct proto_writer *writer, const char *key, struct gd_vec3 vector,
                          bool is_known)
{
    if (is_known)
        proto_member_xyz(writer, key, vector);
    else
        proto_member_null(writer, key);
}

static void encode_curvatures(struct proto_writer *writer, const struct gd_limit_jet *jet)
{
    proto_write_key(writer, "curvatures");
    if (jet->singular || isnan(jet->curvatures[0]))
        proto_write_null(writer);
    else
        proto_write_numbers(writer, jet->curvatures, 2);
}

void proto_limit_jet_encode(struct proto_writer *writer, const struct gd_limit_jet *jet,
                            uint32_t fields)
{
    const uint32_t wanted = proto_fields_within(fields, PROTO_LIMIT_JET_FIELD_POINTS,
                                                ~(uint32_t)PROTO_LIMIT_JET_FIELD_POINTS);
    const struct {
        const char *key;
        struct gd_vec3 vector;
        bool is_known;
    } vectors[] = {
        {"xyz", jet->position, true},       {"normal", jet->normal, !isnan(jet->normal.x)},
        {"du", jet->du, !isnan(jet->du.x)}, {"dv", jet->dv, !isnan(jet->dv.x)},
        {"duu", jet->duu, !jet->singular},  {"duv", jet->duv, !jet->singular},
        {"dvv", jet->dvv, !jet->singular}};
    proto_write_object_begin(writer);
    for (unsigned i = 0; i < sizeof vectors / sizeof *vectors; i++)
        if (wanted & (PROTO_LIMIT_JET_FIELD_XYZ << i))
            encode_vector(writer, vectors[i].key, vectors[i].vector, vectors[i].is_known);
    if (wanted & PROTO_LIMIT_JET_FIELD_CURVATURES) encode_curvatures(writer, jet);
    if (jet->singular && wanted & PROTO_LIMIT_JET_FIELD_SINGULAR)
        proto_member_bool(writer, "singular", true);
    proto_write_object_end(writer);
}

void proto_limit_foot_encode(struct proto_writer *writer, const struct gd_limit_foot *foot,
                             uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_LIMIT_FOOT_FIELD_FACE) proto_member_uint(writer, "face", foot->place.face);
    if (foot->place.corner && fields & PROTO_LIMIT_FOOT_FIELD_CORNER)
        proto_member_uint(writer, "corner", foot->place.corner);
    if (fields & PROTO_LIMIT_FOOT_FIELD_UV) {
        proto_write_key(writer, "uv");
        proto_write_numbers(writer, (double[]){foot->place.u, foot->place.v}, 2);
    }
    if (fields & PROTO_LIMIT_FOOT_FIELD_XYZ) proto_member_xyz(writer, "xyz", foot->position);
    if (fields & PROTO_LIMIT_FOOT_FIELD_DISTANCE)
        proto_member_number(writer, "distance", foot->distance);
    proto_write_object_end(writer);
}
