/* Curve: an operation on a curve, by a worker. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/curve_operation.h"
#include "server/query/field_build.h"
#include "server/query/curve_call.h"

#define CURVE_SHARE 0.5 /* of the work, to find the curve */

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

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct operating *operating = (struct operating *)query;
    return proto_curve_operation_decode(document, &operating->wanted, problem) &&
           proto_curve_locate(query->surface->mesh, &operating->wanted.curve, &operating->curve,
                              problem);
}

/* --- the operations --------------------------------------------------------------------------- */

static enum gd_status resample(struct operating *operating, const struct gd_curve *curve,
                               const struct gd_control *control, struct gd_detail *detail)
{
    struct proto_curve_result *result = &operating->result;
    struct gd_resampling resampling;
    enum gd_status status =
        gd_curve_resample(operating->query.surface->mesh, curve, operating->wanted.count, control,
                          &resampling, detail);
    if (status) return status;
    result->curve = resampling.curve;
    result->points = resampling.points;
    result->point_count = resampling.count;
    return GD_OK;
}

static enum gd_status shorten(struct operating *operating, const struct gd_curve *curve,
                              const struct gd_control *control, struct gd_detail *detail)
{
    struct proto_curve_result *result = &operating->result;
    struct gd_shortening shortening;
    if (operating->wanted.operation == PROTO_OPERATION_CLOSED_GEODESIC && !curve->closed)
        return gd_fail(detail, GD_INVALID_ARGUMENT,
                       "a closed geodesic comes from a closed curve; say \"closed\": true, or "
                       "\"shorten\" this one");
    enum gd_status status =
        gd_curve_shorten(operating->query.surface->mesh, curve, operating->wanted.rounds,
                         operating->wanted.pieces, control, &shortening, detail);
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
        status = gd_isoline_flatten(operating->query.surface->mesh, &isoline->lines[i],
                                    operating->wanted.tolerance, control, &result->paths[i]);
        if (status) break;
        result->is_closed[i] = isoline->lines[i].closed;
        result->path_count++;
    }
    return status;
}

static enum gd_status offset(struct operating *operating, const struct gd_curve *curve,
                             const struct gd_control *control, struct gd_detail *detail)
{
    struct gd_isoline isoline;
    enum gd_status status = gd_curve_offset(operating->query.surface->mesh, curve,
                                            operating->wanted.distance, control, &isoline, detail);
    if (status) return status;
    status = flatten(operating, &isoline, control);
    gd_isoline_free(&isoline);
    return status;
}

static enum gd_status operate(struct operating *operating, struct gd_curve *curve,
                              const struct gd_control *control, struct gd_detail *detail)
{
    struct proto_curve_result *result = &operating->result;
    switch (result->operation) {
    case PROTO_OPERATION_RESAMPLE:
        return resample(operating, curve, control, detail);
    case PROTO_OPERATION_SHORTEN:
    case PROTO_OPERATION_CLOSED_GEODESIC:
        return shorten(operating, curve, control, detail);
    case PROTO_OPERATION_OFFSET:
        return offset(operating, curve, control, detail);
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
    return points * sizeof(struct gd_point) +
           result->path_count * (sizeof *result->paths + sizeof *result->is_closed);
}

static enum gd_status make(struct server_query *query, struct gd_curve *curve,
                           const struct gd_control *control, struct gd_detail *detail, size_t *kept)
{
    struct operating *operating = (struct operating *)query;
    operating->result = (struct proto_curve_result){.operation = operating->wanted.operation};
    enum gd_status status = operate(operating, curve, control, detail);
    if (status)
        proto_curve_result_free(&operating->result);
    else
        *kept = bytes_of(&operating->result);
    return status;
}

/* --- the steps -------------------------------------------------------------------------------- */

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct operating *operating = (struct operating *)query;
    const struct server_curve_call call = {.curve = &operating->curve,
                                           .make = make,
                                           .grant = server_field_build_grant(query->surface->mesh),
                                           .share = CURVE_SHARE,
                                           .what = "the curve"};
    if (!server_curve_call_make(query, &call, problem)) return SERVER_QUERY_FAILED;
    return SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct operating *operating = (const struct operating *)query;
    proto_curve_result_encode(writer, query->surface->mesh, &operating->result, &query->options);
}

static const struct server_query_kind curve_kind = {.name = "curve",
                                                    .size = sizeof(struct operating),
                                                    .fields = proto_curve_operation_fields,
                                                    .decode = decode,
                                                    .solve = solve,
                                                    .encode = encode,
                                                    .release = release};

void server_handle_curve(struct server_exchange *exchange)
{
    server_query_handle(exchange, &curve_kind);
}
