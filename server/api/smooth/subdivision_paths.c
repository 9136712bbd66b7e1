/* Geodesics of a subdivision surface. Computes distance and shortest path between two points on the
 * discretization of a level. Computes traces from a point on a discretization or on the smooth
 * surface. All run on a worker. */
#include "server/query/result.h"
#include "server/api/smooth/smooth.h"

#include <math.h>
#include <stdlib.h>

#include "proto/queries/limit_paths.h"
#include "proto/json/writer.h"
#include "server/query/api.h"
#include "server/query/handlers.h"
#include "server/surfaces/kinds.h"

#define SEARCH_BYTES   ((size_t)4 << 20) /* a search, with the traces that straighten the path */
#define BYTES_PER_EDGE 224               /* as for a search on any mesh (query.c) */
#define TRACE_BYTES    ((size_t)1 << 20) /* bytes of one trace on the smooth surface */
/* bytes for each segment of a path, if the path must stop where it meets itself */
#define SEGMENT_BYTES 40
/* fraction of the progress for building a discretization */
#define BUILD_SHARE 0.3

static const struct gd_subdivision *subdivision_of(const struct server_query *query)
{
    return server_subdivision_of(query->surface)->surface;
}

/* Returns the mesh or the grid of a level, which the caller releases. A build counts as the first
 * BUILD_SHARE of the query's progress. */
static enum gd_status discretization_get(const struct server_query *query, uint32_t level,
                                         bool wants_grid, struct server_discretization **out,
                                         struct gd_detail *detail)
{
    struct server_subdivision *subdivision = server_subdivision_of(query->surface);
    struct server_monitor monitor = server_query_monitor(query, 0, BUILD_SHARE);
    const struct server_discretization_request request = {.slot = &subdivision->slot,
                                                          .surface = subdivision->surface,
                                                          .level = level,
                                                          .wants_grid = wants_grid,
                                                          .control =
                                                              server_exchange_control(&monitor),
                                                          .detail = detail};
    return server_discretizations_get(query->exchange->host->api->discretizations, &request, out);
}

/* --- distance, path --------------------------------------------------------------------------- */

struct pair {
    struct server_query query; /* must be the first member */
    struct proto_limit_pair wanted;
    struct server_discretization *discretization;
    struct gd_limit_shortest found;
    uint32_t first[2]; /* for an answer as arrays */
    struct gd_detail detail;
};

static void pair_release(struct server_query *query)
{
    struct pair *pair = (struct pair *)query;
    gd_limit_shortest_free(&pair->found);
    server_discretization_release(pair->discretization);
}

static bool pair_decode(struct server_query *query, const json_t *document)
{
    return proto_limit_pair_decode(document, subdivision_of(query), &((struct pair *)query)->wanted,
                                   query->problem);
}

static bool pair_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    static const struct server_smooth_ends ends = {server_smooth_place,
                                                   "a place: f:FACE:u,v, or f:FACE:CORNER:u,v"};
    return server_smooth_parse(query, parameters, &ends);
}

static enum gd_status pair_search(struct pair *pair)
{
    const struct gd_limit_mesh *mesh = pair->discretization->mesh;
    struct server_monitor monitor =
        server_query_monitor(&pair->query, BUILD_SHARE, 1 - BUILD_SHARE);
    size_t edges = gd_mesh_summary(gd_limit_mesh_mesh(mesh))->edges;
    struct server_budgeted_call call =
        server_query_begin_call(&pair->query, &monitor, SEARCH_BYTES + edges * BYTES_PER_EDGE);
    while (server_budgeted_call_next(&call)) {
        call.status = gd_limit_shortest_find(
            mesh, (struct gd_limit_point[]){pair->wanted.from, pair->wanted.to}, &call.control,
            &pair->found, &pair->detail);
        call.kept = 2 * (size_t)pair->found.step_count * sizeof *pair->found.steps;
    }
    return call.status;
}

