/* See evaluation.h. */
#include "server/query/evaluation.h"

#include <math.h>
#include <stdlib.h>

#include "server/http/reply.h"

#define QUICK_POINTS     64     /* as many as an HTTP thread may evaluate */
#define QUICK_PATHS      4      /* and as many as it may trace paths for, */
#define QUICK_PATH_FACES 200000 /* on meshes of no more faces than this */
#define DISTANCE_SHARE   0.2    /* of the work, when there is more to be done about each point */
#define WHAT             "the answer"

#define EACH (PROTO_RESULT_FIELD_NEAREST | PROTO_RESULT_FIELD_PATH | PROTO_RESULT_FIELD_GRADIENT)

/* --- distances -------------------------------------------------------------------------------- */

/* A partial field knows nothing of what is beyond; that there is no path to another component is
 * known without. */
static void tell_components(const struct server_evaluation *evaluation, const bool *has_seed,
                            double *distances)
{
    const struct gd_mesh *mesh = evaluation->points.mesh;
    double most = evaluation->field.request.radius;
    for (uint32_t i = 0; i < evaluation->points.count; i++) {
        if (distances[i] <= most) continue;
        distances[i] =
            has_seed[gd_point_component(mesh, &evaluation->points.points[i])] ? NAN : INFINITY;
    }
}

static enum gd_status limit_distances(const struct server_evaluation *evaluation, double *distances)
{
    const struct gd_mesh *mesh = evaluation->points.mesh;
    const struct gd_field_request *request = &evaluation->field.request;
    if (!(request->radius > 0)) return GD_OK;
    bool *has_seed = calloc(gd_mesh_summary(mesh)->components, sizeof *has_seed);
    if (!has_seed) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < request->seed_count; i++)
        has_seed[gd_point_component(mesh, &request->seeds[i].point)] = true;
    tell_components(evaluation, has_seed, distances);
    free(has_seed);
    return GD_OK;
}

/* --- one point -------------------------------------------------------------------------------- */

/* The shortest path goes back the way that the gradient goes on. At a member there is none: the
 * distance grows in all directions. */
