/* Geodesics of a subdivision surface from a place: on the discretization of a level, or on the
 * smooth surface; one after the other, by a worker. */
#include <math.h>

#include "proto/limit_trace.h"
#include "proto/member.h"
#include "server/query/handlers.h"
#include "server/api/surfaces/subdivisions.h"
#include "server/query/api.h"

#define BYTES_A_TRACE ((size_t)1 << 20) /* of a smooth one */
#define BUILD_SHARE   0.3               /* of the work, if there is no discretization yet */
#define WHAT          "the trace"

struct tracing {
    struct server_query query; /* first */
    struct proto_limit_trace wanted;
    struct gd_limit_jet jet;            /* at the start */
    struct server_discretization *fine; /* NULL: smooth */
    struct gd_point start;              /* on its mesh */
    uint32_t lanes;                     /* paths at once */
    struct gd_vec3 direction;           /* of the smooth one under way, */
    struct gd_limit_path path;          /* and where it leads */
    struct gd_detail detail;
};

static void release(struct server_query *query)
{
    struct tracing *tracing = (struct tracing *)query;
    server_discretization_release(tracing->fine);
    proto_limit_trace_free(&tracing->wanted);
}

static const struct gd_subdivision *surface_of(const struct tracing *tracing)
{
    return server_subdivision_of(tracing->query.surface)->surface;
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct tracing *tracing = (struct tracing *)query;
    return proto_limit_trace_decode(document, surface_of(tracing), &tracing->wanted, problem);
}

/* The monitor of some of the paths. */
static struct server_monitor monitor_of(const struct tracing *tracing, uint32_t first,
                                        uint32_t count)
{
    double share = (1 - BUILD_SHARE) / tracing->wanted.ways.count;
    return server_query_monitor(&tracing->query, BUILD_SHARE + first * share, count * share);
}

static enum gd_status evaluate(struct tracing *tracing, const struct gd_limit_point *place,
                               struct gd_limit_jet *out)
{
    return gd_limit_evaluate(surface_of(tracing), place, out, &tracing->detail);
}

/* --- on the mesh ------------------------------------------------------------------------------ */

/* While paths grow they are there twice. Several at once are faster: if there is room for them of
 * which nobody else is in need. */
static enum gd_status reserve(struct tracing *tracing)
{
    struct server_budget *budget = tracing->query.exchange->host->budget;
    size_t one = 2 * (size_t)tracing->wanted.ways.options.step_limit * sizeof(struct gd_point);
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, one)) return GD_BUDGET;
    bool is_room =
        server_budget_take_spare(budget, SERVER_BUDGET_FLIGHT, (GD_TRACE_LANES - 1) * one);
    tracing->lanes = is_room ? GD_TRACE_LANES : 1;
    tracing->query.held += tracing->lanes * one;
    return GD_OK;
}

static enum gd_status prepare_mesh(struct tracing *tracing)
{
    enum gd_status status = server_subdivision_discretization(
        &tracing->query, tracing->wanted.level, BUILD_SHARE, &tracing->fine, &tracing->detail);
    if (!status)
        status = gd_limit_mesh_point(tracing->fine->mesh, &tracing->wanted.start, &tracing->start,
                                     &tracing->detail);
    if (!status) tracing->wanted.ways.options.normals = gd_limit_mesh_normals(tracing->fine->mesh);
    return status ? status : reserve(tracing);
}

/* A direction that leads over the boundary ends where it starts. */
static enum gd_status stay(struct tracing *tracing, struct gd_vec3 direction,
                           const struct gd_control *control, struct gd_trace *out)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(tracing->fine->mesh);
    const struct gd_trace_options *options = &tracing->wanted.ways.options;
    struct gd_direction ahead;
    enum gd_status status =
        gd_direction_at_angle(mesh, &tracing->start, 0, &ahead, &tracing->detail);
    if (!status)
        status = gd_trace_follow(mesh, &tracing->start, &ahead, 0, options, control, out,
                                 &tracing->detail);
    if (status) return status;
    out->end = GD_TRACE_END_BOUNDARY;
    out->direction.xyz =
        gd_limit_direction(&tracing->jet, gd_limit_angle(&tracing->jet, direction));
    return GD_OK;
}

/* Some of the paths, all to be freed whether it fails or not. */
static enum gd_status follow(struct tracing *tracing, uint32_t first, uint32_t count,
                             const struct gd_control *control, struct gd_trace *out)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(tracing->fine->mesh);
    const struct proto_limit_trace *wanted = &tracing->wanted;
    struct gd_direction ahead[GD_TRACE_LANES];
    struct gd_trace followed[GD_TRACE_LANES];
    uint32_t path_of[GD_TRACE_LANES], going = 0;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count; i++) out[i] = (struct gd_trace){0};
    for (uint32_t i = 0; i < count && !status; i++) {
        struct gd_vec3 direction = proto_limit_trace_direction(wanted, &tracing->jet, first + i);
        status =
            gd_direction_along(mesh, &tracing->start, direction, &ahead[going], &tracing->detail);
        if (!status) path_of[going++] = i;
        if (status == GD_NOT_ON_SURFACE) status = stay(tracing, direction, control, &out[i]);
    }
    if (!status)
        status = gd_trace_follow_many(mesh, &tracing->start, ahead, going, wanted->length,
                                      &wanted->ways.options, control, followed, &tracing->detail);
    for (uint32_t k = 0; k < going && !status; k++) out[path_of[k]] = followed[k];
    return status;
}

