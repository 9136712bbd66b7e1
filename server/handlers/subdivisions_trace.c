/* Geodesics of a subdivision surface from a place: on the discretization of a level, or on the smooth surface; one after the other, by a worker. */
#include "proto/limit_trace.h"
#include "server/call.h"
#include "server/handlers/draft.h"
#include "server/handlers/handlers.h"
#include "server/handlers/subdivisions.h"
#include "server/server.h"

#define BYTES_A_TRACE ((size_t)1 << 20) /* of a smooth one */
#define BUILD_SHARE   0.3               /* of the work, if there is no discretization yet */
#define WHAT          "the trace"

struct tracing {
    struct server_query query; /* first */
    struct proto_limit_trace wanted;
    struct gd_limit_jet jet;            /* at the start */
    struct server_discretization *fine; /* NULL: smooth */
    struct gd_point start;              /* on its mesh */
    struct gd_vec3 direction;           /* of the smooth one under way, */
    struct gd_limit_path path;          /* and where it leads */
    struct gd_detail detail;
    struct server_draft draft;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT, for one path */
};

static void release(struct server_query *query)
{
    struct tracing *tracing = (struct tracing *)query;
    server_budget_give(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, tracing->held);
    server_draft_end(&tracing->draft);
    server_discretization_release(tracing->fine);
    proto_limit_trace_free(&tracing->wanted);
}

static const struct gd_subdivision *surface_of(const struct tracing *tracing)
{
    return server_subdivision_of(tracing->query.surface)->surface;
}

static bool decode(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    struct tracing *tracing = (struct tracing *)query;
    server_draft_begin(&tracing->draft, query);
    return proto_limit_trace_decode(document, surface_of(tracing), &tracing->wanted, problem);
}

/* The monitor of path `i`. */
static struct server_monitor monitor_of(const struct tracing *tracing, uint32_t i)
{
    double share = (1 - BUILD_SHARE) / tracing->wanted.ways.count;
    return server_query_monitor(&tracing->query, BUILD_SHARE + i * share, share);
}

static enum gd_status evaluate(struct tracing *tracing, const struct gd_limit_point *place, struct gd_limit_jet *out)
{
    return gd_limit_evaluate(surface_of(tracing), place, out, &tracing->detail);
}

/* --- on the mesh -------------------------------------------------------------------------------------------------- */

/* While a path grows it is there twice. */
static enum gd_status reserve(struct tracing *tracing)
{
    size_t bytes = 2 * (size_t)tracing->wanted.ways.options.step_limit * sizeof(struct gd_point);
    if (!server_budget_take(&tracing->query.exchange->server->budget, SERVER_BUDGET_FLIGHT, bytes)) return GD_BUDGET;
    tracing->held = bytes;
    return GD_OK;
}

static enum gd_status prepare_mesh(struct tracing *tracing)
{
    enum gd_status status = server_subdivision_discretization(&tracing->query, tracing->wanted.level, BUILD_SHARE,
                                                              &tracing->fine, &tracing->detail);
    if (!status)
        status = gd_limit_mesh_point(tracing->fine->mesh, &tracing->wanted.start, &tracing->start, &tracing->detail);
    if (!status) tracing->wanted.ways.options.normals = gd_limit_mesh_normals(tracing->fine->mesh);
    return status ? status : reserve(tracing);
}

/* A direction that leads over the boundary ends where it starts. */
static enum gd_status follow(struct tracing *tracing, struct gd_vec3 direction, const struct gd_control *control,
                             struct gd_trace *out)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(tracing->fine->mesh);
    const struct proto_limit_trace *wanted = &tracing->wanted;
    struct gd_direction ahead = {0};
    enum gd_status status = gd_direction_along(mesh, &tracing->start, direction, &ahead, &tracing->detail);
    if (status != GD_NOT_ON_SURFACE)
        return status ? status
                      : gd_trace_follow(mesh, &tracing->start, &ahead, wanted->length, &wanted->ways.options, control,
                                        out, &tracing->detail);
    if (gd_direction_at_angle(mesh, &tracing->start, 0, &ahead, NULL)) return GD_INTERNAL;
    status = gd_trace_follow(mesh, &tracing->start, &ahead, 0, &wanted->ways.options, control, out, &tracing->detail);
    if (status) return status;
    out->end = GD_TRACE_END_BOUNDARY;
    out->direction.xyz = gd_limit_direction(&tracing->jet, gd_limit_angle(&tracing->jet, direction));
    return GD_OK;
}

