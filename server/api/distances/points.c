/* Answers queries for points: the surface point nearest to a point, the weighted mean, and farthest
 * points. */
#include "server/query/handlers.h"

#include <math.h>

#include "gd/sampling.h"
#include "proto/queries/point_sets.h"
#include "server/query/query.h"

/* --- nearest ---------------------------------------------------------------------------------- */

/* Decoding locates the point in O(log n); nothing is left to solve. */

struct nearest_query {
    struct server_query query; /* must be the first member */
    struct gd_point point;
    double snap_distance;
};

static bool nearest_locate(struct server_query *query, const struct proto_point *point)
{
    struct nearest_query *nearest = (struct nearest_query *)query;
    return proto_point_locate(query->surface->mesh, point, &nearest->point, &nearest->snap_distance,
                              query->problem);
}

static bool nearest_decode(struct server_query *query, const json_t *document)
{
    struct proto_nearest_request wanted;
    return proto_nearest_request_decode(document, &wanted, query->problem) &&
           nearest_locate(query, &wanted.point);
}

static bool nearest_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct proto_point point;
    const char *text = proto_parameters_require(parameters, "point", query->problem);
    return text && proto_point_parse(text, "point", &point, query->problem) &&
           nearest_locate(query, &point);
}

static void nearest_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct nearest_query *nearest = (const struct nearest_query *)query;
    proto_point_encode_fields(writer, query->surface->mesh, &nearest->point, nearest->snap_distance,
                              query->options.fields);
}

const struct server_query_kind server_query_nearest = {.name = "nearest",
                                                       .size = sizeof(struct nearest_query),
                                                       .decode = nearest_decode,
                                                       .parse = nearest_parse,
                                                       .encode = nearest_encode};

/* --- mean ------------------------------------------------------------------------------------- */

struct mean_query {
    struct server_query query;  /* must be the first member */
    struct proto_reals weights; /* empty means equal weights */
    bool one_step;
    struct gd_mean mean;
};

static bool mean_decode(struct server_query *query, const json_t *document)
{
    struct mean_query *mean = (struct mean_query *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    struct proto_mean_request wanted;
    if (!proto_mean_request_decode(document, &wanted, query->problem)) return false;
    mean->weights = wanted.weights;
    mean->one_step = wanted.method == PROTO_METHOD_ONE_STEP;
    if (!server_query_locate(query, &wanted.points)) return false;
    const struct gd_point *points = query->points.points;
    for (uint32_t i = 1; i < query->points.count; i++)
        if (gd_point_component(mesh, &points[i]) != gd_point_component(mesh, &points[0]))
            return proto_problem_refuse(query->problem, "/points",
                                        "point %u lies on another component than point 0: there "
                                        "is no path between them",
                                        i);
    return true;
}

static enum server_query_turn mean_solve(struct server_query *query)
{
    struct mean_query *mean = (struct mean_query *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    const struct gd_mean_request request = {.points = query->points.points,
                                            .weights = mean->weights.items,
                                            .count = query->points.count,
                                            .one_step = mean->one_step,
                                            .landmarks = server_query_landmarks(query)};
    struct server_budgeted_call call =
        server_query_begin_call(query, NULL, server_field_build_grant(mesh));
    while (server_budgeted_call_next(&call))
        call.status = gd_mean_find(mesh, &request, &call.control, &mean->mean, NULL);
    return server_query_end_draft(query, call.status, "the mean");
}

static void mean_encode(const struct server_query *query, struct proto_writer *writer)
{
    proto_mean_encode(writer, query->surface->mesh, &((const struct mean_query *)query)->mean,
                      &query->options);
}

static void mean_release(struct server_query *query)
{
    proto_reals_free(&((struct mean_query *)query)->weights);
}

const struct server_query_kind server_query_mean = {.name = "mean",
                                                    .size = sizeof(struct mean_query),
                                                    .decode = mean_decode,
                                                    .solve = mean_solve,
                                                    .encode = mean_encode,
                                                    .release = mean_release};

/* --- farthest points -------------------------------------------------------------------------- */

struct sampling_query {
    struct server_query query; /* must be the first member */
    uint32_t count;
    bool has_start;
    struct gd_point start;
    /* distance by which the start was moved onto the surface; NAN means that it was not moved */
    double snap;
    struct gd_point *points;
    double *radii;
};

static bool sampling_decode(struct server_query *query, const json_t *document)
{
    struct sampling_query *sampling = (struct sampling_query *)query;
    struct proto_sampling_request wanted;
    if (!proto_sampling_request_decode(document, &wanted, query->problem)) return false;
    sampling->count = wanted.count;
    sampling->has_start = wanted.has_start;
    sampling->snap = NAN;
    return !wanted.has_start ||
           proto_point_locate(query->surface->mesh, &wanted.start, &sampling->start,
                              &sampling->snap, query->problem);
}

static enum server_query_turn sampling_solve(struct server_query *query)
{
    struct sampling_query *sampling = (struct sampling_query *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    const struct gd_point *start = sampling->has_start ? &sampling->start : NULL;
    sampling->points = server_query_allocate(query, sampling->count, sizeof *sampling->points);
    sampling->radii = server_query_allocate(query, sampling->count, sizeof *sampling->radii);
    if (!sampling->points || !sampling->radii)
        return server_query_end_draft(query, GD_BUDGET, "the sampling");
    struct server_budgeted_call call =
        server_query_begin_call(query, NULL, server_field_build_grant(mesh));
    while (server_budgeted_call_next(&call))
        call.status = gd_sampling_farthest(
            mesh, start, &call.control,
            &(struct gd_sampling){sampling->count, sampling->points, sampling->radii}, NULL);
    return server_query_end_draft(query, call.status, "the sampling");
}

static void sampling_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct sampling_query *sampling = (const struct sampling_query *)query;
    proto_sampling_encode(writer, query->surface->mesh, sampling->points, sampling->radii,
                          sampling->count, sampling->snap, &query->options);
}

static bool sampling_list_arrays(struct server_query *query)
{
    const struct sampling_query *sampling = (const struct sampling_query *)query;
    if (!server_query_list_line(query, sampling->points, sampling->count)) return false;
    server_arrays_add_numbers(&query->arrays, "radii", 0, sampling->count, sampling->radii);
    return true;
}

const struct server_query_kind server_query_farthest_points = {.name = "farthest-points",
                                                               .size =
                                                                   sizeof(struct sampling_query),
                                                               .decode = sampling_decode,
                                                               .solve = sampling_solve,
                                                               .encode = sampling_encode,
                                                               .list_arrays = sampling_list_arrays};