static enum gd_status find_gradient(const struct server_evaluation *evaluation,
                                    const struct gd_field *field, const struct gd_point *point,
                                    struct proto_result *result)
{
    const struct gd_mesh *mesh = evaluation->points.mesh;
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

/* The nearest member, and the point of it: of a point's that is the point, of a segment's it is
 * where the path ends. *path: traced where it is needed. Of several that are as near, the path need
 * not end in the one that the field tells. */
static enum gd_status find_nearest(const struct server_evaluation *evaluation,
                                   const struct gd_field *field, const struct gd_point *point,
                                   struct proto_result *result, struct gd_path *path)
{
    const struct proto_located_set *set = evaluation->field.set;
    enum gd_status status = GD_OK;
    uint32_t seed = 0;
    double distance;
    bool traces = evaluation->wanted & PROTO_RESULT_FIELD_PATH;
    if (!traces && set->seed_count > 1) status = gd_field_nearest(field, point, &distance, &seed);
    if (status) return status;
    traces |= set->seeds[seed].is_segment;
    if (traces) status = gd_field_path_to_seed(field, point, path, &seed);
    if (status) return status;
    result->member = set->members[seed];
    result->nearest = traces ? path->points[path->count - 1] : set->seeds[seed].point;
    return GD_OK;
}

/* A result with what is wanted besides the distance; its path, if it has one, is `path`, to be
 * freed. */
static enum gd_status complete(const struct server_evaluation *evaluation,
                               const struct gd_field *field, const struct gd_point *point,
                               struct proto_result *result, struct gd_path *path)
{
    enum gd_status status = GD_OK;
    if (!isfinite(result->distance)) return GD_OK;
    if (evaluation->wanted & (PROTO_RESULT_FIELD_NEAREST | PROTO_RESULT_FIELD_PATH))
        status = find_nearest(evaluation, field, point, result, path);
    if (!status && evaluation->wanted & PROTO_RESULT_FIELD_GRADIENT)
        status = find_gradient(evaluation, field, point, result);
    if (evaluation->wanted & PROTO_RESULT_FIELD_PATH) result->path = path;
    return status;
}

static enum gd_status write_result(struct server_evaluation *evaluation,
                                   const struct gd_field *field, uint32_t i, double distance)
{
    struct gd_path path = {0};
    struct proto_result result = {.distance = distance};
    enum gd_status status =
        complete(evaluation, field, &evaluation->points.points[i], &result, &path);
    if (!status) {
        proto_result_encode(&evaluation->field.query.draft, evaluation->points.mesh,
                            evaluation->field.set, &result, evaluation->wanted,
                            evaluation->field.query.options.geometry);
        status = server_query_check_draft(&evaluation->field.query);
    }
    gd_path_free(&path);
    return status;
}

/* --- all of them ------------------------------------------------------------------------------ */

static enum gd_status write_results(struct server_evaluation *evaluation,
                                    const struct gd_field *field, const double *distances,
                                    struct server_monitor *part)
{
    const struct gd_control control = server_exchange_control(part);
    enum gd_status status = GD_OK;
    proto_results_begin(&evaluation->field.query.draft);
    for (uint32_t i = 0; i < evaluation->points.count && !status; i++) {
        status = write_result(evaluation, field, i, distances[i]);
        if (!status)
            status = gd_control_check(&control, (double)(i + 1) / evaluation->points.count);
    }
    proto_results_end(&evaluation->field.query.draft);
    return status;
}

static enum gd_status evaluate(struct server_evaluation *evaluation, const struct gd_field *field,
                               double *distances, const struct server_monitor *part)
{
    double share = evaluation->wanted & EACH ? DISTANCE_SHARE : 1 - DISTANCE_SHARE;
    struct server_monitor first = server_monitor_portion(part, 0, share),
                          second = server_monitor_portion(part, share, 1 - share);
    const struct gd_control control = server_exchange_control(&first);
    enum gd_status status = gd_field_distances(field, evaluation->points.points,
                                               evaluation->points.count, &control, distances);
    if (!status) status = limit_distances(evaluation, distances);
    if (!status) status = write_results(evaluation, field, distances, &second);
    return status;
}

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    struct server_evaluation *evaluation = (struct server_evaluation *)query;
    double *distances = malloc(evaluation->points.count * sizeof *distances);
    enum gd_status status = distances ? evaluate(evaluation, field, distances, part) : GD_NO_MEMORY;
    free(distances);
    return server_query_end_draft(&query->query, status, WHAT, problem);
}

/* --- the steps -------------------------------------------------------------------------------- */

static bool is_quick(const struct server_evaluation *evaluation)
{
    uint32_t count = evaluation->points.count;
    const struct proto_located_set *set = evaluation->field.set;
    bool traces = evaluation->wanted & PROTO_RESULT_FIELD_PATH || !set || set->has_segments;
    if (!traces) return count <= QUICK_POINTS;
    return count <= QUICK_PATHS &&
           gd_mesh_summary(evaluation->points.mesh)->faces <= QUICK_PATH_FACES;
}

bool server_evaluation_locate(struct server_evaluation *evaluation,
                              const struct proto_evaluation *wanted, struct proto_problem *problem)
{
    const struct server_query *query = &evaluation->field.query;
    if (!proto_points_locate(query->surface->mesh, &wanted->points, &evaluation->points, problem))
        return false;
    evaluation->wanted = proto_evaluation_wanted(wanted, &query->options);
    evaluation->field.is_quick = is_quick(evaluation);
    evaluation->field.answer = answer;
    return true;
}

void server_evaluation_release(struct server_query *query)
{
    struct server_evaluation *evaluation = (struct server_evaluation *)query;
    proto_located_points_free(&evaluation->points);
    server_field_query_release(query);
}
