#include "proto/queries/curve_distance.h"

#include <math.h>

#include "generated/requests.h"
#include "proto/queries/evaluation.h"
#include "proto/json/member.h"
#include "proto/values/path.h"

/* --- the request ------------------------------------------------------------------------------ */

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

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_place(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                         const struct gd_curve_place *place)
{
    proto_write_key(writer, key);
    proto_write_object_begin(writer);
    proto_member_point(writer, "point", mesh, &place->point, NAN);
    proto_member_number(writer, "parameter", place->parameter);
    proto_member_number(writer, "angle", place->angle);
    proto_write_object_end(writer);
}

/* The value of a key is null where there is no path. */
static bool encode_key(struct proto_writer *writer, const char *key, double distance)
{
    proto_write_key(writer, key);
    if (!isfinite(distance)) proto_write_null(writer);
    return isfinite(distance);
}

static void encode_places(struct proto_writer *writer, const char *key, const struct gd_mesh *mesh,
                          double distance, const struct gd_curve_place *a,
                          const struct gd_curve_place *b)
{
    if (!encode_key(writer, key, distance)) return;
    proto_write_object_begin(writer);
    encode_place(writer, "a", mesh, a);
    encode_place(writer, "b", mesh, b);
    proto_write_object_end(writer);
}

static void encode_distance(struct proto_writer *writer, double distance, uint32_t fields)
{
    if (fields & PROTO_CURVE_DISTANCE_FIELD_DISTANCE)
        proto_member_number(writer, "distance", distance);
    if (fields & (PROTO_CURVE_DISTANCE_FIELD_DISTANCE | PROTO_CURVE_DISTANCE_FIELD_REASON))
        proto_reason_encode(writer, distance);
}

static void encode_path(struct proto_writer *writer, const struct gd_mesh *mesh,
                        const struct gd_curve_distance *distance,
                        const struct proto_options *options)
{
    if (!(options->fields & PROTO_CURVE_DISTANCE_FIELD_PATH)) return;
    if (encode_key(writer, "path", distance->distance))
        proto_path_encode(writer, mesh, &distance->path, options->geometry);
}

void proto_curve_distance_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                                 const struct gd_curve_distance *least,
                                 const struct proto_options *options)
{
    proto_write_object_begin(writer);
    encode_distance(writer, least->distance, options->fields);
    if (options->fields & PROTO_CURVE_DISTANCE_FIELD_CLOSEST)
        encode_places(writer, "closest", mesh, least->distance, &least->a, &least->b);
    encode_path(writer, mesh, least, options);
    proto_write_object_end(writer);
}

void proto_hausdorff_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                            const struct gd_curve_distance *from_a,
                            const struct gd_curve_distance *from_b,
                            const struct proto_options *options)
{
    uint32_t fields = options->fields;
    const struct gd_curve_distance *greatest =
        from_a->distance > from_b->distance ? from_a : from_b;
    proto_write_object_begin(writer);
    encode_distance(writer, greatest->distance, fields);
    if (fields & PROTO_CURVE_DISTANCE_FIELD_A_TO_B)
        proto_member_number(writer, "a_to_b", from_a->distance);
    if (fields & PROTO_CURVE_DISTANCE_FIELD_B_TO_A)
        proto_member_number(writer, "b_to_a", from_b->distance);
    if (fields & PROTO_CURVE_DISTANCE_FIELD_FARTHEST) {
        proto_write_key(writer, "farthest");
        proto_write_object_begin(writer);
        encode_places(writer, "a_to_b", mesh, from_a->distance, &from_a->b, &from_a->a);
        encode_places(writer, "b_to_a", mesh, from_b->distance, &from_b->a, &from_b->b);
        proto_write_object_end(writer);
    }
    encode_path(writer, mesh, greatest, options);
    proto_write_object_end(writer);
}
