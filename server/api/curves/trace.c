/* Trace: straightest geodesics from a point, one after the other, by a worker. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/trace.h"
#include "server/query/query.h"

#define WHAT "the trace"

struct tracing {
    struct server_query query; /* first */
    struct proto_trace wanted;
    struct gd_point start;
    double snap;                     /* how far it was moved; NAN: not at all */
    struct gd_direction *directions; /* as many as are wanted */
};

static void release(struct server_query *query)
{
    struct tracing *tracing = (struct tracing *)query;
    proto_trace_free(&tracing->wanted);
    free(tracing->directions);
}

/* --- the question ----------------------------------------------------------------------------- */

static bool locate_directions(struct tracing *tracing, struct proto_problem *problem)
{
    const struct gd_mesh *mesh = tracing->query.surface->mesh;
    const struct proto_trace *wanted = &tracing->wanted;
    tracing->directions = malloc(wanted->count * sizeof *tracing->directions);
    if (!tracing->directions) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < wanted->count; i++) {
        struct gd_direction *out = &tracing->directions[i];
        if (!wanted->directions)
            *out = gd_trace_fan(mesh, &tracing->start, wanted->count, i);
        else if (!proto_direction_locate(mesh, &tracing->start, &wanted->directions[i], out,
                                         problem))
            return false;
    }
    return true;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct tracing *tracing = (struct tracing *)query;
    return proto_trace_decode(document, &tracing->wanted, problem) &&
           proto_point_locate(query->surface->mesh, &tracing->wanted.start, &tracing->start,
                              &tracing->snap, problem) &&
           locate_directions(tracing, problem);
}

/* --- the answer ------------------------------------------------------------------------------- */

/* While a path grows it is there twice. */
static enum gd_status reserve(struct tracing *tracing)
{
    return server_query_take(&tracing->query, 2 * (size_t)tracing->wanted.options.step_limit *
                                                  sizeof(struct gd_point));
}

static enum gd_status write_path(struct tracing *tracing, uint32_t i)
{
    const struct proto_trace *wanted = &tracing->wanted;
    const struct gd_mesh *mesh = tracing->query.surface->mesh;
    struct server_monitor part =
        server_query_monitor(&tracing->query, (double)i / wanted->count, 1.0 / wanted->count);
    const struct gd_control control = server_exchange_control(&part);
    struct gd_trace trace;
    enum gd_status status =
        gd_trace_follow(mesh, &tracing->start, &tracing->directions[i], wanted->length,
                        &wanted->options, &control, &trace, NULL);
    if (status) return status;
    proto_trace_encode(&tracing->query.draft, mesh, &trace, tracing->query.options.geometry);
    gd_trace_free(&trace);
    status = server_query_check_draft(&tracing->query);
    return status ? status : gd_control_check(&control, 1);
}

static enum gd_status write_paths(struct tracing *tracing)
{
    struct proto_writer *writer = &tracing->query.draft;
    enum gd_status status = reserve(tracing);
    proto_write_key(writer, "paths");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < tracing->wanted.count && !status; i++) status = write_path(tracing, i);
    proto_write_array_end(writer);
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct tracing *tracing = (struct tracing *)query;
    struct proto_writer *writer = &tracing->query.draft;
    enum gd_status status = GD_OK;
    proto_write_object_begin(writer);
    if (query->options.fields & PROTO_TRACE_FIELD_START)
        proto_member_point(writer, "start", query->surface->mesh, &tracing->start, tracing->snap);
    if (query->options.fields & PROTO_TRACE_FIELD_PATHS) status = write_paths(tracing);
    proto_write_object_end(writer);
    return server_query_end_draft(query, status, WHAT, problem);
}

static const struct server_query_kind trace_kind = {.name = "trace",
                                                    .size = sizeof(struct tracing),
                                                    .fields = proto_trace_fields,
                                                    .decode = decode,
                                                    .solve = solve,
                                                    .release = release};

void server_handle_trace(struct server_exchange *exchange)
{
    server_query_handle(exchange, &trace_kind);
}