static enum gd_status write_mesh_path(struct tracing *tracing, const struct gd_trace *trace)
{
    struct gd_limit_point place =
        gd_limit_mesh_place(tracing->fine->mesh, &trace->path.points[trace->path.count - 1]);
    struct gd_limit_jet end;
    enum gd_status status = evaluate(tracing, &place, &end);
    if (!status)
        proto_limit_trace_encode_mesh(&tracing->query.draft, tracing->fine->mesh, trace, &end,
                                      tracing->query.options.geometry);
    return status;
}

static enum gd_status write_mesh_paths(struct tracing *tracing, uint32_t first, uint32_t count)
{
    struct server_monitor monitor = monitor_of(tracing, first, count);
    const struct gd_control control = server_exchange_control(&monitor);
    struct gd_trace traces[GD_TRACE_LANES];
    enum gd_status status = follow(tracing, first, count, &control, traces);
    for (uint32_t i = 0; i < count; i++) {
        if (!status) status = write_mesh_path(tracing, &traces[i]);
        gd_trace_free(&traces[i]);
    }
    return status ? status : gd_control_check(&control, 1);
}

/* --- on the surface --------------------------------------------------------------------------- */

static size_t bytes_of(const struct gd_limit_path *path)
{
    return 2 * (size_t)path->step_count * sizeof *path->steps;
}

static enum gd_status trace_smooth(void *user, const struct gd_control *control, size_t *kept)
{
    struct tracing *tracing = user;
    enum gd_status status =
        gd_limit_trace(surface_of(tracing), &tracing->wanted.start, tracing->direction,
                       tracing->wanted.length, control, &tracing->path, &tracing->detail);
    if (!status) *kept = bytes_of(&tracing->path);
    return status;
}

static enum gd_status write_smooth_path(struct tracing *tracing, uint32_t i)
{
    struct server_monitor monitor = monitor_of(tracing, i, 1);
    tracing->direction = proto_limit_trace_direction(&tracing->wanted, &tracing->jet, i);
    enum gd_status status =
        server_query_call(&tracing->query, &monitor, trace_smooth, tracing, BYTES_A_TRACE);
    if (status) return status;
    struct gd_limit_path *path = &tracing->path;
    struct gd_limit_jet end;
    size_t held = bytes_of(path);
    status = evaluate(tracing, &path->steps[path->step_count - 1].place, &end);
    if (!status)
        proto_limit_trace_encode_smooth(&tracing->query.draft, path, &end,
                                        tracing->query.options.geometry);
    gd_limit_path_free(path);
    server_query_give(&tracing->query, held);
    return status;
}

/* --- the answer ------------------------------------------------------------------------------- */

static enum gd_status write_paths(struct tracing *tracing)
{
    struct proto_writer *writer = &tracing->query.draft;
    bool smooth = tracing->wanted.smooth;
    uint32_t total = tracing->wanted.ways.count;
    enum gd_status status = smooth ? GD_OK : prepare_mesh(tracing);
    proto_write_key(writer, "paths");
    proto_write_array_begin(writer);
    for (uint32_t i = 0, count; i < total && !status; i += count) {
        count = smooth ? 1 : total - i < tracing->lanes ? total - i : tracing->lanes;
        status = smooth ? write_smooth_path(tracing, i) : write_mesh_paths(tracing, i, count);
        if (!status) status = server_query_check_draft(&tracing->query);
    }
    proto_write_array_end(writer);
    return status;
}

static void write_head(struct tracing *tracing)
{
    struct proto_writer *writer = &tracing->query.draft;
    uint32_t fields = tracing->query.options.fields;
    if (fields & PROTO_LIMIT_TRACE_FIELD_START) {
        proto_write_key(writer, "start");
        proto_limit_place_encode(writer, &tracing->wanted.start, tracing->jet.position);
    }
    if (!tracing->wanted.smooth && fields & PROTO_LIMIT_TRACE_FIELD_LEVEL)
        proto_member_uint(writer, "level", tracing->wanted.level);
}

static enum server_query_turn refuse_start(struct proto_problem *problem)
{
    proto_problem_refuse(
        problem, "/start",
        "the surface has no tangent plane there, and so no directions: it is the tip of a spike (a "
        "corner inside of a smooth surface), or control points "
        "coincide; start beside it");
    return SERVER_QUERY_FAILED;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct tracing *tracing = (struct tracing *)query;
    struct proto_writer *writer = &tracing->query.draft;
    enum gd_status status = evaluate(tracing, &tracing->wanted.start, &tracing->jet);
    if (!status && isnan(tracing->jet.normal.x)) return refuse_start(problem);
    proto_write_object_begin(writer);
    if (!status) write_head(tracing);
    if (!status && query->options.fields & PROTO_LIMIT_TRACE_FIELD_PATHS)
        status = write_paths(tracing);
    proto_write_object_end(writer);
    if (status) return server_smooth_fail(query, status, &tracing->detail, WHAT, problem);
    return server_query_end_draft(query, GD_OK, WHAT, problem);
}

static const struct server_query_kind trace_kind = {.name = "trace",
                                                    .size = sizeof(struct tracing),
                                                    .fields = proto_limit_trace_fields,
                                                    .decode = decode,
                                                    .solve = solve,
                                                    .release = release};

void server_handle_subdivision_trace(struct server_exchange *exchange)
{
    server_query_handle(exchange, &trace_kind);
}
