/* Exp: where the straightest geodesics of vectors at a point lead, by a worker. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/trace.h"
#include "proto/vector.h"
#include "server/query/query.h"

#define WHAT "the trace"

struct exp_map {
    struct server_query query; /* first */
    struct proto_exp wanted;   /* its factors are used up in decoding */
    struct gd_point start;
    double snap; /* how far it was moved; NAN: not at all */
    struct gd_vector *
        /* of all vectors, by wanted.vectors.first; of those after a vector's first only the angle
           is known */
        segments;
    struct gd_point *ends;
};

static void release(struct server_query *query)
{
    struct exp_map *map = (struct exp_map *)query;
    proto_vectors_free(&map->wanted.vectors);
    free(map->segments);
    free(map->ends);
}

/* --- the question ----------------------------------------------------------------------------- */

static bool locate_vector(struct exp_map *map, uint32_t i, struct proto_problem *problem)
{
    const struct proto_vectors *vectors = &map->wanted.vectors;
    uint32_t first = vectors->first[i];
    if (first == vectors->first[i + 1]) return true;
    if (!proto_segment_locate(map->query.surface->mesh, &map->start, &vectors->segments[first],
                              &map->segments[first], problem))
        return false;
    for (uint32_t k = first + 1; k < vectors->first[i + 1]; k++) {
        const struct proto_segment *segment = &vectors->segments[k];
        if (!segment->direction.has_angle)
            return proto_problem_refuse(
                problem, segment->direction.place,
                "after the first one a segment takes an angle: where it begins is known only "
                "on the way");
        map->segments[k] = (struct gd_vector){{.angle = segment->direction.angle}, segment->length};
    }
    return true;
}

static bool locate_vectors(struct exp_map *map, struct proto_problem *problem)
{
    struct proto_vectors *vectors = &map->wanted.vectors;
    map->segments = malloc((vectors->first[vectors->count] + 1) * sizeof *map->segments);
    map->ends = malloc(vectors->count * sizeof *map->ends);
    if (!map->segments || !map->ends) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < vectors->count; i++)
        if (!locate_vector(map, i, problem)) return false;
    if (!vectors->factors) return true;
    map->segments[0] = gd_vector_combine(map->query.surface->mesh, &map->start, map->segments,
                                         vectors->factors, vectors->count);
    vectors->count = 1;
    return true;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct exp_map *map = (struct exp_map *)query;
    return proto_exp_decode(document, &map->wanted, problem) &&
           proto_point_locate(query->surface->mesh, &map->wanted.start, &map->start, &map->snap,
                              problem) &&
           locate_vectors(map, problem);
}

/* --- the answer ------------------------------------------------------------------------------- */

static bool fail(const struct exp_map *map, enum gd_status status, const struct gd_detail *detail,
                 struct proto_problem *problem)
{
    if (status == GD_NOT_ON_SURFACE || status == GD_INVALID_ARGUMENT) {
        proto_problem_from_status(problem, status, detail);
        return proto_problem_at(problem, "/vectors");
    }
    server_query_fail(&map->query, status, WHAT, problem);
    return false;
}

/* A vector without segments: log found no path, so there is nothing to trace. */
static bool exists(const struct exp_map *map, uint32_t i)
{
    return map->wanted.vectors.first[i] < map->wanted.vectors.first[i + 1];
}

