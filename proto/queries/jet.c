#include "proto/queries/jet.h"

#include <math.h>

#include "generated/requests.h"
#include "proto/json/decode.h"
#include "proto/json/writer.h"
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

bool proto_limit_jets_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_places *out, struct proto_problem *problem)
{
    struct proto_limit_evaluate_request request;
    if (!proto_limit_evaluate_request_decode(document, &request, problem)) return false;
    bool ok = proto_limit_places_locate(surface, &request.points, out, problem);
    proto_limit_evaluate_request_free(&request);
    return ok;
}

/* --- the answers ------------------------------------------------------------------------------ */

static void encode_vector(struct proto_writer *writer, const struct proto_options *options,
                          uint32_t field, struct gd_vec3 vector)
{
    if (!proto_field(writer, options, field)) return;
    if (isnan(vector.x))
        proto_write_null(writer);
    else
        proto_xyz_encode(writer, vector);
}

static const struct gd_vec3 none = {NAN, NAN, NAN};

void proto_jet_encode(struct proto_writer *writer, const struct gd_jet *jet,
                      const struct proto_options *options)
{
    const struct proto_options wanted = proto_options_within(options, PROTO_JET_FIELD_POINTS);
    const struct gd_curvature curvature = gd_jet_curvature(jet);
    proto_write_object_begin(writer);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_XYZ, jet->x);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_NORMAL,
                  curvature.regular ? curvature.normal : none);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_DU, jet->u);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_DV, jet->v);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_DUU, jet->uu);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_DUV, jet->uv);
    encode_vector(writer, &wanted, PROTO_JET_FIELD_DVV, jet->vv);
    proto_field_number(writer, &wanted, PROTO_JET_FIELD_GAUSSIAN_CURVATURE,
                       curvature.regular ? curvature.gaussian : NAN);
    proto_field_number(writer, &wanted, PROTO_JET_FIELD_MEAN_CURVATURE,
                       curvature.regular ? curvature.mean : NAN);
    proto_write_object_end(writer);
}

void proto_limit_jet_encode(struct proto_writer *writer, const struct gd_limit_jet *jet,
                            const struct proto_options *options)
{
    const struct proto_options wanted = proto_options_within(options, PROTO_LIMIT_JET_FIELD_POINTS);
    proto_write_object_begin(writer);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_XYZ, jet->position);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_NORMAL, jet->normal);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_DU, jet->du);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_DV, jet->dv);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_DUU, jet->singular ? none : jet->duu);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_DUV, jet->singular ? none : jet->duv);
    encode_vector(writer, &wanted, PROTO_LIMIT_JET_FIELD_DVV, jet->singular ? none : jet->dvv);
    if (proto_field(writer, &wanted, PROTO_LIMIT_JET_FIELD_CURVATURES)) {
        if (jet->singular || isnan(jet->curvatures[0]))
            proto_write_null(writer);
        else
            proto_write_numbers(writer, jet->curvatures, 2);
    }
    if (jet->singular) proto_field_bool(writer, &wanted, PROTO_LIMIT_JET_FIELD_SINGULAR, true);
    proto_write_object_end(writer);
}

static bool foot_check_form(const struct proto_point *point, struct proto_problem *problem)
{
    return point->form == PROTO_POINT_XYZ ||
           proto_problem_refuse(problem, point->place,
                                "write a point of space: {\"xyz\": [1, 2, 3]} or p:1,2,3");
}

bool proto_foot_decode(const json_t *document, struct proto_point *out,
                       struct proto_problem *problem)
{
    struct proto_nearest_request request;
    bool is_bare = json_object_get(document, "xyz") && !json_object_get(document, "point");
    if (is_bare) return proto_point_decode(document, "", out, problem);
    if (!proto_nearest_request_decode(document, &request, problem) ||
        !foot_check_form(&request.point, problem))
        return false;
    *out = request.point;
    return true;
}

bool proto_foot_parse(const struct proto_parameters *parameters, struct proto_point *out,
                      struct proto_problem *problem)
{
    const char *text = proto_parameters_require(parameters, "point", problem);
    return text && proto_point_parse(text, "point", out, problem) && foot_check_form(out, problem);
}

bool proto_foot_check(const struct proto_point *wanted, double distance,
                      struct proto_problem *problem)
{
    double most = wanted->max_snap;
    if (!wanted->has_max_snap || distance <= most) return true;
    proto_problem_set(problem, PROTO_PROBLEM_POINT_NOT_ON_SURFACE,
                      "the nearest point of the surface is %.17g away, farther than max_snap = "
                      "%.17g",
                      distance, most);
    return proto_problem_at(problem, wanted->place);
}
