#include "proto/queries/limit_paths.h"

#include <math.h>

#include "proto/json/writer.h"

/* --- the request ------------------------------------------------------------------------------ */

bool proto_limit_level_decode(const json_t *document, const struct gd_subdivision *surface,
                              uint32_t *out, struct proto_problem *problem)
{
    uint32_t least = gd_limit_mesh_least_level(surface);
    double level = gd_limit_mesh_usual_level(surface);
    if (json_object_get(document, "level") &&
        !proto_decode_number(document, "", "level", &level, problem))
        return false;
    if (!(level >= least && level <= GD_LIMIT_LEVEL_MOST && level == floor(level)))
        return proto_problem_refuse(problem, "/level", "the level is a whole number from %u to %d",
                                    least, GD_LIMIT_LEVEL_MOST);
    *out = (uint32_t)level;
    return true;
}

bool proto_limit_level_request(const json_t *document, const struct gd_subdivision *surface,
                               struct proto_limit_level *out, struct proto_problem *problem)
{
    struct proto_level_request request;
    struct proto_limit_level wanted;
    if (!proto_level_request_decode(document, &request, problem) ||
        !proto_limit_level_decode(document, surface, &wanted.level, problem))
        return false;
    wanted.for_traces = request.use != PROTO_USE_PATHS;
    wanted.for_paths = request.use != PROTO_USE_TRACES;
    *out = wanted;
    return true;
}

bool proto_limit_trace_decode(const json_t *document, const struct gd_subdivision *surface,
                              struct proto_limit_trace *out, struct proto_problem *problem)
{
    struct proto_limit_trace trace = {0};
    struct proto_limit_trace_request *request = &trace.request;
    if (!proto_limit_trace_request_decode(document, request, problem)) return false;
    if (request->smooth && request->stop_at_self_intersection) {
        proto_limit_trace_request_free(request);
        return proto_problem_refuse(problem, "/stop_at_self_intersection",
                                    "smooth traces do not stop where they cross themselves; leave "
                                    "smooth or stop_at_self_intersection out");
    }
    trace.count = request->has_fan ? request->fan : request->directions.count;
    if (proto_limit_place_locate(surface, &request->start, "/start", &trace.start, problem) &&
        proto_limit_level_decode(document, surface, &trace.level, problem)) {
        *out = trace;
        return true;
    }
    proto_limit_trace_request_free(request);
    return false;
}

struct gd_vec3 proto_limit_trace_direction(const struct proto_limit_trace *trace,
                                           const struct gd_limit_jet *start, uint32_t i)
{
    const struct proto_direction *direction =
        trace->request.has_fan ? NULL : &trace->request.directions.items[i];
    if (!direction) return gd_limit_direction(start, 2 * M_PI * i / trace->count);
    return direction->has_angle ? gd_limit_direction(start, direction->angle) : direction->xyz;
}

/* --- the answer ------------------------------------------------------------------------------- */

static void encode_end(struct proto_writer *writer, const struct gd_limit_jet *end,
                       struct gd_vec3 direction, const char *reason)
{
    const struct gd_direction told = {.angle = gd_limit_angle(end, direction), .xyz = direction};
    proto_write_key(writer, "end_direction");
    proto_direction_encode(writer, &told);
    proto_member_string(writer, "end_reason", reason);
    proto_write_object_end(writer);
}

static void begin_path(struct proto_writer *writer, double length)
{
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", length);
}

static void encode_point(struct proto_writer *writer, const struct gd_limit_mesh *fine,
                         const struct gd_point *point, enum proto_geometry geometry)
{
    struct gd_vec3 xyz = gd_point_position(gd_limit_mesh_mesh(fine), point);
    if (geometry == PROTO_GEOMETRY_XYZ) {
        proto_xyz_encode(writer, xyz);
        return;
    }
    struct gd_limit_point place = gd_limit_mesh_place(fine, point);
    proto_limit_place_encode(writer, &place, xyz);
}

