/* Answers queries about tangent vectors and straightest geodesics: traces from a point, exp, log
 * and transport. */
#include "server/query/result.h"
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/queries/evaluation.h"
#include "proto/json/writer.h"
#include "proto/queries/trace.h"
#include "proto/values/vector.h"
#include "server/query/query.h"

/* --- vectors of a request --------------------------------------------------------------------- */

/* Returns true if the vector has no segments because log found no path. */
static bool vector_is_absent(const struct proto_vectors *vectors, uint32_t i)
{
    return !vectors->factors && vectors->first[i] == vectors->first[i + 1];
}

/* Replaces located vectors by their sum, weighted by the request's factors, if it has any. */
static void vectors_combine(const struct gd_mesh *mesh, const struct gd_point *point,
                            struct proto_vectors *vectors, struct gd_vector *located)
{
    if (!vectors->factors) return;
    located[0] = gd_vector_combine(mesh, point, located, vectors->factors, vectors->count);
    vectors->count = 1;
}

static bool vector_has_direction(const struct proto_vectors *vectors, uint32_t i)
{
    return !vector_is_absent(vectors, i) &&
           (vectors->factors || vectors->segments[vectors->first[i]].has_direction);
}

static void vector_encode(struct proto_writer *writer, const struct proto_vectors *vectors,
                          uint32_t i, const struct gd_vector *located, double length)
{
    proto_vector_encode(writer, vector_has_direction(vectors, i) ? &located->direction : NULL,
                        vector_is_absent(vectors, i) ? INFINITY : length);
}

/* The vectors of an answer as arrays. NAN stands for null. */
struct vector_arrays {
    double *angle, *length;
    struct gd_vec3 *direction;
};

static enum gd_status vector_arrays_reserve(struct server_query *query, uint32_t count,
                                            struct vector_arrays *out)
{
    double *numbers = server_query_allocate(query, count, 5 * sizeof *numbers);
    if (!numbers) return GD_BUDGET;
    out->angle = numbers;
    out->length = numbers + count;
    out->direction = (struct gd_vec3 *)(numbers + 2 * (size_t)count);
    return GD_OK;
}

/* Sets the vector `i`. If `direction` is NULL, the vector has no direction. */
static void vector_arrays_set(const struct vector_arrays *arrays, uint32_t i,
                              const struct gd_direction *direction, double length)
{
    const struct gd_direction none = {.angle = NAN, .xyz = {NAN, NAN, NAN}};
    const struct gd_direction *at = direction ? direction : &none;
    arrays->angle[i] = at->angle;
    arrays->length[i] = length;
    arrays->direction[i] = at->xyz;
}

static void vector_arrays_list(const struct vector_arrays *arrays, uint32_t count,
                               struct server_arrays *out)
{
    server_arrays_add_numbers(out, "direction", 3, count, (const double *)arrays->direction);
    server_arrays_add_numbers(out, "length", 0, count, arrays->length);
    server_arrays_add_numbers(out, "angle", 0, count, arrays->angle);
}

/* --- trace and exp: the question -------------------------------------------------------------- */

/* Straightest geodesics from a point: trace follows directions, exp follows vectors. */
struct trace_query {
    struct server_query query;         /* must be the first member */
    struct proto_trace_request wanted; /* only for trace */
    struct gd_trace_options options;
    struct proto_vectors vectors;
    struct gd_point start;
    double snap; /* distance by which the point was moved onto the surface; NAN: it was not moved */
    struct gd_direction *directions; /* only for trace */
    /* segments of exp, indexed by vectors.first; later segments of a vector have angles only */
    struct gd_vector *segments;
    bool has_paths;              /* whether the answer has paths */
    uint32_t count, trace_count; /* requested and finished traces */
    struct gd_trace *traces;     /* without paths, each trace has only its last point */
};