static enum server_query_turn pair_solve(struct server_query *query)
{
    struct pair *pair = (struct pair *)query;
    const struct gd_limit_point places[2] = {pair->wanted.from, pair->wanted.to};
    struct gd_limit_jet jets[2];
    enum gd_status status =
        discretization_get(query, pair->wanted.level, false, &pair->discretization, &pair->detail);
    if (!status)
        status = gd_limit_evaluate_many(subdivision_of(query), &(struct gd_limit_places){places, 2},
                                        NULL, jets, &pair->detail);
    if (!status) status = pair_search(pair);
    if (status) return server_smooth_fail(query, status, &pair->detail, "the search");
    const struct gd_vec3 ends[2] = {jets[0].position, jets[1].position};
    proto_limit_pair_encode(&query->draft, &pair->wanted, ends, &pair->found, &query->options);
    return server_query_end_draft(query, GD_OK, "the answer");
}

/* Lists the arrays, without a line if there is no path. */
static bool path_list_arrays(struct server_query *query)
{
    struct pair *pair = (struct pair *)query;
    const struct gd_limit_step *steps = pair->found.steps;
    bool is_there = isfinite(pair->found.distance);
    pair->first[1] = is_there ? pair->found.step_count : 0;
    server_arrays_add(&query->arrays,
                      &(struct server_array){.name = "points",
                                             .type = SERVER_ARRAY_NUMBERS,
                                             .columns = 3,
                                             .rows = pair->first[1],
                                             .source = steps ? &steps->position : NULL,
                                             .stride = sizeof *steps});
    server_arrays_add_indices(&query->arrays, "first", 0, UINT64_C(1) + is_there, pair->first);
    server_arrays_add_numbers(&query->arrays, "distance", 0, 1, &pair->found.distance);
    return true;
}

#define PAIR_STEPS                                                                                 \
    .size = sizeof(struct pair), .decode = pair_decode, .parse = pair_parse, .solve = pair_solve,  \
    .release = pair_release

const struct server_query_kind server_query_subdivision_distance = {.name = "distance", PAIR_STEPS};

const struct server_query_kind server_query_subdivision_path = {
    .name = "path",
    .forms = server_result_smooth_line_forms,
    .write = server_result_write_listed,
    .list_arrays = path_list_arrays,
    PAIR_STEPS,
};

/* --- trace ------------------------------------------------------------------------------------ */

struct trace {
    struct server_query query; /* must be the first member */
    struct proto_limit_trace wanted;
    struct gd_trace_options options;
    struct gd_limit_jet jet; /* jet at the start */
    struct gd_detail detail;
    uint32_t current; /* index of the current direction */
    /* On the triangles of a level: */
    struct server_discretization *grid, *discretization; /* `discretization` is the mesh, or NULL */
    struct gd_point start;
    /* On the grid or on the smooth surface, for the current path: */
    struct gd_vec3 direction;
    struct gd_limit_path path;
    /* For an answer as arrays: */
    struct gd_vec3 *points; /* points of all paths */
    size_t room;            /* capacity of `points` */
    /* `kept` is the number of paths so far; `first` has count + 1 entries: the index where each
       path begins */
    uint32_t kept, *first;
    double *lengths;
};

static void trace_release(struct server_query *query)
{
    struct trace *trace = (struct trace *)query;
    server_discretization_release(trace->grid);
    server_discretization_release(trace->discretization);
    proto_limit_trace_request_free(&trace->wanted.request);
    free(trace->points);
}

/* Appends a path for an answer as arrays. Returns its points, which the caller fills in. Returns
 * NULL if memory is short; callers then report GD_BUDGET. */
static struct gd_vec3 *trace_keep(struct trace *trace, double length, uint32_t count)
{
    uint64_t begin = trace->first[trace->kept], end = begin + count;
    if (end > UINT32_MAX) return NULL;
    if (end > trace->room) {
        size_t room = 2 * end;
        if (server_query_take(&trace->query, (room - trace->room) * sizeof *trace->points))
            return NULL;
        struct gd_vec3 *points = realloc(trace->points, room * sizeof *points);
        if (!points) return NULL;
        trace->points = points;
        trace->room = room;
    }
    trace->lengths[trace->kept++] = length;
    trace->first[trace->kept] = (uint32_t)end;
    return trace->points + begin;
}