void proto_limit_trace_encode_mesh(struct proto_writer *writer, const struct gd_limit_mesh *fine,
                                   const struct gd_trace *trace, const struct gd_limit_jet *end,
                                   enum proto_geometry geometry)
{
    begin_path(writer, trace->path.length);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_member_array(writer, "points");
        for (uint32_t i = 0; i < trace->path.count; i++)
            encode_point(writer, fine, &trace->path.points[i], geometry);
        proto_write_array_end(writer);
    }
    encode_end(writer, end, trace->direction.xyz, proto_trace_end_name(trace->end));
}

/* Writes an array of steps, or of their positions only. */
static void encode_steps(struct proto_writer *writer, const struct gd_limit_step *steps,
                         uint32_t count, enum proto_geometry geometry)
{
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < count; i++) {
        if (geometry == PROTO_GEOMETRY_XYZ)
            proto_xyz_encode(writer, steps[i].position);
        else
            proto_limit_place_encode(writer, &steps[i].place, steps[i].position);
    }
    proto_write_array_end(writer);
}

void proto_limit_trace_encode_smooth(struct proto_writer *writer, const struct gd_limit_path *path,
                                     const struct gd_limit_jet *end, enum proto_geometry geometry)
{
    static const char *const reasons[] = {[GD_LIMIT_END_LENGTH] = "length",
                                          [GD_LIMIT_END_BOUNDARY] = "boundary",
                                          [GD_LIMIT_END_SINGULAR] = "singular",
                                          [GD_LIMIT_END_STEPS] = "step_limit"};
    begin_path(writer, path->length);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        encode_steps(writer, path->steps, path->step_count, geometry);
    }
    encode_end(writer, end, path->direction, reasons[path->end]);
}

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

static void encode_distance(struct proto_writer *writer, const struct gd_limit_shortest *found,
                            const struct proto_options *options)
{
    proto_field_number(writer, options, PROTO_LIMIT_PATH_FIELD_DISTANCE, found->distance);
    if (!isfinite(found->distance)) {
        if (options->fields & (PROTO_LIMIT_PATH_FIELD_DISTANCE | PROTO_LIMIT_PATH_FIELD_REASON))
            proto_member_string(writer, "reason", "no_path");
        return;
    }
    proto_field_number(writer, options, PROTO_LIMIT_PATH_FIELD_ERROR_ESTIMATE,
                       found->error_estimate);
    proto_field_bool(writer, options, PROTO_LIMIT_PATH_FIELD_RELAXED, found->relaxed);
    proto_field_number(writer, options, PROTO_LIMIT_PATH_FIELD_MESH_DISTANCE, found->mesh_distance);
}

static void encode_path(struct proto_writer *writer, const struct gd_limit_shortest *found,
                        enum proto_geometry geometry)
{
    if (!isfinite(found->distance)) {
        proto_write_null(writer);
        return;
    }
    proto_write_object_begin(writer);
    proto_member_number(writer, "length", found->distance);
    if (geometry != PROTO_GEOMETRY_NONE) {
        proto_write_key(writer, "points");
        encode_steps(writer, found->steps, found->step_count, geometry);
    }
    proto_write_object_end(writer);
}

void proto_limit_pair_encode(struct proto_writer *writer, const struct proto_limit_pair *wanted,
                             const struct gd_vec3 ends[2], const struct gd_limit_shortest *found,
                             const struct proto_options *options)
{
    proto_write_object_begin(writer);
    encode_distance(writer, found, options);
    proto_field_uint(writer, options, PROTO_LIMIT_PATH_FIELD_LEVEL, wanted->level);
    if (proto_field(writer, options, PROTO_LIMIT_PATH_FIELD_FROM))
        proto_limit_place_encode(writer, &wanted->from, ends[0]);
    if (proto_field(writer, options, PROTO_LIMIT_PATH_FIELD_TO))
        proto_limit_place_encode(writer, &wanted->to, ends[1]);
    if (proto_field(writer, options, PROTO_LIMIT_PATH_FIELD_PATH))
        encode_path(writer, found, options->geometry);
    proto_write_object_end(writer);
}