static bool directions_locate(struct trace_query *own)
{
    const struct gd_mesh *mesh = own->query.surface->mesh;
    const struct proto_direction *wanted = own->wanted.directions.items;
    own->count = wanted ? own->wanted.directions.count : own->wanted.fan;
    own->directions = server_query_allocate(&own->query, own->count, sizeof *own->directions);
    if (!own->directions) return proto_problem_from_status(own->query.problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < own->count; i++) {
        if (!wanted)
            own->directions[i] = gd_trace_fan(mesh, &own->start, own->count, i);
        else if (!proto_direction_locate(mesh, &own->start, &wanted[i], &own->directions[i],
                                         own->query.problem))
            return false;
    }
    return true;
}

static bool options_decode(struct trace_query *own, const json_t *document)
{
    struct proto_trace_request *wanted = &own->wanted;
    if (!proto_trace_request_decode(document, wanted, own->query.problem)) return false;
    own->options = (struct gd_trace_options){
        .vertex_rule = wanted->vertex_rule == PROTO_VERTEX_RULE_LIMIT_NORMAL
                           ? GD_VERTEX_RULE_NORMAL
                           : GD_VERTEX_RULE_BISECT,
        .boundary_rule = wanted->boundary_rule == PROTO_BOUNDARY_RULE_SLIDE ? GD_BOUNDARY_RULE_SLIDE
                                                                            : GD_BOUNDARY_RULE_STOP,
        .stop_at_self_intersection = wanted->stop_at_self_intersection,
        .step_limit = wanted->step_limit};
    return true;
}

static bool trace_decode(struct server_query *query, const json_t *document)
{
    struct trace_query *own = (struct trace_query *)query;
    own->has_paths = query->options.fields & PROTO_TRACE_FIELD_PATHS;
    return options_decode(own, document) &&
           proto_point_locate(query->surface->mesh, &own->wanted.start, &own->start, &own->snap,
                              query->problem) &&
           directions_locate(own);
}

static bool segments_locate(struct trace_query *own, uint32_t i)
{
    const struct proto_vectors *vectors = &own->vectors;
    uint32_t first = vectors->first[i], end = vectors->first[i + 1];
    if (first == end) return true;
    if (!proto_segment_locate(own->query.surface->mesh, &own->start, &vectors->segments[first],
                              &own->segments[first], own->query.problem))
        return false;
    for (uint32_t k = first + 1; k < end; k++) {
        const struct proto_segment *segment = &vectors->segments[k];
        if (!segment->direction.has_angle)
            return proto_problem_refuse(own->query.problem, segment->direction.place,
                                        "after the first segment write angles: where a later "
                                        "segment begins is not known in advance");
        own->segments[k] = (struct gd_vector){{.angle = segment->direction.angle}, segment->length};
    }
    return true;
}

static bool exp_decode(struct server_query *query, const json_t *document)
{
    struct proto_problem *problem = query->problem;
    struct trace_query *own = (struct trace_query *)query;
    struct proto_vectors *vectors = &own->vectors;
    struct proto_exp wanted = {0};
    bool ok = proto_exp_decode(document, &wanted, problem);
    *vectors = wanted.vectors;
    if (!ok ||
        !proto_point_locate(query->surface->mesh, &wanted.start, &own->start, &own->snap, problem))
        return false;
    own->has_paths = query->options.fields & PROTO_EXP_FIELD_PATHS;
    own->options.step_limit = PROTO_TRACE_STEPS;
    own->segments = server_query_allocate(query, vectors->first[vectors->count] + (size_t)1,
                                          sizeof *own->segments);
    if (!own->segments) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < vectors->count; i++)
        if (!segments_locate(own, i)) return false;
    vectors_combine(query->surface->mesh, &own->start, vectors, own->segments);
    own->count = vectors->count;
    return true;
}

/* --- trace and exp: the answer ---------------------------------------------------------------- */

