#include "proto/queries/evaluation.h"

#include <math.h>

#include "proto/json/writer.h"
#include "proto/values/direction.h"
#include "proto/values/path.h"

uint32_t proto_evaluation_wanted(const struct proto_options *options, bool wants_path,
                                 bool wants_gradient)
{
    uint32_t wanted = proto_fields_within(options->fields, PROTO_EVALUATION_FIELD_RESULTS,
                                          ~(uint32_t)PROTO_EVALUATION_FIELD_RESULTS);
    if (!wants_path) wanted &= ~(uint32_t)PROTO_EVALUATION_FIELD_PATH;
    if (!wants_gradient) wanted &= ~(uint32_t)PROTO_EVALUATION_FIELD_GRADIENT;
    return wanted;
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

void proto_distance_encode(struct proto_writer *writer, double distance, uint32_t has_distance,
                           uint32_t has_reason)
{
    if (has_distance) proto_member_number(writer, "distance", distance);
    if (has_distance || has_reason) proto_reason_encode(writer, distance);
}

/* Writes a key, with the value null unless `is_there`. */
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
    proto_distance_encode(writer, result->distance, wanted & PROTO_EVALUATION_FIELD_DISTANCE,
                          wanted & PROTO_EVALUATION_FIELD_REASON);
    if (wanted & PROTO_EVALUATION_FIELD_NEAREST &&
        encode_key(writer, "nearest", isfinite(result->distance)))
        encode_nearest(writer, mesh, set, result);
    if (wanted & PROTO_EVALUATION_FIELD_PATH) {
        proto_write_key(writer, "path");
        proto_path_encode(writer, mesh, result->path, geometry);
    }
    if (wanted & PROTO_EVALUATION_FIELD_GRADIENT &&
        encode_key(writer, "gradient", result->has_gradient))
        proto_direction_encode(writer, &result->gradient);
    proto_write_object_end(writer);
}
