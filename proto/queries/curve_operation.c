#include "proto/queries/curve_operation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/json/decode.h"
#include "proto/json/member.h"
#include "proto/values/path.h"

const char *const proto_curve_operation_fields[] = {"path",     "points", "turn", "rounds",
                                                    "geodesic", "paths",  NULL};

void proto_curve_operation_free(struct proto_curve_operation *operation)
{
    proto_curve_free(&operation->curve);
}

void proto_curve_result_free(struct proto_curve_result *result)
{
    gd_curve_free(&result->curve);
    for (uint32_t i = 0; i < result->path_count; i++) gd_path_free(&result->paths[i]);
    free(result->points);
    free(result->paths);
    free(result->is_closed);
    *result = (struct proto_curve_result){0};
}

/* --- arguments -------------------------------------------------------------------------------- */

static bool refuse_member(const char *member, struct proto_problem *problem, const char *sentence)
{
    proto_problem_refuse(problem, "", "%s", sentence);
    return proto_problem_descend(problem, member);
}

static bool decode_number_of(const json_t *document, const char *member, uint32_t least,
                             uint32_t most, uint32_t *out, struct proto_problem *problem)
{
    if (!proto_decode_index(document, "", member, out, problem)) return false;
    if (*out >= least && *out <= most) return true;
    proto_problem_refuse(problem, "", "%s is a number from %u to %u", member, least, most);
    return proto_problem_descend(problem, member);
}

static bool decode_length(const json_t *document, const char *member, double *out,
                          struct proto_problem *problem)
{
    return proto_decode_number(document, "", member, out, problem) &&
           (*out > 0 || refuse_member(member, problem, "this is a length, more than 0"));
}

static bool decode_nothing(const json_t *document, struct proto_curve_operation *out,
                           struct proto_problem *problem)
{
    (void)document, (void)out, (void)problem;
    return true;
}

static bool decode_resample(const json_t *document, struct proto_curve_operation *out,
                            struct proto_problem *problem)
{
    return decode_number_of(document, "count", 2, PROTO_CURVE_OPERATION_COUNT, &out->count,
                            problem);
}

static bool decode_shorten(const json_t *document, struct proto_curve_operation *out,
                           struct proto_problem *problem)
{
    bool has_rounds = json_object_get(document, "rounds"),
         has_pieces = json_object_get(document, "pieces");
    if (has_pieces && !has_rounds)
        return refuse_member("pieces", problem,
                             "pieces go with rounds; without these the curve becomes a geodesic");
    return (!has_rounds || decode_number_of(document, "rounds", 1, PROTO_CURVE_OPERATION_ROUNDS,
                                            &out->rounds, problem)) &&
           (!has_pieces || decode_number_of(document, "pieces", 1, PROTO_CURVE_OPERATION_PIECES,
                                            &out->pieces, problem));
}

static bool decode_offset(const json_t *document, struct proto_curve_operation *out,
                          struct proto_problem *problem)
{
    if (!decode_length(document, "distance", &out->distance, problem)) return false;
    out->tolerance = PROTO_CURVE_OPERATION_FLAT * out->distance;
    return !json_object_get(document, "tolerance") ||
           decode_length(document, "tolerance", &out->tolerance, problem);
}

/* An operation, its arguments (besides the curve and its name), and `decode` for them. */
static const struct form {
    const char *name;
    const char *members[6];
    bool (*decode)(const json_t *document, struct proto_curve_operation *out,
                   struct proto_problem *problem);
} forms[] = {[PROTO_OPERATION_LENGTH] = {"length", {"curve", "operation", NULL}, decode_nothing},
             [PROTO_OPERATION_RESAMPLE] = {"resample",
                                           {"curve", "operation", "count", NULL},
                                           decode_resample},
             [PROTO_OPERATION_SHORTEN] = {"shorten",
                                          {"curve", "operation", "rounds", "pieces", NULL},
                                          decode_shorten},
             [PROTO_OPERATION_CLOSED_GEODESIC] = {"closed-geodesic",
                                                  {"curve", "operation", NULL},
                                                  decode_nothing},
             [PROTO_OPERATION_OFFSET] = {
                 "offset", {"curve", "operation", "distance", "tolerance", NULL}, decode_offset}};

