/* Answers queries for the distances, nearest members, paths and gradients of points. The query
 * names a field or a set. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "proto/json/writer.h"
#include "proto/queries/evaluation.h"
#include "server/query/query.h"

/* The largest number of points that an HTTP thread may evaluate; and for paths, the largest numbers
 * of points and of faces. */
#define QUICK_POINTS     64
#define QUICK_PATHS      4
#define QUICK_PATH_FACES 200000
/* fraction of the progress for the distances, if the results have other values too */
#define DISTANCE_SHARE 0.2

struct evaluation {
    struct server_query query; /* must be the first member */
    uint32_t wanted;           /* fields of each result */
    double *distances;
    /* nearest members, for an answer as arrays, or UINT32_MAX if there is none */
    uint32_t *members;
    /* the nearest point, and the gradient; NAN means that there is none */
    struct gd_vec3 *nearest, *gradient;
    struct gd_path *paths; /* for an answer as arrays, if selected */
};

/* --- the question ----------------------------------------------------------------------------- */

static bool evaluation_is_quick(const struct evaluation *evaluation)
{
    const struct proto_located_set *set = evaluation->query.field.set;
    uint32_t count = evaluation->query.points.count;
    if (set && !set->has_segments && !(evaluation->wanted & PROTO_EVALUATION_FIELD_PATH))
        return count <= QUICK_POINTS;
    return count <= QUICK_PATHS &&
           gd_mesh_summary(evaluation->query.surface->mesh)->faces <= QUICK_PATH_FACES;
}

/* Locates the points of the request, then frees `points`. */
static bool evaluation_locate(struct server_query *query, struct proto_points *points,
                              uint32_t wanted)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    bool ok = server_query_locate(query, points);
    evaluation->wanted = wanted;
    query->field.is_quick = ok && evaluation_is_quick(evaluation);
    return ok;
}

static bool field_evaluation_decode(struct server_query *query, const json_t *document)
{
    struct proto_evaluation_request wanted;
    return server_field_query_of_resource(query) &&
           proto_evaluation_request_decode(document, &wanted, query->problem) &&
           evaluation_locate(
               query, &wanted.points,
               proto_evaluation_wanted(&query->options, wanted.path, wanted.gradient));
}

static bool set_evaluation_decode(struct server_query *query, const json_t *document)
{
    struct proto_set_distance_request wanted;
    if (!proto_set_distance_request_decode(document, &wanted, query->problem)) return false;
    if (server_field_query_of_set(query, &wanted.set, 0))
        return evaluation_locate(query, &wanted.points,
                                 proto_evaluation_wanted(&query->options, wanted.path, false));
    proto_points_free(&wanted.points);
    return false;
}

/* --- the answer ------------------------------------------------------------------------------- */

/* Sets distances beyond the field's radius to NAN, or to INFINITY on components without a seed. */
static enum gd_status distances_limit(struct evaluation *evaluation)
{
    const struct gd_mesh *mesh = evaluation->query.surface->mesh;
    const struct proto_located_points *points = &evaluation->query.points;
    const struct gd_field_request *request = &evaluation->query.field.request;
    if (!(request->radius > 0)) return GD_OK;
    bool *has_seed = calloc(gd_mesh_summary(mesh)->components, sizeof *has_seed);
    if (!has_seed) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < request->seed_count; i++)
        has_seed[gd_point_component(mesh, &request->seeds[i].point)] = true;
    for (uint32_t i = 0; i < points->count; i++) {
        uint32_t component = gd_point_component(mesh, &points->points[i]);
        if (!(evaluation->distances[i] <= request->radius))
            evaluation->distances[i] = has_seed[component] ? NAN : INFINITY;
    }
    free(has_seed);
    return GD_OK;
}

/* Computes the gradient. It has the direction in which the shortest path arrives at the point. At a
 * member of the set there is no gradient. */