static enum gd_status trace_reserve(struct trace *trace)
{
    struct server_query *query = &trace->query;
    size_t count = trace->wanted.count;
    if (query->form == SERVER_FORM_JSON) return GD_OK;
    trace->first = server_query_allocate(query, count + 1, sizeof *trace->first);
    trace->lengths = server_query_allocate(query, count, sizeof *trace->lengths);
    return trace->first && trace->lengths ? GD_OK : GD_BUDGET;
}

static bool trace_list_arrays(struct server_query *query)
{
    const struct trace *trace = (const struct trace *)query;
    static const uint32_t none[1];
    uint32_t count = trace->kept;
    const uint32_t *first = trace->first ? trace->first : none;
    server_arrays_add_numbers(&query->arrays, "points", 3, first[count],
                              (const double *)trace->points);
    server_arrays_add_indices(&query->arrays, "first", 0, count + UINT64_C(1), first);
    server_arrays_add_numbers(&query->arrays, "length", 0, count, trace->lengths);
    return true;
}

static bool trace_decode(struct server_query *query, const json_t *document)
{
    struct trace *trace = (struct trace *)query;
    if (!proto_limit_trace_decode(document, subdivision_of(query), &trace->wanted, query->problem))
        return false;
    trace->options.step_limit = PROTO_TRACE_STEPS;
    trace->options.vertex_rule = trace->wanted.request.vertex_rule == PROTO_VERTEX_RULE_LIMIT_NORMAL
                                     ? GD_VERTEX_RULE_NORMAL
                                     : GD_VERTEX_RULE_BISECT;
    trace->options.stop_at_self_intersection = trace->wanted.request.stop_at_self_intersection;
    return true;
}

static struct server_monitor trace_monitor(const struct trace *trace, uint32_t i)
{
    double share = (1 - BUILD_SHARE) / trace->wanted.count;
    return server_query_monitor(&trace->query, BUILD_SHARE + i * share, share);
}

static enum gd_status trace_evaluate(struct trace *trace, const struct gd_limit_point *place,
                                     struct gd_limit_jet *out)
{
    return gd_limit_evaluate(subdivision_of(&trace->query), place, out, &trace->detail);
}

/* Returns the memory that a path needs. This is twice the path's size (because a growing path is
 * copied), plus the size of the tables of its earlier segments. */
static size_t mesh_path_bytes(const struct trace *trace)
{
    size_t steps = trace->options.step_limit, bytes = 2 * steps * sizeof(struct gd_point);
    if (!trace->options.stop_at_self_intersection) return bytes;
    const struct gd_mesh_summary *mesh =
        gd_mesh_summary(gd_limit_mesh_mesh(trace->discretization->mesh));
    return bytes + 2 * steps * SEGMENT_BYTES + mesh->faces * sizeof(uint32_t) + mesh->vertices;
}

static enum gd_status mesh_prepare(struct trace *trace)
{
    enum gd_status status = discretization_get(&trace->query, trace->wanted.level, false,
                                               &trace->discretization, &trace->detail);
    if (status) return status;
    const struct gd_limit_mesh *mesh = trace->discretization->mesh;
    status = gd_limit_mesh_point(mesh, &trace->wanted.start, &trace->start, &trace->detail);
    trace->options.normals = gd_limit_mesh_normals(mesh);
    return status ? status : server_query_take(&trace->query, mesh_path_bytes(trace));
}