static enum gd_status trace_follow(struct trace_query *own, uint32_t i,
                                   const struct gd_control *control, struct gd_detail *detail)
{
    struct server_query *query = &own->query;
    const struct gd_mesh *mesh = query->surface->mesh;
    const uint32_t *first = own->segments ? &own->vectors.first[i] : NULL;
    struct gd_trace *trace = &own->traces[i];
    if (first && vector_is_absent(&own->vectors, i)) return GD_OK;
    enum gd_status status =
        first ? gd_vector_exp(mesh,
                              &(struct gd_exp_request){.start = &own->start,
                                                       .segments = &own->segments[first[0]],
                                                       .count = first[1] - first[0],
                                                       .options = &own->options},
                              control, trace, detail)
              : gd_trace_follow(mesh,
                                &(struct gd_trace_request){.start = &own->start,
                                                           .ahead = &own->directions[i],
                                                           .length = own->wanted.length,
                                                           .options = &own->options},
                                control, trace, NULL);
    if (status) return status;
    own->trace_count = i + 1;
    if (!own->has_paths) {
        trace->path.points[0] = trace->path.points[trace->path.count - 1];
        trace->path.count = 1;
        struct gd_point *end = realloc(trace->path.points, sizeof *end);
        if (end) trace->path.points = end;
    }
    return server_query_take(query, trace->path.count * sizeof *trace->path.points);
}

static enum server_query_turn trace_fail(const struct server_query *query, enum gd_status status,
                                         const struct gd_detail *detail)
{
    if (!((const struct trace_query *)query)->segments ||
        (status != GD_NOT_ON_SURFACE && status != GD_INVALID_ARGUMENT))
        return server_query_fail(query, status, "the trace");
    proto_problem_from_status(query->problem, status, detail);
    proto_problem_at(query->problem, "/vectors");
    return SERVER_QUERY_FAILED;
}

/* Takes memory for two copies of a path, since arrays are copied as they grow. */
static enum server_query_turn trace_solve(struct server_query *query)
{
    struct trace_query *own = (struct trace_query *)query;
    size_t growing = 2 * (size_t)own->options.step_limit * sizeof(struct gd_point);
    struct gd_detail detail = {0};
    if (own->directions && !own->has_paths) return SERVER_QUERY_DONE;
    own->traces = server_query_allocate(query, own->count, sizeof *own->traces);
    enum gd_status status = own->traces ? server_query_take(query, growing) : GD_BUDGET;
    if (status) return server_query_fail(query, status, "the trace");
    for (uint32_t i = 0; i < own->count && !status; i++) {
        struct server_monitor part =
            server_query_monitor(query, (double)i / own->count, 1.0 / own->count);
        const struct gd_control control = server_exchange_control(&part);
        status = trace_follow(own, i, &control, &detail);
        if (!status) status = gd_control_check(&control, 1);
    }
    server_query_give(query, growing);
    return status ? trace_fail(query, status, &detail) : SERVER_QUERY_DONE;
}

static void paths_encode(const struct trace_query *own, struct proto_writer *writer)
{
    proto_member_array(writer, "paths");
    for (uint32_t i = 0; i < own->count; i++) {
        if (own->traces[i].path.count)
            proto_trace_encode(writer, own->query.surface->mesh, &own->traces[i],
                               own->query.options.geometry);
        else
            proto_write_null(writer);
    }
    proto_write_array_end(writer);
}

static void trace_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct trace_query *own = (const struct trace_query *)query;
    proto_write_object_begin(writer);
    if (query->options.fields & PROTO_TRACE_FIELD_START)
        proto_member_point(writer, "start", query->surface->mesh, &own->start, own->snap);
    if (own->has_paths) paths_encode(own, writer);
    proto_write_object_end(writer);
}

static void exp_encode_vectors(const struct trace_query *own, struct proto_writer *writer)
{
    const uint32_t *first = own->vectors.first;
    proto_member_array(writer, "vectors");
    for (uint32_t i = 0; i < own->count; i++) {
        double length = 0;
        for (uint32_t k = first[i]; k < first[i + 1]; k++) length += own->segments[k].length;
        vector_encode(writer, &own->vectors, i, &own->segments[first[i]], length);
    }
    proto_write_array_end(writer);
}

