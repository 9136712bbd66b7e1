#include "proto/queries/curve_operation.h"

#include <math.h>
#include <stdlib.h>

#include "proto/json/writer.h"
#include "proto/values/path.h"

void proto_curve_result_free(struct proto_curve_result *result)
{
    gd_curve_free(&result->curve);
    for (uint32_t i = 0; i < result->path_count; i++) gd_path_free(&result->paths[i]);
    free(result->points);
    free(result->paths);
    free(result->is_closed);
    *result = (struct proto_curve_result){0};
}

/* --- the request ------------------------------------------------------------------------------ */

/* Members of each operation's request. */
static const char *const members[][5] = {
    [PROTO_OPERATION_LENGTH] = {"curve", "operation", NULL},
    [PROTO_OPERATION_RESAMPLE] = {"curve", "operation", "count", NULL},
    [PROTO_OPERATION_SHORTEN] = {"curve", "operation", "rounds", "pieces", NULL},
    [PROTO_OPERATION_CLOSED_GEODESIC] = {"curve", "operation", NULL},
    [PROTO_OPERATION_OFFSET] = {"curve", "operation", "distance", "tolerance", NULL}};

bool proto_curve_operation_request_check(const struct proto_object *object,
                                         struct proto_curve_operation_request *read)
{
    const json_t *document = object->value;
    struct proto_problem *problem = object->problem;
    if (!proto_decode_object(document, "", members[read->operation], problem)) return false;
    if (read->operation == PROTO_OPERATION_RESAMPLE && !read->has_count)
        return proto_decode_member(document, "", "count", problem);
    if (read->operation == PROTO_OPERATION_OFFSET && !read->has_distance)
        return proto_decode_member(document, "", "distance", problem);
    if (proto_object_has(object, "pieces") && !read->has_rounds)
        return proto_problem_refuse(
            problem, "/pieces", "pieces need rounds; without rounds the curve becomes a geodesic");
    if (!read->has_tolerance) read->tolerance = PROTO_CURVE_OPERATION_FLAT * read->distance;
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_curve(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_curve *curve, enum proto_geometry geometry)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", gd_curve_length(mesh, curve));
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_member_array(writer, "points");
        for (uint32_t i = 0; i < curve->count + (curve->closed && curve->count > 1); i++)
            proto_path_point_encode(writer, mesh, &curve->points[i % curve->count], geometry);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}

static void encode_points(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct proto_curve_result *result)
{
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < result->point_count; i++)
        proto_point_encode(writer, mesh, &result->points[i], NAN);
    proto_write_array_end(writer);
}

static void encode_offset(struct proto_writer *writer, const struct gd_mesh *mesh,
                          const struct proto_curve_result *result, enum proto_geometry geometry)
{
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
    bool is_offset = result->operation == PROTO_OPERATION_OFFSET,
         is_shortened = result->operation == PROTO_OPERATION_SHORTEN ||
                        result->operation == PROTO_OPERATION_CLOSED_GEODESIC;
    proto_write_object_begin(writer);
    if (!is_offset && proto_field(writer, options, PROTO_CURVE_OPERATION_FIELD_PATH))
        encode_curve(writer, mesh, &result->curve, options->geometry);
    if (result->operation == PROTO_OPERATION_RESAMPLE &&
        proto_field(writer, options, PROTO_CURVE_OPERATION_FIELD_POINTS))
        encode_points(writer, mesh, result);
    if (is_shortened) {
        proto_field_number(writer, options, PROTO_CURVE_OPERATION_FIELD_TURN, result->turn);
        proto_field_uint(writer, options, PROTO_CURVE_OPERATION_FIELD_ROUNDS, result->rounds);
        proto_field_bool(writer, options, PROTO_CURVE_OPERATION_FIELD_GEODESIC,
                         result->is_geodesic);
    }
    if (is_offset && proto_field(writer, options, PROTO_CURVE_OPERATION_FIELD_PATHS))
        encode_offset(writer, mesh, result, options->geometry);
    proto_write_object_end(writer);
}
