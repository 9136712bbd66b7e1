/* Curve: an operation on a curve, by a worker. */
#include "server/handlers/handlers.h"

#include <stdlib.h>

#include "proto/curve_operation.h"
#include "server/field_build.h"
#include "server/handlers/query.h"
#include "server/landmarks.h"
#include "server/server.h"

#define CURVE_SHARE 0.5 /* of the work, to find the curve */
#define WHAT        "the curve"

struct operating {
    struct server_query query; /* first */
    struct proto_curve_operation wanted;
    struct proto_located_curve curve;
    struct proto_curve_result result;
};

static void release(struct server_query *query)
{
    struct operating *operating = (struct operating *)query;
    proto_curve_result_free(&operating->result);
    proto_located_curve_free(&operating->curve);
    proto_curve_operation_free(&operating->wanted);
}

static bool decode(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    struct operating *operating = (struct operating *)query;
    return proto_curve_operation_decode(document, &operating->wanted, problem) &&
           proto_curve_locate(query->surface->mesh, &operating->wanted.curve, &operating->curve, problem);
}

/* --- the operations ----------------------------------------------------------------------------------------------- */

struct work {
    struct operating *operating;
    const struct gd_landmarks *landmarks;
    struct server_monitor part; /* the call's */
    bool has_curve;             /* the curve is not what failed */
    struct gd_detail detail;
};

static enum gd_status resample(struct work *work, const struct gd_curve *curve, const struct gd_control *control)
{
    struct operating *operating = work->operating;
    struct proto_curve_result *result = &operating->result;
    struct gd_resampling resampling;
    enum gd_status status = gd_curve_resample(operating->query.surface->mesh, curve, operating->wanted.count, control,
                                              &resampling, &work->detail);
    if (status) return status;
    result->curve = resampling.curve;
    result->points = resampling.points;
    result->point_count = resampling.count;
    return GD_OK;
}

static enum gd_status shorten(struct work *work, const struct gd_curve *curve, const struct gd_control *control)
{
    struct operating *operating = work->operating;
    struct proto_curve_result *result = &operating->result;
    struct gd_shortening shortening;
    if (operating->wanted.operation == PROTO_OPERATION_CLOSED_GEODESIC && !curve->closed)
        return gd_fail(&work->detail, GD_INVALID_ARGUMENT,
                       "a closed geodesic comes from a closed curve; say \"closed\": true, or \"shorten\" this one");
    enum gd_status status = gd_curve_shorten(operating->query.surface->mesh, curve, operating->wanted.rounds,
                                             operating->wanted.pieces, control, &shortening, &work->detail);
    if (status) return status;
    result->curve = shortening.curve;
    result->turn = shortening.turn;
    result->rounds = shortening.rounds;
    result->is_geodesic = shortening.is_geodesic;
    return GD_OK;
}

static enum gd_status flatten(struct operating *operating, const struct gd_isoline *isoline,
                              const struct gd_control *control)
{
    struct proto_curve_result *result = &operating->result;
    enum gd_status status = GD_OK;
    result->paths = calloc(isoline->line_count + (size_t)1, sizeof *result->paths);
    result->is_closed = calloc(isoline->line_count + (size_t)1, sizeof *result->is_closed);
    if (!result->paths || !result->is_closed) return GD_NO_MEMORY;
    for (uint32_t i = 0; i < isoline->line_count && !status; i++) {
        status = gd_isoline_flatten(operating->query.surface->mesh, &isoline->lines[i], operating->wanted.tolerance,
                                    control, &result->paths[i]);
        if (status) break;
        result->is_closed[i] = isoline->lines[i].closed;
        result->path_count++;
    }
    return status;
}

static enum gd_status offset(struct work *work, const struct gd_curve *curve, const struct gd_control *control)
{
    struct operating *operating = work->operating;
    struct gd_isoline isoline;
    enum gd_status status = gd_curve_offset(operating->query.surface->mesh, curve, operating->wanted.distance, control,
                                            &isoline, &work->detail);
    if (status) return status;
    status = flatten(operating, &isoline, control);
    gd_isoline_free(&isoline);
    return status;
}

static enum gd_status operate(struct work *work, struct gd_curve *curve, const struct gd_control *control)
{
    struct proto_curve_result *result = &work->operating->result;
    switch (result->operation) {
    case PROTO_OPERATION_RESAMPLE:
        return resample(work, curve, control);
    case PROTO_OPERATION_SHORTEN:
    case PROTO_OPERATION_CLOSED_GEODESIC:
        return shorten(work, curve, control);
    case PROTO_OPERATION_OFFSET:
        return offset(work, curve, control);
    case PROTO_OPERATION_LENGTH:
        break;
    }
    result->curve = *curve;
    *curve = (struct gd_curve){0};
    return GD_OK;
}

static size_t bytes_of(const struct proto_curve_result *result)
{
    size_t points = (size_t)result->curve.count + result->point_count;
    for (uint32_t i = 0; i < result->path_count; i++) points += result->paths[i].count;
    return points * sizeof(struct gd_point) + result->path_count * (sizeof *result->paths + sizeof *result->is_closed);
}

static enum gd_status make(void *user, const struct gd_control *control, size_t *kept)
{
    struct work *work = user;
    struct operating *operating = work->operating;
    struct gd_curve curve;
    work->detail = (struct gd_detail){0};
    work->part = server_query_monitor(&operating->query, 0, CURVE_SHARE);
    enum gd_status status = proto_curve_resolve(operating->query.surface->mesh, &operating->curve, work->landmarks,
                                                control, &curve, &work->detail);
    work->has_curve = !status;
    if (status) return status;
    work->part = server_query_monitor(&operating->query, CURVE_SHARE, 1 - CURVE_SHARE);
    operating->result = (struct proto_curve_result){.operation = operating->wanted.operation};
    status = operate(work, &curve, control);
    gd_curve_free(&curve);
    if (status)
        proto_curve_result_free(&operating->result);
    else
        *kept = bytes_of(&operating->result);
    return status;
}

/* --- the steps ---------------------------------------------------------------------------------------------------- */

static enum server_query_turn fail(struct work *work, enum gd_status status, struct proto_problem *problem)
{
    struct server_query *query = &work->operating->query;
    if (status == GD_BUDGET || !work->detail.text[0]) return server_query_fail(query, status, WHAT, problem);
    server_query_count(query, status);
    if (work->has_curve)
        proto_problem_from_status(problem, status, &work->detail);
    else
        proto_curve_fail(&work->operating->curve, status, &work->detail, problem);
    return SERVER_QUERY_FAILED;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct operating *operating = (struct operating *)query;
    struct server_landmark_set *set = server_landmarks_find(query->exchange->server->landmarks, query->surface);
    struct work work = {.operating = operating,
                        .landmarks = set ? set->landmarks : NULL,
                        .part = server_query_monitor(query, 0, CURVE_SHARE)};
    enum gd_status status =
        server_query_call(query, &work.part, make, &work, server_field_build_grant(query->surface->mesh));
    server_landmark_set_release(set);
    if (status) return fail(&work, status, problem);
    proto_curve_result_encode(&operating->query.draft, query->surface->mesh, &operating->result, &query->options);
    return server_query_end_draft(query, GD_OK, "the answer", problem);
}

static const struct server_query_kind curve_kind = {.name = "curve",
                                                    .size = sizeof(struct operating),
                                                    .fields = proto_curve_operation_fields,
                                                    .decode = decode,
                                                    .solve = solve,
                                                    .release = release};

void server_handle_curve(struct server_exchange *exchange)
{
    server_query_handle(exchange, &curve_kind);
}
