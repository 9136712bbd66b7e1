/* Mean: the weighted mean of points of the surface, by a worker. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/mean.h"
#include "server/query/field_build.h"
#include "server/query/query.h"
#include "server/surfaces/landmarks.h"
#include "server/query/api.h"

#define WHAT "the mean"

struct mean {
    struct server_query query; /* first */
    struct proto_located_points points;
    double *weights; /* NULL: equal ones */
    bool one_step;
    struct gd_mean mean;
};

static void release(struct server_query *query)
{
    struct mean *mean = (struct mean *)query;
    proto_located_points_free(&mean->points);
    free(mean->weights);
}

/* Between points of different components there is nothing. */
static bool check_components(const struct proto_located_points *points,
                             struct proto_problem *problem)
{
    uint32_t component = gd_point_component(points->mesh, &points->points[0]);
    for (uint32_t i = 1; i < points->count; i++)
        if (gd_point_component(points->mesh, &points->points[i]) != component)
            return proto_problem_refuse(
                problem, "/points",
                "point %u lies on another component than point 0: there is no path between "
                "them",
                i);
    return true;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct mean *mean = (struct mean *)query;
    struct proto_mean wanted;
    if (!proto_mean_decode(document, &wanted, problem)) return false;
    mean->weights = wanted.weights;
    mean->one_step = wanted.one_step;
    bool ok = proto_points_locate(query->surface->mesh, &wanted.points, &mean->points, problem);
    proto_points_free(&wanted.points);
    return ok && check_components(&mean->points, problem);
}

struct finding {
    struct mean *mean;
    const struct gd_landmarks *landmarks;
};

static enum gd_status find(void *user, const struct gd_control *control, size_t *kept)
{
    const struct finding *finding = user;
    struct mean *mean = finding->mean;
    const struct gd_mean_request request = {.points = mean->points.points,
                                            .weights = mean->weights,
                                            .count = mean->points.count,
                                            .one_step = mean->one_step,
                                            .landmarks = finding->landmarks};
    *kept = 0;
    return gd_mean_find(mean->points.mesh, &request, control, &mean->mean, NULL);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct mean *mean = (struct mean *)query;
    struct server_landmark_set *set =
        server_landmarks_find(query->exchange->host->api->landmarks, query->surface);
    struct server_monitor part = server_query_monitor(query, 0, 1);
    struct finding finding = {mean, set ? set->landmarks : NULL};
    enum gd_status status = server_query_call(query, &part, find, &finding,
                                              server_field_build_grant(mean->points.mesh));
    server_landmark_set_release(set);
    return status ? server_query_fail(query, status, WHAT, problem) : SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct mean *mean = (const struct mean *)query;
    proto_mean_encode(writer, mean->points.mesh, &mean->mean, &query->options);
}

static const struct server_query_kind mean_kind = {.name = "mean",
                                                   .size = sizeof(struct mean),
                                                   .fields = proto_mean_fields,
                                                   .decode = decode,
                                                   .solve = solve,
                                                   .encode = encode,
                                                   .release = release};

void server_handle_mean(struct server_exchange *exchange)
{
    server_query_handle(exchange, &mean_kind);
}
