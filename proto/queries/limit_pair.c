#include "proto/queries/limit_pair.h"

#include <math.h>

#include "proto/queries/limit_trace.h"
#include "proto/json/member.h"

bool proto_limit_pair_decode(const json_t *document, const struct gd_subdivision *surface,
                             struct proto_limit_pair *out, struct proto_problem *problem)
{
    struct proto_limit_pair_request request;
    struct proto_limit_pair pair;
    if (!proto_limit_pair_request_decode(document, &request, problem) ||
        !proto_limit_place_locate(surface, &request.from, "/from", &pair.from, problem) ||
        !proto_limit_place_locate(surface, &request.to, "/to", &pair.to, problem) ||
        !proto_limit_level_decode(document, surface, &pair.level, problem))
        return false;
    *out = pair;
    return true;
}

static void encode_number(struct proto_writer *writer, const char *key, double value,
                          bool is_wanted)
{
    if (!is_wanted) return;
    proto_member_number(writer, key, value); /* infinite: null */
}

static void encode_distance(struct proto_writer *writer, const struct gd_limit_shortest *found,
                            uint32_t fields)
{
    bool is_there = isfinite(found->distance);
    encode_number(writer, "distance", found->distance, fields & PROTO_LIMIT_PATH_FIELD_DISTANCE);
    if (!is_there && fields & (PROTO_LIMIT_PATH_FIELD_DISTANCE | PROTO_LIMIT_PATH_FIELD_REASON))
        proto_member_string(writer, "reason", "no_path");
    if (!is_there) return;
    encode_number(writer, "error_estimate", found->error_estimate,
                  fields & PROTO_LIMIT_PATH_FIELD_ERROR_ESTIMATE);
    if (fields & PROTO_LIMIT_PATH_FIELD_RELAXED)
        proto_member_bool(writer, "relaxed", found->relaxed);
    encode_number(writer, "mesh_distance", found->mesh_distance,
                  fields & PROTO_LIMIT_PATH_FIELD_MESH_DISTANCE);
}

static void encode_path(struct proto_writer *writer, const struct gd_limit_shortest *found,
                        enum proto_geometry geometry)
{
    proto_write_key(writer, "path");
    if (!isfinite(found->distance)) {
        proto_write_null(writer);
        return;
    }
    proto_write_object_begin(writer);
    encode_number(writer, "length", found->distance, true);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        proto_limit_steps_encode(writer, found->steps, found->step_count, geometry);
    }
    proto_write_object_end(writer);
}

void proto_limit_pair_encode(struct proto_writer *writer, const struct proto_limit_pair *wanted,
                             const struct gd_vec3 ends[2], const struct gd_limit_shortest *found,
                             const struct proto_options *options)
{
    uint32_t fields = options->fields;
    proto_write_object_begin(writer);
    encode_distance(writer, found, fields);
    if (fields & PROTO_LIMIT_PATH_FIELD_LEVEL) proto_member_uint(writer, "level", wanted->level);
    if (fields & PROTO_LIMIT_PATH_FIELD_FROM) {
        proto_write_key(writer, "from");
        proto_limit_place_encode(writer, &wanted->from, ends[0]);
    }
    if (fields & PROTO_LIMIT_PATH_FIELD_TO) {
        proto_write_key(writer, "to");
        proto_limit_place_encode(writer, &wanted->to, ends[1]);
    }
    if (fields & PROTO_LIMIT_PATH_FIELD_PATH) encode_path(writer, found, options->geometry);
    proto_write_object_end(writer);
}