static void exp_encode_points(const struct trace_query *own, struct proto_writer *writer)
{
    proto_member_array(writer, "points");
    for (uint32_t i = 0; i < own->count; i++) {
        const struct gd_path *path = &own->traces[i].path;
        if (path->count)
            proto_point_encode(writer, own->query.surface->mesh, &path->points[path->count - 1],
                               NAN);
        else
            proto_write_null(writer);
    }
    proto_write_array_end(writer);
}

static void exp_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct trace_query *own = (const struct trace_query *)query;
    uint32_t fields = query->options.fields;
    proto_write_object_begin(writer);
    if (fields & PROTO_EXP_FIELD_START)
        proto_member_point(writer, "start", query->surface->mesh, &own->start, own->snap);
    if (fields & PROTO_EXP_FIELD_VECTORS) exp_encode_vectors(own, writer);
    if (own->has_paths) paths_encode(own, writer);
    if (fields & PROTO_EXP_FIELD_POINTS) exp_encode_points(own, writer);
    proto_write_object_end(writer);
}

/* Lists the arrays of the answer. A null vector has a line without points. Without paths, each line
 * consists of its last point. */
static bool traces_list_arrays(struct server_query *query)
{
    const struct trace_query *own = (const struct trace_query *)query;
    const struct gd_path *paths = own->traces ? &own->traces->path : NULL;
    uint32_t count = paths ? own->count : 0;
    if (!server_query_list_lines(query, paths, sizeof *own->traces, count)) return false;
    server_arrays_add_member(&query->arrays, "length", count, paths ? &paths->length : NULL,
                             sizeof *own->traces);
    return true;
}

static void trace_release(struct server_query *query)
{
    struct trace_query *own = (struct trace_query *)query;
    for (uint32_t i = 0; i < own->trace_count; i++) gd_trace_free(&own->traces[i]);
    proto_trace_request_free(&own->wanted);
    proto_vectors_free(&own->vectors);
}

const struct server_query_kind server_query_trace = {.name = "trace",
                                                     .size = sizeof(struct trace_query),
                                                     .forms = server_result_line_forms,
                                                     .write = server_result_write_listed,
                                                     .decode = trace_decode,
                                                     .solve = trace_solve,
                                                     .encode = trace_encode,
                                                     .list_arrays = traces_list_arrays,
                                                     .release = trace_release};

const struct server_query_kind server_query_exp = {.name = "exp",
                                                   .size = sizeof(struct trace_query),
                                                   .forms = server_result_line_forms,
                                                   .write = server_result_write_listed,
                                                   .decode = exp_decode,
                                                   .solve = trace_solve,
                                                   .encode = exp_encode,
                                                   .list_arrays = traces_list_arrays,
                                                   .release = trace_release};

/* --- log -------------------------------------------------------------------------------------- */

/* The vectors of the shortest paths from a point to others. For a few targets, one path after the
 * other is searched, unless the field of the point is cached. For many targets or all vertices, the
 * field is built. */

#define FEW     8    /* largest number of targets for which searches take less time than a field */
#define PORTION 1024 /* number of vectors written between two checks of the control */

struct log_query {
    struct server_query query; /* must be the first member */
    struct gd_seed from;
    struct proto_located_set set; /* `from` alone */
    double snap; /* distance by which the point was moved onto the surface; NAN: it was not moved */
    /* true if the targets are the query's points, false if they are all vertices */
    bool has_targets;
    bool first_vector_only;
    uint32_t count;              /* number of vectors of an answer as arrays */
    struct vector_arrays arrays; /* for an answer as arrays */
    uint32_t *is_cut;            /* for each target: 0 or 1 */
};