/* Follows a path. A path in a direction that leads over the boundary ends at its start. */
static enum gd_status mesh_follow(struct trace *trace, uint32_t i, const struct gd_control *control,
                                  struct gd_trace *out)
{
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(trace->discretization->mesh);
    struct gd_vec3 direction = proto_limit_trace_direction(&trace->wanted, &trace->jet, i);
    struct gd_direction ahead;
    enum gd_status status =
        gd_direction_along(mesh, &trace->start, direction, &ahead, &trace->detail);
    bool stays = status == GD_NOT_ON_SURFACE;
    if (stays) status = gd_direction_at_angle(mesh, &trace->start, 0, &ahead, &trace->detail);
    if (!status)
        status = gd_trace_follow(
            mesh,
            &(struct gd_trace_request){.start = &trace->start,
                                       .ahead = &ahead,
                                       .length = stays ? 0 : trace->wanted.request.length,
                                       .options = &trace->options},
            control, out, &trace->detail);
    if (status || !stays) return status;
    out->end = GD_TRACE_END_BOUNDARY;
    out->direction.xyz = gd_limit_direction(&trace->jet, gd_limit_angle(&trace->jet, direction));
    return GD_OK;
}

static enum gd_status mesh_write_path(struct trace *trace, const struct gd_trace *followed)
{
    const struct gd_limit_mesh *mesh = trace->discretization->mesh;
    const struct gd_path *path = &followed->path;
    struct gd_limit_point place = gd_limit_mesh_place(mesh, &path->points[path->count - 1]);
    struct gd_limit_jet end;
    if (trace->first) {
        struct gd_vec3 *points = trace_keep(trace, path->length, path->count);
        for (uint32_t i = 0; points && i < path->count; i++)
            points[i] = gd_point_position(gd_limit_mesh_mesh(mesh), &path->points[i]);
        return points ? GD_OK : GD_BUDGET;
    }
    enum gd_status status = trace_evaluate(trace, &place, &end);
    if (!status)
        proto_limit_trace_encode_mesh(&trace->query.draft, mesh, followed, &end,
                                      trace->query.options.geometry);
    return status;
}

static enum gd_status mesh_write(struct trace *trace, uint32_t i)
{
    struct server_monitor monitor = trace_monitor(trace, i);
    const struct gd_control control = server_exchange_control(&monitor);
    struct gd_trace path;
    enum gd_status status = mesh_follow(trace, i, &control, &path);
    if (status) return status;
    status = mesh_write_path(trace, &path);
    gd_trace_free(&path);
    return status ? status : gd_control_check(&control, 1);
}

static enum gd_status limit_write_path(struct trace *trace)
{
    const struct gd_limit_path *path = &trace->path;
    struct gd_limit_jet end;
    if (trace->first) {
        struct gd_vec3 *points = trace_keep(trace, path->length, path->step_count);
        for (uint32_t i = 0; points && i < path->step_count; i++)
            points[i] = path->steps[i].position;
        return points ? GD_OK : GD_BUDGET;
    }
    enum gd_status status = trace_evaluate(trace, &path->steps[path->step_count - 1].place, &end);
    if (!status)
        proto_limit_trace_encode_smooth(&trace->query.draft, path, &end,
                                        trace->query.options.geometry);
    return status;
}

static enum gd_status limit_follow(struct trace *trace, const struct gd_control *control,
                                   bool *is_traced)
{
    const struct proto_limit_trace *wanted = &trace->wanted;
    *is_traced = true;
    if (!trace->grid)
        return gd_limit_trace(subdivision_of(&trace->query),
                              &(struct gd_limit_trace_request){wanted->start, trace->direction,
                                                               wanted->request.length},
                              control, &trace->path, &trace->detail);
    const struct gd_limit_grid_request request = {.start = wanted->start,
                                                  .direction = trace->direction,
                                                  .length = wanted->request.length,
                                                  .vertex_rule = trace->options.vertex_rule,
                                                  .step_limit = PROTO_TRACE_STEPS};
    enum gd_status status =
        gd_limit_grid_trace(trace->grid->grid, &request, control, &trace->path, &trace->detail);
    *is_traced = !status && trace->path.step_count > 0;
    return status;
}