static enum gd_status write_mesh_path(struct tracing *tracing, uint32_t i)
{
    struct server_monitor monitor = monitor_of(tracing, i);
    const struct gd_control control = server_exchange_control(&monitor);
    struct gd_trace trace;
    struct gd_limit_jet end;
    enum gd_status status =
        follow(tracing, proto_limit_trace_direction(&tracing->wanted, &tracing->jet, i), &control, &trace);
    if (status) return status;
    struct gd_limit_point place = gd_limit_mesh_place(tracing->fine->mesh, &trace.path.points[trace.path.count - 1]);
    status = evaluate(tracing, &place, &end);
    if (!status)
        proto_limit_trace_encode_mesh(&tracing->draft.writer, tracing->fine->mesh, &trace, &end,
                                      tracing->query.options.geometry);
    gd_trace_free(&trace);
    return status ? status : gd_control_check(&control, 1);
}

/* --- on the surface ----------------------------------------------------------------------------------------------- */

static enum gd_status trace_smooth(void *user, const struct gd_control *control, size_t *kept)
{
    struct tracing *tracing = user;
    enum gd_status status = gd_limit_trace(surface_of(tracing), &tracing->wanted.start, tracing->direction,
                                           tracing->wanted.length, control, &tracing->path, &tracing->detail);
    if (!status) *kept = 2 * (size_t)tracing->path.step_count * sizeof *tracing->path.steps;
    return status;
}

static enum gd_status write_smooth_path(struct tracing *tracing, uint32_t i)
{
    struct server *server = tracing->query.exchange->server;
    struct server_monitor monitor = monitor_of(tracing, i);
    const struct server_call call = {
        .make = trace_smooth, .user = tracing, .control = server_exchange_control(&monitor), .grant = BYTES_A_TRACE};
    tracing->direction = proto_limit_trace_direction(&tracing->wanted, &tracing->jet, i);
    enum gd_status status = server_call_make(server, &call);
    if (status) return status;
    struct gd_limit_path *path = &tracing->path;
    struct gd_limit_jet end;
    size_t held = 2 * (size_t)path->step_count * sizeof *path->steps;
    status = evaluate(tracing, &path->steps[path->step_count - 1].place, &end);
    if (!status) proto_limit_trace_encode_smooth(&tracing->draft.writer, path, &end, tracing->query.options.geometry);
    gd_limit_path_free(path);
    server_budget_give(&server->budget, SERVER_BUDGET_FLIGHT, held);
    return status;
}

/* --- the answer --------------------------------------------------------------------------------------------------- */

static enum gd_status write_paths(struct tracing *tracing)
{
    struct proto_writer *writer = &tracing->draft.writer;
    bool smooth = tracing->wanted.smooth;
    enum gd_status status = smooth ? GD_OK : prepare_mesh(tracing);
    proto_write_key(writer, "paths");
    proto_write_array_begin(writer);
    for (uint32_t i = 0; i < tracing->wanted.ways.count && !status; i++) {
        status = smooth ? write_smooth_path(tracing, i) : write_mesh_path(tracing, i);
        if (!status) status = server_draft_hold(&tracing->draft);
    }
    proto_write_array_end(writer);
    return status;
}

static void write_head(struct tracing *tracing)
{
    struct proto_writer *writer = &tracing->draft.writer;
    uint32_t fields = tracing->query.options.fields;
    if (fields & PROTO_LIMIT_TRACE_FIELD_START) {
        proto_write_key(writer, "start");
        proto_limit_place_encode(writer, &tracing->wanted.start, tracing->jet.position);
    }
    if (!tracing->wanted.smooth && fields & PROTO_LIMIT_TRACE_FIELD_LEVEL) {
        proto_write_key(writer, "level");
        proto_write_uint(writer, tracing->wanted.level);
    }
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct tracing *tracing = (struct tracing *)query;
    struct proto_writer *writer = &tracing->draft.writer;
    enum gd_status status = evaluate(tracing, &tracing->wanted.start, &tracing->jet);
    proto_write_object_begin(writer);
    if (!status) write_head(tracing);
    if (!status && query->options.fields & PROTO_LIMIT_TRACE_FIELD_PATHS) status = write_paths(tracing);
    proto_write_object_end(writer);
    if (status) return server_subdivision_fail(query, status, &tracing->detail, WHAT, problem);
    return proto_writer_check(writer, problem) ? SERVER_QUERY_DONE : SERVER_QUERY_FAILED;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    server_draft_encode(&((const struct tracing *)query)->draft, writer);
}

static const struct server_query_kind trace_kind = {.name = "trace",
                                                    .size = sizeof(struct tracing),
                                                    .fields = proto_limit_trace_fields,
                                                    .decode = decode,
                                                    .solve = solve,
                                                    .encode = encode,
                                                    .release = release};

void server_handle_subdivision_trace(struct server_exchange *exchange)
{
    server_query_handle(exchange, &trace_kind);
}