static bool log_decode(struct server_query *query, const json_t *document)
{
    struct log_query *own = (struct log_query *)query;
    struct proto_log wanted;
    if (!proto_log_decode(document, &wanted, query->problem)) return false;
    own->has_targets = wanted.to.count;
    if (own->has_targets && !server_query_locate(query, &wanted.to)) return false;
    own->first_vector_only = wanted.first_vector_only;
    own->set = (struct proto_located_set){.count = 1, .seed_count = 1, .seeds = &own->from};
    server_field_query_of_located(query, &own->set, 0);
    return proto_point_locate(query->surface->mesh, &wanted.from, &own->from.point, &own->snap,
                              query->problem);
}

/* Writes a vector, or stores it for an answer as arrays. */
static void log_put(struct log_query *own, uint32_t i, const struct gd_log *log, bool is_cut)
{
    if (!own->arrays.length) {
        proto_log_encode(&own->query.draft, log, is_cut);
        return;
    }
    vector_arrays_set(&own->arrays, i, log->count ? &log->vector.direction : NULL,
                      log->vector.length);
    own->is_cut[i] = is_cut;
}

/* Writes the vector of a pair's answer, and frees the answer. */
static enum gd_status log_write(struct log_query *own, uint32_t i, struct gd_pair_answer *answer)
{
    struct gd_log log = {.vector.length = answer->distance};
    if (isinf(answer->distance)) {
        log_put(own, i, &log, false);
        return GD_OK;
    }
    enum gd_status status = gd_vector_log(own->query.surface->mesh, &answer->path, &log, NULL);
    gd_pair_answer_free(answer);
    if (status) return status;
    if (own->first_vector_only && log.count) {
        log.vector = log.segments[0];
        log.count = 1;
    }
    log_put(own, i, &log, answer->is_cut);
    gd_log_free(&log);
    return GD_OK;
}

/* Writes the vectors of targets, from the field or, if `field` is NULL, from searches. */
static enum gd_status log_write_targets(struct log_query *own, const struct gd_field *field)
{
    struct server_query *query = &own->query;
    uint32_t count = query->points.count;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        struct server_monitor part = server_query_monitor(query, (double)i / count, 1.0 / count);
        const struct gd_control control = server_exchange_control(&part);
        const struct server_pair pair = {&own->from.point, &query->points.points[i],
                                         GD_PAIR_PATH_AND_CUT};
        struct gd_pair_answer answer;
        status = field ? gd_pair_from_field(field, pair.from, pair.to, pair.output, &answer)
                       : server_pair_solve(&part, query->surface, &pair, &answer);
        if (!status) status = log_write(own, i, &answer);
        if (!status) status = server_query_pause(query, &control, 1);
    }
    return status;
}

static enum gd_status log_write_vertices(struct log_query *own, const struct gd_field *field)
{
    struct server_query *query = &own->query;
    const struct gd_mesh *mesh = query->surface->mesh;
    uint32_t count = gd_mesh_summary(mesh)->index_count;
    struct server_monitor first = server_query_monitor(query, 0, 0.5),
                          second = server_query_monitor(query, 0.5, 0.5);
    const struct gd_control mapping = server_exchange_control(&first),
                            writing = server_exchange_control(&second);
    double *angles = server_query_allocate(query, 4 * (size_t)count, sizeof *angles),
           *lengths = angles + count;
    /* the second half stays unused: its bytes stand for the memory that the engine allocates */
    if (!angles) return GD_BUDGET;
    enum gd_status status = gd_vector_log_all(field, &mapping, angles, lengths, NULL);
    for (uint32_t i = 0; i < count && !status; i++) {
        struct gd_direction direction;
        bool has_direction =
            !isnan(angles[i]) &&
            !gd_direction_at_angle(mesh, &own->from.point, angles[i], &direction, NULL);
        if (own->arrays.length)
            vector_arrays_set(&own->arrays, i, has_direction ? &direction : NULL, lengths[i]);
        else if (isnan(lengths[i])) /* the vertex has no faces */
            proto_write_null(&query->draft);
        else
            proto_vector_encode(&query->draft, has_direction ? &direction : NULL, lengths[i]);
        if (i % PORTION == 0) status = server_query_pause(query, &writing, (double)i / count);
    }
    return status;
}