/* Writes a path on the grid or on the smooth surface. */
static enum gd_status limit_write(struct trace *trace, uint32_t i, bool *is_traced)
{
    struct server_monitor monitor = trace_monitor(trace, i);
    struct gd_limit_path *path = &trace->path;
    size_t held = trace->query.held;
    trace->direction = proto_limit_trace_direction(&trace->wanted, &trace->jet, i);
    struct server_budgeted_call call =
        server_query_begin_call(&trace->query, &monitor, TRACE_BYTES);
    while (server_budgeted_call_next(&call)) {
        call.status = limit_follow(trace, &call.control, is_traced);
        call.kept = 2 * (size_t)path->step_count * sizeof *path->steps;
    }
    if (call.status || !*is_traced) return call.status;
    size_t bytes = trace->query.held - held;
    enum gd_status status = limit_write_path(trace);
    gd_limit_path_free(path);
    server_query_give(&trace->query, bytes);
    return status;
}

/* Writes a path on the grid or on the smooth surface. The few paths that a grid cannot trace are
 * traced on the mesh. */
static enum gd_status grid_write(struct trace *trace, uint32_t i)
{
    bool is_traced;
    enum gd_status status = limit_write(trace, i, &is_traced);
    if (status || is_traced) return status;
    if (!trace->discretization) status = mesh_prepare(trace);
    return status ? status : mesh_write(trace, i);
}

static enum gd_status trace_write_paths(struct trace *trace)
{
    struct proto_writer *writer = &trace->query.draft;
    bool needs_mesh = trace->options.stop_at_self_intersection;
    enum gd_status status = trace_reserve(trace);
    if (!status && needs_mesh) status = mesh_prepare(trace);
    if (!status && !needs_mesh && !trace->wanted.request.smooth)
        status = discretization_get(&trace->query, trace->wanted.level, true, &trace->grid,
                                    &trace->detail);
    proto_member_array(writer, "paths");
    for (uint32_t i = 0; i < trace->wanted.count && !status; i++) {
        trace->current = i;
        status = needs_mesh ? mesh_write(trace, i) : grid_write(trace, i);
        if (!status) status = server_query_pause(&trace->query, NULL, 0);
    }
    proto_write_array_end(writer);
    return status;
}

static enum server_query_turn trace_solve(struct server_query *query)
{
    struct trace *trace = (struct trace *)query;
    const struct proto_limit_trace *wanted = &trace->wanted;
    struct proto_writer *writer = &query->draft;
    uint32_t fields = query->options.fields;
    enum gd_status status = trace_evaluate(trace, &wanted->start, &trace->jet);
    if (!status && isnan(trace->jet.normal.x)) {
        proto_problem_refuse(
            query->problem, "/start",
            "the surface has no tangent plane there, and so no directions: it is the tip of a "
            "spike (a corner inside of a smooth surface), or control points "
            "coincide; start beside it");
        return SERVER_QUERY_FAILED;
    }
    proto_write_object_begin(writer);
    if (!status && fields & PROTO_LIMIT_TRACE_FIELD_START) {
        proto_write_key(writer, "start");
        proto_limit_place_encode(writer, &wanted->start, trace->jet.position);
    }
    if (!status && !wanted->request.smooth && fields & PROTO_LIMIT_TRACE_FIELD_LEVEL)
        proto_member_uint(writer, "level", wanted->level);
    if (!status && fields & PROTO_LIMIT_TRACE_FIELD_PATHS) status = trace_write_paths(trace);
    proto_write_object_end(writer);
    if (status) {
        server_smooth_fail(query, status, &trace->detail, "the trace");
        if (status == GD_INVALID_ARGUMENT && !wanted->request.has_fan)
            proto_problem_at(query->problem,
                             wanted->request.directions.items[trace->current].place);
        return SERVER_QUERY_FAILED;
    }
    return server_query_end_draft(query, GD_OK, "the trace");
}

const struct server_query_kind server_query_subdivision_trace = {
    .name = "trace",
    .size = sizeof(struct trace),
    .forms = server_result_smooth_line_forms,
    .write = server_result_write_listed,
    .decode = trace_decode,
    .solve = trace_solve,
    .list_arrays = trace_list_arrays,
    .release = trace_release,
};
