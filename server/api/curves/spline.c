/* Spline: a geodesic Hermite spline, built and sampled by a worker. */
#include "server/query/handlers.h"

#include "proto/spline.h"
#include "server/query/field_build.h"
#include "server/query/query.h"
#include "server/surfaces/landmarks.h"
#include "server/query/api.h"
#include "server/work/executor.h"

#define BUILD_SHARE 0.7 /* of the work */
#define WHAT        "the spline"

struct drawing {
    struct server_query query; /* first */
    struct proto_spline wanted;
    struct proto_located_spline located;
    struct gd_spline spline;
    struct gd_spline_line line;
};

static void release(struct server_query *query)
{
    struct drawing *drawing = (struct drawing *)query;
    gd_spline_free(&drawing->spline);
    gd_spline_line_free(&drawing->line);
    proto_located_spline_free(&drawing->located);
    proto_spline_free(&drawing->wanted);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct drawing *drawing = (struct drawing *)query;
    return proto_spline_decode(document, "", false, &drawing->wanted, problem) &&
           proto_spline_locate(query->surface->mesh, &drawing->wanted, &drawing->located, problem);
}

/* --- the curve -------------------------------------------------------------------------------- */

struct making {
    struct drawing *drawing;
    struct server_monitor part; /* the call's */
    struct gd_detail detail;
};

static size_t bytes_of(const struct gd_spline *spline, const struct gd_spline_line *line)
{
    size_t points = line->path.count;
    for (uint32_t i = 0; i < spline->count; i++)
        for (int k = 0; k < 3; k++) points += spline->segments[i].legs[k].count;
    return points * sizeof(struct gd_point) + line->count * sizeof *line->places +
           spline->count * (sizeof *spline->segments + sizeof *spline->knots);
}

static enum gd_status make(void *user, const struct gd_control *control, size_t *kept)
{
    struct making *making = user;
    struct drawing *drawing = making->drawing;
    const struct gd_mesh *mesh = drawing->query.surface->mesh;
    making->detail = (struct gd_detail){0};
    making->part = server_query_monitor(&drawing->query, 0, BUILD_SHARE);
    enum gd_status status = gd_spline_build(mesh, &drawing->located.request, control,
                                            &drawing->spline, &making->detail);
    if (status) return status;
    making->part = server_query_monitor(&drawing->query, BUILD_SHARE, 1 - BUILD_SHARE);
    status = gd_spline_sample(mesh, &drawing->spline, &drawing->located.sampling, control,
                              &drawing->line, &making->detail);
    if (status)
        gd_spline_free(&drawing->spline);
    else
        *kept = bytes_of(&drawing->spline, &drawing->line);
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct drawing *drawing = (struct drawing *)query;
    struct server_host *host = query->exchange->host;
    struct server_landmark_set *set = server_landmarks_find(host->api->landmarks, query->surface);
    struct making making = {.drawing = drawing,
                            .part = server_query_monitor(query, 0, BUILD_SHARE)};
    drawing->located.request.landmarks = set ? set->landmarks : NULL;
    drawing->located.request.executor =
        server_executor_start(host->workers, 2, query->exchange->job.deadline_ns);
    enum gd_status status = server_query_call(query, &making.part, make, &making,
                                              server_field_build_grant(query->surface->mesh));
    server_executor_stop(drawing->located.request.executor);
    server_landmark_set_release(set);
    if (status && status != GD_BUDGET && making.detail.text[0]) {
        server_query_count(query, status);
        proto_spline_fail("", status, &making.detail, problem);
        return SERVER_QUERY_FAILED;
    }
    if (status) return server_query_fail(query, status, WHAT, problem);
    return SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct drawing *drawing = (const struct drawing *)query;
    proto_spline_encode(writer, query->surface->mesh, &drawing->spline, &drawing->line,
                        drawing->wanted.frames, &query->options);
}

static const struct server_query_kind spline_kind = {.name = "spline",
                                                     .size = sizeof(struct drawing),
                                                     .fields = proto_spline_fields,
                                                     .decode = decode,
                                                     .solve = solve,
                                                     .encode = encode,
                                                     .release = release};

void server_handle_spline(struct server_exchange *exchange)
{
    server_query_handle(exchange, &spline_kind);
}