static enum gd_status result_find_gradient(const struct gd_mesh *mesh, const struct gd_field *field,
                                           const struct gd_point *point,
                                           struct proto_result *result)
{
    struct gd_vec3 gradient;
    struct gd_direction back;
    enum gd_status status = gd_field_gradient(field, point, &gradient);
    if (status == GD_INVALID_ARGUMENT) return GD_OK;
    if (!status) status = gd_direction_along(mesh, point, gd_vec3_scale(gradient, -1), &back, NULL);
    if (status) return status;
    result->has_gradient = true;
    result->gradient = gd_direction_opposite(mesh, point, &back);
    return GD_OK;
}

/* Computes the nearest member and the member's nearest point. The nearest point is the point of
 * a point member, or the path's end on a segment. If several members are equally near, the path may
 * end in a member other than the result of gd_field_nearest. */
static enum gd_status result_find_nearest(const struct evaluation *evaluation,
                                          const struct gd_field *field,
                                          const struct gd_point *point, struct proto_result *result,
                                          struct gd_path *path)
{
    const struct proto_located_set *set = evaluation->query.field.set;
    enum gd_status status = GD_OK;
    uint32_t seed = 0;
    double distance;
    bool traces = evaluation->wanted & PROTO_EVALUATION_FIELD_PATH;
    if (!traces && set->seed_count > 1) status = gd_field_nearest(field, point, &distance, &seed);
    if (status) return status;
    traces |= set->seeds[seed].is_segment;
    if (traces) status = gd_field_path_to_seed(field, point, path, &seed);
    if (status) return status;
    result->member = set->members[seed];
    result->nearest = traces ? path->points[path->count - 1] : set->seeds[seed].point;
    if (evaluation->wanted & PROTO_EVALUATION_FIELD_PATH) result->path = path;
    return GD_OK;
}

/* Stores a result, with its path, for an answer as arrays. `path` is NULL if there is no
 * distance. */
static enum gd_status result_keep(struct evaluation *evaluation, uint32_t i,
                                  const struct proto_result *result, struct gd_path *path)
{
    struct server_query *query = &evaluation->query;
    const struct gd_vec3 none = {NAN, NAN, NAN};
    bool has_nearest = result && evaluation->wanted & PROTO_EVALUATION_FIELD_NEAREST;
    evaluation->members[i] = has_nearest ? result->member : UINT32_MAX;
    evaluation->nearest[i] =
        has_nearest ? gd_point_position(query->surface->mesh, &result->nearest) : none;
    evaluation->gradient[i] = result && result->has_gradient ? result->gradient.xyz : none;
    if (!evaluation->paths || !result || !result->path) return GD_OK;
    evaluation->paths[i] = *path;
    *path = (struct gd_path){0};
    return server_query_take(query, evaluation->paths[i].count * sizeof *path->points);
}

static enum gd_status result_write(struct evaluation *evaluation, const struct gd_field *field,
                                   uint32_t i)
{
    struct server_query *query = &evaluation->query;
    const struct gd_mesh *mesh = query->surface->mesh;
    const struct gd_point *point = &query->points.points[i];
    struct gd_path path = {0};
    struct proto_result result = {.distance = evaluation->distances[i]};
    enum gd_status status = GD_OK;
    uint32_t wanted = isfinite(result.distance) ? evaluation->wanted : 0;
    if (wanted & (PROTO_EVALUATION_FIELD_NEAREST | PROTO_EVALUATION_FIELD_PATH))
        status = result_find_nearest(evaluation, field, point, &result, &path);
    if (!status && wanted & PROTO_EVALUATION_FIELD_GRADIENT)
        status = result_find_gradient(mesh, field, point, &result);
    if (!status && server_query_arrays_form(query))
        status = result_keep(evaluation, i, wanted ? &result : NULL, &path);
    else if (!status)
        proto_result_encode(&query->draft, mesh, query->field.set, &result, evaluation->wanted,
                            query->options.geometry);
    gd_path_free(&path);
    return status;
}