static enum gd_status log_reserve(struct log_query *own)
{
    struct server_query *query = &own->query;
    if (!server_query_arrays_form(query)) return GD_OK;
    own->count =
        own->has_targets ? query->points.count : gd_mesh_summary(query->surface->mesh)->index_count;
    own->is_cut = server_query_allocate(query, own->count, sizeof *own->is_cut);
    return own->is_cut ? vector_arrays_reserve(query, own->count, &own->arrays) : GD_BUDGET;
}

/* Writes the answer. `field` may be NULL if there are few targets. */
static enum server_query_turn log_answer(struct server_query *query, const struct gd_field *field)
{
    struct log_query *own = (struct log_query *)query;
    struct proto_writer *writer = &query->draft;
    enum gd_status status = GD_OK;
    proto_write_object_begin(writer);
    if (query->options.fields & PROTO_LOG_FIELD_FROM)
        proto_member_point(writer, "from", query->surface->mesh, &own->from.point, own->snap);
    if (query->options.fields & PROTO_LOG_FIELD_VECTORS) {
        proto_member_array(writer, "vectors");
        status = log_reserve(own);
        if (!status)
            status =
                own->has_targets ? log_write_targets(own, field) : log_write_vertices(own, field);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
    return server_query_end_draft(query, status, "the answer");
}

static bool log_needs_field(const struct server_query *query)
{
    const struct log_query *own = (const struct log_query *)query;
    bool is_short = !query->field.pin && own->has_targets && query->points.count <= FEW;
    return query->options.fields & PROTO_LOG_FIELD_VECTORS && !is_short;
}

static bool log_join(struct server_query *query)
{
    return log_needs_field(query) && server_field_query_join(query);
}

static enum server_query_turn log_solve(struct server_query *query)
{
    return log_needs_field(query) ? server_field_query_solve(query) : log_answer(query, NULL);
}

/* Lists the arrays. Only JSON answers have segments. */
static bool log_list_arrays(struct server_query *query)
{
    struct log_query *own = (struct log_query *)query;
    vector_arrays_list(&own->arrays, own->count, &query->arrays);
    if (own->has_targets)
        server_arrays_add_indices(&query->arrays, "cut_locus", 0, own->count, own->is_cut);
    return true;
}

const struct server_query_kind server_query_log = {.name = "log",
                                                   .size = sizeof(struct log_query),
                                                   .decode = log_decode,
                                                   .list_arrays = log_list_arrays,
                                                   .join = log_join,
                                                   .solve = log_solve,
                                                   .answer = log_answer};

/* --- transport -------------------------------------------------------------------------------- */

/* Moves vectors at a point to another point along the shortest path. */
struct transport_query {
    struct server_query query; /* must be the first member */
    struct proto_vectors wanted;
    /* at first, the vectors at the start of the path; after the transport, those at its end */
    struct gd_vector *vectors;
    double distance; /* INFINITY means no path */
};

static bool transport_locate(struct transport_query *own)
{
    struct proto_problem *problem = own->query.problem;
    const struct gd_mesh *mesh = own->query.surface->mesh;
    const struct gd_point *from = own->query.points.points;
    struct proto_vectors *wanted = &own->wanted;
    own->vectors = server_query_allocate(&own->query, wanted->count, sizeof *own->vectors);
    if (!own->vectors) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < wanted->count; i++) {
        uint32_t first = wanted->first[i], count = wanted->first[i + 1] - first;
        if (count > 1)
            return proto_problem_refuse(problem, "/vectors",
                                        "segments alone can't be moved; send the vector's "
                                        "direction and length as well");
        if (count &&
            !proto_segment_locate(mesh, from, &wanted->segments[first], &own->vectors[i], problem))
            return false;
    }
    vectors_combine(mesh, from, wanted, own->vectors);
    return true;
}

