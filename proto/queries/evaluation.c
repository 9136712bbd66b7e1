#include "proto/queries/evaluation.h"

#include <math.h>

#include "proto/json/decode.h"
#include "proto/values/direction.h"
#include "proto/json/member.h"
#include "proto/values/path.h"

const char *const proto_evaluation_fields[] = {"results", "distance", "reason", "nearest",
                                               "path",    "gradient", NULL};
const char *const proto_distance_to_set_fields[] = {"results", "distance", "reason",
                                                    "nearest", "path",     NULL};

/* --- the request ------------------------------------------------------------------------------ */

/* On failure the list may have some of them. */
static bool decode_points(const json_t *document, struct proto_points *points,
                          struct proto_problem *problem)
{
    const json_t *value = proto_decode_member(document, "", "points", problem);
    if (!value || !proto_points_decode(points, value, "/points", PROTO_EVALUATION_POINTS, problem))
        return false;
    return points->count || proto_problem_refuse(problem, "/points", "name at least one point");
}

static bool decode(const json_t *document, struct proto_evaluation *out,
                   struct proto_problem *problem)
{
    struct proto_evaluation evaluation = {0};
    if (!proto_decode_flag(document, "", "path", &evaluation.wants_path, problem)) return false;
    if (!proto_decode_flag(document, "", "gradient", &evaluation.wants_gradient, problem))
        return false;
    if (!decode_points(document, &evaluation.points, problem)) {
        proto_points_free(&evaluation.points);
        return false;
    }
    *out = evaluation;
    return true;
}

bool proto_evaluation_decode(const json_t *document, struct proto_evaluation *out,
                             struct proto_problem *problem)
{
    static const char *const members[] = {"points", "path", "gradient", NULL};
    return proto_decode_object(document, "", members, problem) && decode(document, out, problem);
}

bool proto_evaluation_decode_with_set(const json_t *document, struct proto_set *set,
                                      struct proto_evaluation *out, struct proto_problem *problem)
{
    static const char *const members[] = {"set", "points", "path", NULL};
    struct proto_set decoded;
    if (!proto_decode_object(document, "", members, problem)) return false;
    const json_t *value = proto_decode_member(document, "", "set", problem);
    if (!value || !proto_set_decode(value, "/set", &decoded, problem)) return false;
    if (!decode(document, out, problem)) {
        proto_set_free(&decoded);
        return false;
    }
    *set = decoded;
    return true;
}

void proto_evaluation_free(struct proto_evaluation *evaluation)
{
    proto_points_free(&evaluation->points);
    *evaluation = (struct proto_evaluation){0};
}

/* --- the answer ------------------------------------------------------------------------------- */

uint32_t proto_evaluation_wanted(const struct proto_evaluation *evaluation,
                                 const struct proto_options *options)
{
    uint32_t wanted = proto_fields_within(options->fields, PROTO_RESULT_FIELD_RESULTS,
                                          ~(uint32_t)PROTO_RESULT_FIELD_RESULTS);
    if (!evaluation->wants_path) wanted &= ~(uint32_t)PROTO_RESULT_FIELD_PATH;
    if (!evaluation->wants_gradient) wanted &= ~(uint32_t)PROTO_RESULT_FIELD_GRADIENT;
    return wanted;
}

void proto_results_begin(struct proto_writer *writer)
{
    proto_write_object_begin(writer);
    proto_write_key(writer, "results");
    proto_write_array_begin(writer);
}

void proto_results_end(struct proto_writer *writer)
{
    proto_write_array_end(writer);
    proto_write_object_end(writer);
}

static void encode_nearest(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct proto_located_set *set, const struct proto_result *result)
{
    proto_write_object_begin(writer);
    proto_member_uint(writer, "index", result->member);
    proto_member_string(writer, "label", proto_located_set_label(set, result->member));
    proto_member_point(writer, "point", mesh, &result->nearest, NAN);
    proto_write_object_end(writer);
}

const char *proto_reason(double distance)
{
    return isnan(distance) ? "beyond_max_distance" : "no_path";
}

void proto_reason_encode(struct proto_writer *writer, double distance)
{
    if (isfinite(distance)) return;
    proto_member_string(writer, "reason", proto_reason(distance));
}

static void encode_distance(struct proto_writer *writer, double distance, uint32_t wanted)
{
    if (wanted & PROTO_RESULT_FIELD_DISTANCE) proto_member_number(writer, "distance", distance);
    if (wanted & (PROTO_RESULT_FIELD_DISTANCE | PROTO_RESULT_FIELD_REASON))
        proto_reason_encode(writer, distance);
}

/* The value of a key is null unless it `is_there`. */
static bool encode_key(struct proto_writer *writer, const char *key, bool is_there)
{
    proto_write_key(writer, key);
    if (!is_there) proto_write_null(writer);
    return is_there;
}

void proto_result_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct proto_located_set *set, const struct proto_result *result,
                         uint32_t wanted, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    encode_distance(writer, result->distance, wanted);
    if (wanted & PROTO_RESULT_FIELD_NEAREST &&
        encode_key(writer, "nearest", isfinite(result->distance)))
        encode_nearest(writer, mesh, set, result);
    if (wanted & PROTO_RESULT_FIELD_PATH && encode_key(writer, "path", result->path))
        proto_path_encode(writer, mesh, result->path, geometry);
    if (wanted & PROTO_RESULT_FIELD_GRADIENT &&
        encode_key(writer, "gradient", result->has_gradient))
        proto_direction_encode(writer, &result->gradient);
    proto_write_object_end(writer);
}
