#include "proto/queries/sampling.h"

#include <math.h>

#include "proto/json/decode.h"

const char *const proto_sampling_fields[] = {"points", "radii", NULL};

/* --- the request ------------------------------------------------------------------------------ */

static bool decode_count(const json_t *document, uint32_t *out, struct proto_problem *problem)
{
    uint32_t count;
    if (!proto_decode_index(document, "", "count", &count, problem)) return false;
    if (count == 0) return proto_problem_refuse(problem, "/count", "ask for at least one point");
    *out = count;
    if (count <= PROTO_SAMPLING_POINTS) return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "at most %d points are chosen here; ask for fewer", PROTO_SAMPLING_POINTS);
    proto_problem_at(problem, "/count");
    return proto_problem_limit(problem, PROTO_SAMPLING_POINTS);
}

bool proto_sampling_decode(const json_t *document, struct proto_sampling *out,
                           struct proto_problem *problem)
{
    static const char *const members[] = {"count", "start", NULL};
    struct proto_sampling sampling = {0};
    if (!proto_decode_object(document, "", members, problem)) return false;
    if (!decode_count(document, &sampling.count, problem)) return false;
    const json_t *start = json_object_get(document, "start");
    sampling.has_start = start != NULL;
    if (start && !proto_point_decode(start, "/start", &sampling.start, problem)) return false;
    *out = sampling;
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_point(struct proto_writer *writer, const struct gd_mesh *mesh,
                         const struct gd_point *point, double snap, enum proto_geometry geometry)
{
    if (geometry == PROTO_GEOMETRY_XYZ)
        proto_xyz_encode(writer, gd_point_position(mesh, point));
    else
        proto_point_encode(writer, mesh, point, snap);
}

void proto_sampling_encode(struct proto_writer *writer, const struct gd_mesh *mesh,
                           const struct gd_point *points, const double *radii, uint32_t count,
                           double snap, const struct proto_options *options)
{
    proto_write_object_begin(writer);
    if (options->fields & PROTO_SAMPLING_FIELD_POINTS && options->geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < count; i++)
            encode_point(writer, mesh, &points[i], i ? NAN : snap, options->geometry);
        proto_write_array_end(writer);
    }
    if (options->fields & PROTO_SAMPLING_FIELD_RADII) {
        proto_write_key(writer, "radii");
        proto_write_numbers(writer, radii, count);
    }
    proto_write_object_end(writer);
}