static bool transport_decode(struct server_query *query, const json_t *document)
{
    struct transport_query *own = (struct transport_query *)query;
    struct proto_transport wanted;
    if (!proto_transport_decode(document, &wanted, query->problem)) return false;
    own->wanted = wanted.vectors;
    return server_query_locate(query, &wanted.ends) && transport_locate(own);
}

static enum server_query_turn transport_solve(struct server_query *query)
{
    struct transport_query *own = (struct transport_query *)query;
    struct server_monitor whole = server_query_monitor(query, 0, 1);
    const struct server_pair pair = {&query->points.points[0], &query->points.points[1],
                                     GD_PAIR_PATH};
    struct gd_pair_answer answer;
    enum gd_status status = server_pair_solve(&whole, query->surface, &pair, &answer);
    if (status) return server_query_fail(query, status, "the search");
    own->distance = answer.distance;
    if (isfinite(answer.distance))
        status = gd_vector_transport(query->surface->mesh, &answer.path, own->vectors,
                                     own->wanted.count, NULL);
    gd_pair_answer_free(&answer);
    return server_query_end_draft(query, status, "the search");
}

static void transport_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct transport_query *own = (const struct transport_query *)query;
    const struct proto_located_points *ends = &query->points;
    uint32_t fields = query->options.fields;
    proto_write_object_begin(writer);
    if (fields & PROTO_TRANSPORT_FIELD_FROM)
        proto_member_point(writer, "from", ends->mesh, &ends->points[0], ends->snaps[0]);
    if (fields & PROTO_TRANSPORT_FIELD_TO)
        proto_member_point(writer, "to", ends->mesh, &ends->points[1], ends->snaps[1]);
    if (fields & PROTO_TRANSPORT_FIELD_DISTANCE)
        proto_member_number(writer, "distance", own->distance);
    if (fields) proto_reason_encode(writer, own->distance);
    if (fields & PROTO_TRANSPORT_FIELD_VECTORS && !isfinite(own->distance))
        proto_member_null(writer, "vectors");
    if (fields & PROTO_TRANSPORT_FIELD_VECTORS && isfinite(own->distance)) {
        proto_member_array(writer, "vectors");
        for (uint32_t i = 0; i < own->wanted.count; i++)
            vector_encode(writer, &own->wanted, i, &own->vectors[i], own->vectors[i].length);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}

static bool transport_list_arrays(struct server_query *query)
{
    struct transport_query *own = (struct transport_query *)query;
    struct vector_arrays arrays = {0};
    bool has_path = isfinite(own->distance),
         has_vectors = has_path && query->options.fields & PROTO_TRANSPORT_FIELD_VECTORS;
    uint32_t count = has_vectors ? own->wanted.count : 0;
    enum gd_status status = vector_arrays_reserve(query, count, &arrays);
    if (status) return proto_problem_from_status(query->problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < count; i++)
        vector_arrays_set(&arrays, i,
                          vector_has_direction(&own->wanted, i) ? &own->vectors[i].direction : NULL,
                          vector_is_absent(&own->wanted, i) ? NAN : own->vectors[i].length);
    vector_arrays_list(&arrays, count, &query->arrays);
    server_arrays_add_numbers(&query->arrays, "distance", 0, 1, &own->distance);
    return true;
}

static void transport_release(struct server_query *query)
{
    proto_vectors_free(&((struct transport_query *)query)->wanted);
}

const struct server_query_kind server_query_transport = {.name = "transport",
                                                         .size = sizeof(struct transport_query),
                                                         .decode = transport_decode,
                                                         .solve = transport_solve,
                                                         .encode = transport_encode,
                                                         .list_arrays = transport_list_arrays,
                                                         .release = transport_release};
