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
    struct gd_trace *traces;
    uint32_t trace_count;
};

static void release(struct server_query *query)
{
    struct tracing *tracing = (struct tracing *)query;
    for (uint32_t i = 0; i < tracing->trace_count; i++) gd_trace_free(&tracing->traces[i]);
    free(tracing->traces);
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
static size_t growth_bytes(const struct tracing *tracing)
{
    return 2 * (size_t)tracing->wanted.options.step_limit * sizeof(struct gd_point);
}

static enum gd_status trace_path(struct tracing *tracing)
{
    const struct proto_trace *wanted = &tracing->wanted;
    uint32_t i = tracing->trace_count;
    struct gd_trace *trace = &tracing->traces[i];
    struct server_monitor part =
        server_query_monitor(&tracing->query, (double)i / wanted->count, 1.0 / wanted->count);
    const struct gd_control control = server_exchange_control(&part);
    enum gd_status status =
        gd_trace_follow(tracing->query.surface->mesh, &tracing->start, &tracing->directions[i],
                        wanted->length, &wanted->options, &control, trace, NULL);
    if (status) return status;
    tracing->trace_count++;
    return server_query_take(&tracing->query, trace->path.count * sizeof *trace->path.points);
}

static enum gd_status trace_paths(struct tracing *tracing)
{
    uint32_t count = tracing->wanted.count;
    enum gd_status status = server_query_take(&tracing->query, growth_bytes(tracing));
    if (status) return status;
    tracing->traces = calloc(count, sizeof *tracing->traces);
    if (!tracing->traces) status = GD_NO_MEMORY;
    while (tracing->trace_count < count && !status) status = trace_path(tracing);
    server_query_give(&tracing->query, growth_bytes(tracing));
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    bool has_paths = query->options.fields & PROTO_TRACE_FIELD_PATHS;
    enum gd_status status = has_paths ? trace_paths((struct tracing *)query) : GD_OK;
    return status ? server_query_fail(query, status, WHAT, problem) : SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct tracing *tracing = (const struct tracing *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    proto_write_object_begin(writer);
    if (query->options.fields & PROTO_TRACE_FIELD_START)
        proto_member_point(writer, "start", mesh, &tracing->start, tracing->snap);
    if (query->options.fields & PROTO_TRACE_FIELD_PATHS) {
        proto_write_key(writer, "paths");
        proto_write_array_begin(writer);
        for (uint32_t i = 0; i < tracing->trace_count; i++)
            proto_trace_encode(writer, mesh, &tracing->traces[i], query->options.geometry);
        proto_write_array_end(writer);
    }
    proto_write_object_end(writer);
}

static const struct server_query_kind trace_kind = {.name = "trace",
                                                    .size = sizeof(struct tracing),
                                                    .fields = proto_trace_fields,
                                                    .decode = decode,
                                                    .solve = solve,
                                                    .encode = encode,
                                                    .release = release};

void server_handle_trace(struct server_exchange *exchange)
{
    server_query_handle(exchange, &trace_kind);
}