static bool write_path(struct exp_map *map, uint32_t i, struct proto_problem *problem)
{
    if (!exists(map, i)) {
        if (map->query.options.fields & PROTO_EXP_FIELD_PATHS) proto_write_null(&map->query.draft);
        return true;
    }
    static const struct gd_trace_options options = {.step_limit = PROTO_TRACE_STEPS};
    const struct gd_mesh *mesh = map->query.surface->mesh;
    const struct proto_vectors *vectors = &map->wanted.vectors;
    uint32_t first = vectors->first[i], count = vectors->first[i + 1] - first;
    struct server_monitor part =
        server_query_monitor(&map->query, (double)i / vectors->count, 1.0 / vectors->count);
    const struct gd_control control = server_exchange_control(&part);
    struct gd_detail detail = {0};
    struct gd_trace trace;
    enum gd_status status = gd_vector_exp(mesh, &map->start, &map->segments[first], count, &options,
                                          &control, &trace, &detail);
    if (status) return fail(map, status, &detail, problem);
    map->ends[i] = trace.path.points[trace.path.count - 1];
    if (map->query.options.fields & PROTO_EXP_FIELD_PATHS)
        proto_trace_encode(&map->query.draft, mesh, &trace, map->query.options.geometry);
    gd_trace_free(&trace);
    status = server_query_check_draft(&map->query);
    if (!status) status = gd_control_check(&control, 1);
    return !status || fail(map, status, &detail, problem);
}

static bool write_paths(struct exp_map *map, struct proto_problem *problem)
{
    struct proto_writer *writer = &map->query.draft;
    bool is_wanted = map->query.options.fields & PROTO_EXP_FIELD_PATHS, ok = true;
    if (is_wanted) proto_write_key(writer, "paths");
    if (is_wanted) proto_write_array_begin(writer);
    for (uint32_t i = 0; i < map->wanted.vectors.count && ok; i++) ok = write_path(map, i, problem);
    if (is_wanted) proto_write_array_end(writer);
    return ok;
}

static void write_vectors(struct exp_map *map)
{
    struct proto_writer *writer = &map->query.draft;
    const struct proto_vectors *vectors = &map->wanted.vectors;
    proto_write_key(writer, "vectors");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < vectors->count; i++) {
        uint32_t first = vectors->first[i];
        double length = exists(map, i) ? 0 : INFINITY;
        for (uint32_t k = first; k < vectors->first[i + 1]; k++) length += map->segments[k].length;
        bool has_direction =
            exists(map, i) && (vectors->factors || vectors->segments[first].has_direction);
        proto_vector_encode(writer, has_direction ? &map->segments[first].direction : NULL, length);
    }
    proto_write_array_end(writer);
}

static void write_points(struct exp_map *map)
{
    struct proto_writer *writer = &map->query.draft;
    proto_write_key(writer, "points");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < map->wanted.vectors.count; i++) {
        if (exists(map, i))
            proto_point_encode(writer, map->query.surface->mesh, &map->ends[i], NAN);
        else
            proto_write_null(writer);
    }
    proto_write_array_end(writer);
}

static bool write_answer(struct exp_map *map, struct proto_problem *problem)
{
    struct proto_writer *writer = &map->query.draft;
    uint32_t fields = map->query.options.fields;
    proto_write_object_begin(writer);
    if (fields & PROTO_EXP_FIELD_START)
        proto_member_point(writer, "start", map->query.surface->mesh, &map->start, map->snap);
    if (fields & PROTO_EXP_FIELD_VECTORS) write_vectors(map);
    if (!write_paths(map, problem)) return false;
    if (fields & PROTO_EXP_FIELD_POINTS) write_points(map);
    proto_write_object_end(writer);
    return true;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct exp_map *map = (struct exp_map *)query;
    enum gd_status status =
        server_query_take(query, 2 * (size_t)PROTO_TRACE_STEPS * sizeof(struct gd_point));
    if (status) return server_query_fail(query, status, WHAT, problem);
    if (!write_answer(map, problem)) return SERVER_QUERY_FAILED;
    return server_query_end_draft(query, GD_OK, WHAT, problem);
}

static const struct server_query_kind exp_kind = {.name = "exp",
                                                  .size = sizeof(struct exp_map),
                                                  .fields = proto_exp_fields,
                                                  .decode = decode,
                                                  .solve = solve,
                                                  .release = release};

void server_handle_exp(struct server_exchange *exchange)
{
    server_query_handle(exchange, &exp_kind);
}
