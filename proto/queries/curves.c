#include "proto/queries/curves.h"

#include <math.h>
#include <stdlib.h>

#include "proto/queries/evaluation.h"
#include "proto/values/path.h"

/* --- operations ------------------------------------------------------------------------------- */

void proto_curve_result_free(struct proto_curve_result *result)
{
    gd_curve_free(&result->curve);
    for (uint32_t i = 0; i < result->path_count; i++) gd_path_free(&result->paths[i]);
    free(result->points);
    free(result->paths);
    free(result->is_closed);
    *result = (struct proto_curve_result){0};
}

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

/* --- distance of two curves ------------------------------------------------------------------- */

bool proto_curve_distance_decode(const json_t *document, struct proto_curve_distance *out,
                                 struct proto_problem *problem)
{
    struct proto_curve_distance wanted = {0};
    struct proto_curve_distance_request request;
    if (!proto_curve_distance_request_decode(document, &request, problem)) return false;
    wanted.hausdorff = request.measure == PROTO_MEASURE_HAUSDORFF;
    if (!proto_set_decode_curve(document, "a", &wanted.a, problem)) return false;
    if (!proto_set_decode_curve(document, "b", &wanted.b, problem)) {
        proto_curve_distance_free(&wanted);
        return false;
    }
    *out = wanted;
    return true;
}

void proto_curve_distance_free(struct proto_curve_distance *wanted)
{
    proto_set_free(&wanted->a);
    proto_set_free(&wanted->b);
}

static void encode_place(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                         const struct gd_curve_place *place)
{
    proto_member_object(writer, key);
    proto_member_point(writer, "point", mesh, &place->point, NAN);
    proto_member_number(writer, "parameter", place->parameter);
    proto_member_number(writer, "angle", place->angle);
    proto_write_object_end(writer);
}

/* Writes both ends; writes null if there is no path. */
static void encode_places(struct proto_writer *writer, const struct gd_mesh *mesh, double distance,
                          const struct gd_curve_place *a, const struct gd_curve_place *b)
{
    if (!isfinite(distance)) {
        proto_write_null(writer);
        return;
    }
    proto_write_object_begin(writer);
    encode_place(writer, "a", mesh, a);
    encode_place(writer, "b", mesh, b);
    proto_write_object_end(writer);
}

static void encode_distance(struct proto_writer *writer, double distance, uint32_t fields)
{
    proto_distance_encode(writer, distance, fields & PROTO_CURVE_DISTANCE_FIELD_DISTANCE,
                          fields & PROTO_CURVE_DISTANCE_FIELD_REASON);
}

static void encode_path(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_curve_distance *distance,
                        const struct proto_options *options)
{
    const struct gd_path *path = isfinite(distance->distance) ? &distance->path : NULL;
    if (proto_field(writer, options, PROTO_CURVE_DISTANCE_FIELD_PATH))
        proto_path_encode(writer, mesh, path, options->geometry);
}

void proto_curve_distance_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                                 const struct gd_curve_distance *least,
                                 const struct proto_options *options)
{
    proto_write_object_begin(writer);
    encode_distance(writer, least->distance, options->fields);
    if (proto_field(writer, options, PROTO_CURVE_DISTANCE_FIELD_CLOSEST))
        encode_places(writer, mesh, least->distance, &least->a, &least->b);
    encode_path(writer, mesh, least, options);
    proto_write_object_end(writer);
}

void proto_hausdorff_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                            const struct gd_curve_distance *from_a,
                            const struct gd_curve_distance *from_b,
                            const struct proto_options *options)
{
    const struct gd_curve_distance *greatest =
        from_a->distance > from_b->distance ? from_a : from_b;
    proto_write_object_begin(writer);
    encode_distance(writer, greatest->distance, options->fields);
    proto_field_number(writer, options, PROTO_CURVE_DISTANCE_FIELD_A_TO_B, from_a->distance);
    proto_field_number(writer, options, PROTO_CURVE_DISTANCE_FIELD_B_TO_A, from_b->distance);
    if (proto_field(writer, options, PROTO_CURVE_DISTANCE_FIELD_FARTHEST)) {
        proto_write_object_begin(writer);
        proto_write_key(writer, "a_to_b");
        encode_places(writer, mesh, from_a->distance, &from_a->b, &from_a->a);
        proto_write_key(writer, "b_to_a");
        encode_places(writer, mesh, from_b->distance, &from_b->a, &from_b->b);
        proto_write_object_end(writer);
    }
    encode_path(writer, mesh, greatest, options);
    proto_write_object_end(writer);
}

/* --- cut -------------------------------------------------------------------------------------- */

bool proto_cut_request_check(const struct proto_object *object, struct proto_cut_request *read)
{
    return !read->select_only || !read->names.count ||
           proto_problem_refuse(
               object->problem, "/names",
               "\"select_only\" makes no meshes, so there is nothing to name; leave one out");
}

#define PIECE_FIELDS                                                                               \
    (PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_VERTICES | PROTO_CUT_FIELD_FACES |                     \
     PROTO_CUT_FIELD_AREA | PROTO_CUT_FIELD_VERTEX_MAP | PROTO_CUT_FIELD_FACE_MAP)

/* Returns the selected fields of a piece; 0 means no pieces. */
static uint32_t piece_fields(uint32_t fields)
{
    return proto_fields_within(fields, PROTO_CUT_FIELD_PIECES, PIECE_FIELDS);
}

void proto_cut_begin(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields)
{
    proto_write_object_begin(writer);
    if (fields & PROTO_CUT_FIELD_SEPARATES) proto_member_bool(writer, "separates", cut->separates);
    if (!piece_fields(fields)) return;
    proto_member_array(writer, "pieces");
}

void proto_cut_end(struct proto_writer *writer, const struct gd_cut *cut, uint32_t fields)
{
    if (piece_fields(fields)) proto_write_array_end(writer);
    if (fields & PROTO_CUT_FIELD_LARGEST_SHIFT)
        proto_member_number(writer, "largest_shift", cut->largest_shift);
    proto_write_object_end(writer);
}

void proto_cut_piece_encode(struct proto_writer *writer, const struct gd_cut_piece *piece,
                            const char *name, uint32_t fields)
{
    static const uint32_t of_meshes =
        PROTO_CUT_FIELD_NAME | PROTO_CUT_FIELD_VERTICES | PROTO_CUT_FIELD_VERTEX_MAP;
    uint32_t wanted = piece_fields(fields);
    if (!wanted) return;
    if (!name) wanted &= ~of_meshes;
    const struct proto_options options = {.fields = wanted, .names = proto_cut_fields};
    uint32_t vertices = piece->polygons.position_count;
    proto_write_object_begin(writer);
    if (proto_field(writer, &options, PROTO_CUT_FIELD_NAME)) proto_write_string(writer, name);
    proto_field_uint(writer, &options, PROTO_CUT_FIELD_VERTICES, vertices);
    proto_field_uint(writer, &options, PROTO_CUT_FIELD_FACES, piece->face_count);
    proto_field_number(writer, &options, PROTO_CUT_FIELD_AREA, piece->area);
    if (proto_field(writer, &options, PROTO_CUT_FIELD_VERTEX_MAP))
        proto_write_indices(writer, piece->vertex_map, vertices);
    if (proto_field(writer, &options, PROTO_CUT_FIELD_FACE_MAP))
        proto_write_indices(writer, piece->face_map, piece->face_count);
    proto_write_object_end(writer);
}