static enum gd_status evaluation_write(struct evaluation *evaluation, const struct gd_field *field)
{
    const uint32_t each = PROTO_EVALUATION_FIELD_NEAREST | PROTO_EVALUATION_FIELD_PATH |
                          PROTO_EVALUATION_FIELD_GRADIENT;
    struct server_query *query = &evaluation->query;
    uint32_t count = query->points.count;
    double share = evaluation->wanted & each ? DISTANCE_SHARE : 1 - DISTANCE_SHARE;
    struct server_monitor first = server_query_monitor(query, 0, share),
                          second = server_query_monitor(query, share, 1 - share);
    const struct gd_control measuring = server_exchange_control(&first),
                            writing = server_exchange_control(&second);
    enum gd_status status =
        gd_field_distances(field, query->points.points, count, &measuring, evaluation->distances);
    if (!status) status = distances_limit(evaluation);
    proto_write_object_begin(&query->draft);
    proto_member_array(&query->draft, "results");
    for (uint32_t i = 0; i < count && !status; i++) {
        status = result_write(evaluation, field, i);
        if (!status) status = server_query_pause(query, &writing, (i + 1.0) / count);
    }
    proto_write_array_end(&query->draft);
    proto_write_object_end(&query->draft);
    return status;
}

static enum gd_status evaluation_reserve(struct evaluation *evaluation)
{
    struct server_query *query = &evaluation->query;
    uint32_t count = query->points.count;
    evaluation->distances = server_query_allocate(query, count, sizeof *evaluation->distances);
    if (!evaluation->distances) return GD_BUDGET;
    if (!server_query_arrays_form(query)) return GD_OK;
    evaluation->members = server_query_allocate(query, count, sizeof *evaluation->members);
    evaluation->nearest = server_query_allocate(query, count, 2 * sizeof *evaluation->nearest);
    if (!evaluation->members || !evaluation->nearest) return GD_BUDGET;
    evaluation->gradient = evaluation->nearest + count;
    if (!(evaluation->wanted & PROTO_EVALUATION_FIELD_PATH)) return GD_OK;
    evaluation->paths = server_query_allocate(query, count, sizeof *evaluation->paths);
    return evaluation->paths ? GD_OK : GD_BUDGET;
}

static enum server_query_turn evaluation_answer(struct server_query *query,
                                                const struct gd_field *field)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    enum gd_status status = evaluation_reserve(evaluation);
    if (!status) status = evaluation_write(evaluation, field);
    return server_query_end_draft(query, status, "the answer");
}

/* Lists the arrays of the answer. A result without a path has a line without points. */
static bool evaluation_list_arrays(struct server_query *query)
{
    const struct evaluation *evaluation = (const struct evaluation *)query;
    uint32_t count = query->points.count;
    server_arrays_add_numbers(&query->arrays, "distance", 0, count, evaluation->distances);
    if (evaluation->wanted & PROTO_EVALUATION_FIELD_NEAREST) {
        server_arrays_add_indices(&query->arrays, "member", 0, count, evaluation->members);
        server_arrays_add_numbers(&query->arrays, "nearest", 3, count, &evaluation->nearest->x);
    }
    if (evaluation->wanted & PROTO_EVALUATION_FIELD_GRADIENT)
        server_arrays_add_numbers(&query->arrays, "gradient", 3, count, &evaluation->gradient->x);
    return !evaluation->paths ||
           server_query_list_lines(query, evaluation->paths, sizeof *evaluation->paths, count);
}

static void evaluation_release(struct server_query *query)
{
    struct evaluation *evaluation = (struct evaluation *)query;
    for (uint32_t i = 0; evaluation->paths && i < query->points.count; i++)
        gd_path_free(&evaluation->paths[i]);
}

#define EVALUATION_STEPS                                                                           \
    .size = sizeof(struct evaluation), .list_arrays = evaluation_list_arrays,                      \
    .answer = evaluation_answer, .release = evaluation_release

const struct server_query_kind server_query_evaluate_field = {
    .name = "evaluate", .decode = field_evaluation_decode, EVALUATION_STEPS};

const struct server_query_kind server_query_distance_to_set = {
    .name = "distance-to-set", .decode = set_evaluation_decode, EVALUATION_STEPS};