#define FORMS (sizeof forms / sizeof *forms)

static bool find_form(const json_t *document, enum proto_operation *out,
                      struct proto_problem *problem)
{
    const json_t *operation = proto_decode_member(document, "", "operation", problem);
    if (!operation) return false;
    for (size_t i = 0; i < FORMS && json_is_string(operation); i++) {
        if (strcmp(json_string_value(operation), forms[i].name) != 0) continue;
        *out = (enum proto_operation)i;
        return true;
    }
    return proto_problem_refuse(
        problem, "/operation",
        "an operation is \"length\", \"resample\", \"shorten\", \"closed-geodesic\" or \"offset\"");
}

bool proto_curve_operation_decode(const json_t *document, struct proto_curve_operation *out,
                                  struct proto_problem *problem)
{
    static const char *const all[] = {"curve",  "operation", "count",     "rounds",
                                      "pieces", "distance",  "tolerance", NULL};
    struct proto_curve_operation operation = {0};
    if (!proto_decode_object(document, "", all, problem) ||
        !find_form(document, &operation.operation, problem))
        return false;
    const struct form *form = &forms[operation.operation];
    const json_t *curve = proto_decode_member(document, "", "curve", problem);
    if (!curve || !proto_decode_object(document, "", form->members, problem) ||
        !form->decode(document, &operation, problem) ||
        !proto_curve_decode(curve, "/curve", &operation.curve, problem))
        return false;
    *out = operation;
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_curve(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_curve *curve, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", gd_curve_length(mesh, curve));
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < curve->count + (curve->closed && curve->count > 1); i++)
            proto_path_point_encode(writer, mesh, &curve->points[i % curve->count], geometry);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}

static void encode_points(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct proto_curve_result *result)
{
    proto_write_key(writer, "points");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < result->point_count; i++)
        proto_point_encode(writer, mesh, &result->points[i], NAN);
    proto_write_array_end(writer);
}

static void encode_shortening(struct proto_writer *writer, const struct proto_curve_result *result,
                              uint32_t fields)
{
    if (fields & PROTO_CURVE_OPERATION_FIELD_TURN)
        proto_member_number(writer, "turn", result->turn);
    if (fields & PROTO_CURVE_OPERATION_FIELD_ROUNDS)
        proto_member_uint(writer, "rounds", result->rounds);
    if (fields & PROTO_CURVE_OPERATION_FIELD_GEODESIC)
        proto_member_bool(writer, "geodesic", result->is_geodesic);
}

static void encode_offset(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct proto_curve_result *result, enum proto_geometry geometry)
{
    proto_write_key(writer, "paths");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < result->path_count; i++) {
        proto_write_object_begin(writer);
        proto_member_bool(writer, "closed", result->is_closed[i]);
        proto_write_key(writer, "path");
        proto_path_encode(writer, mesh, &result->paths[i], geometry);
        proto_write_object_end(writer);
    }
    proto_write_array_end(writer);
}

void proto_curve_result_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                               const struct proto_curve_result *result,
                               const struct proto_options *options)
{
    uint32_t fields = options->fields;
    bool is_offset = result->operation == PROTO_OPERATION_OFFSET,
         is_shortened = result->operation == PROTO_OPERATION_SHORTEN ||
                        result->operation == PROTO_OPERATION_CLOSED_GEODESIC;
    proto_write_object_begin(writer);
    if (!is_offset && fields & PROTO_CURVE_OPERATION_FIELD_PATH) {
        proto_write_key(writer, "path");
        encode_curve(writer, mesh, &result->curve, options->geometry);
    }
    if (result->operation == PROTO_OPERATION_RESAMPLE &&
        fields & PROTO_CURVE_OPERATION_FIELD_POINTS)
        encode_points(writer, mesh, result);
    if (is_shortened) encode_shortening(writer, result, fields);
    if (is_offset && fields & PROTO_CURVE_OPERATION_FIELD_PATHS)
        encode_offset(writer, mesh, result, options->geometry);
    proto_write_object_end(writer);
}
