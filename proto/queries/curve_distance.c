#include "proto/queries/curve_distance.h"

#include <math.h>

#include "generated/requests.h"
#include "proto/json/writer.h"
#include "proto/queries/evaluation.h"
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
