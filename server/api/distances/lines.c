/* Answers queries for the isolines of a field at some levels. A worker traces the lines, and writes
 * them one by one. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/json/writer.h"
#include "proto/queries/isoline.h"
#include "proto/values/path.h"
#include "server/query/query.h"
#include "server/query/result.h"

#define BYTES_A_TRACE ((size_t)1 << 20)
#define ISOLINE_EDGE  32  /* bytes needed for each edge of the mesh while an isoline is traced */
#define INDEX_SHARE   0.2 /* fraction of the progress for building the index of isolines */
#define TRACE_SHARE   0.5 /* fraction of the rest for tracing; the remaining part is for writing */
/* limit on the bytes of traced lines that are not yet written */
#define TRACED_BYTES ((size_t)64 << 20)
#define LEVELS       8   /* number of isolines that are traced in parallel */
#define PORTION      512 /* number of points or arcs written between two checks of the control */
#define WHAT         "the answer"

static size_t trace_grant(const struct server_query *query, size_t bytes_an_edge)
{
    return BYTES_A_TRACE + gd_mesh_summary(query->surface->mesh)->edges * bytes_an_edge;
}

/* Writes `count` points of a line. A closed line does not store the repeated last point. */
static enum gd_status points_write(struct server_query *query, const struct gd_point *points,
                                   uint32_t stored, uint32_t count,
                                   const struct gd_control *control)
{
    const struct gd_mesh *mesh = query->surface->mesh;
    enum proto_geometry geometry = query->options.geometry;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < stored && !status; i += PORTION) {
        uint32_t some = stored - i < PORTION ? stored - i : PORTION;
        proto_points_encode(&query->draft, mesh, points + i, some, geometry);
        if (some == PORTION) status = server_query_pause(query, control, (double)i / count);
    }
    if (count > stored) proto_points_encode(&query->draft, mesh, points, 1, geometry);
    return status;
}

/* --- isolines: the question ------------------------------------------------------------------- */

struct isolines_query {
    struct server_query query; /* must be the first member */
    struct proto_isolines wanted;
    double tolerance;
    bool is_file, has_flat_points;
    uint64_t points, arcs; /* written so far */
    struct gd_isoline_index *index;
    /* one for each level; those from `next` to `traced` have been traced and not yet written */
    struct gd_isoline *isolines;
    uint32_t traced, next;
    size_t traced_bytes;   /* bytes of these lines */
    struct gd_path *lines; /* lines for a file; other answers are in the draft */
    double *levels;        /* level of each line */
    uint32_t line_count;
};

/* Determines how lines are written. A file contains polylines only. The points of a line are the
 * ends of its arcs, unless arcs are omitted or a tolerance is given. */
static bool isolines_settle(struct isolines_query *own)
{
    struct server_query *query = &own->query;
    own->is_file = query->form >= SERVER_FORM_FIRST;
    if (own->is_file) {
        query->options.geometry = PROTO_GEOMETRY_XYZ;
        own->wanted.wants_arcs = false;
    }
    own->has_flat_points = !own->wanted.wants_arcs || own->wanted.tolerance > 0;
    own->tolerance = proto_isolines_tolerance(own->wanted.tolerance, query->surface->mesh);
    return proto_isolines_settle(&own->wanted, &query->field.resource->description,
                                 own->query.problem);
}

static bool isolines_decode(struct server_query *query, const json_t *document)
{
    struct isolines_query *own = (struct isolines_query *)query;
    return server_field_query_of_resource(query) &&
           proto_isolines_decode(document, &own->wanted, query->problem) && isolines_settle(own);
}

static bool isolines_parse(struct server_query *query, const struct proto_parameters *parameters)
{
    struct isolines_query *own = (struct isolines_query *)query;
    return server_field_query_of_resource(query) &&
           proto_isolines_parse(parameters, &own->wanted, query->problem) && isolines_settle(own);
}

static void isolines_release(struct server_query *query)
{
    struct isolines_query *own = (struct isolines_query *)query;
    for (uint32_t i = own->next; i < own->traced; i++) gd_isoline_free(&own->isolines[i]);
    for (uint32_t i = 0; i < own->line_count; i++) gd_path_free(&own->lines[i]);
    gd_isoline_index_destroy(own->index);
    free(own->lines);
    free(own->levels);
    proto_isolines_free(&own->wanted);
}

/* --- isolines: the answer --------------------------------------------------------------------- */

/* Counts the points and arcs that the lines add to the answer, and checks the limits. */
static bool lines_admit(struct isolines_query *own, const struct gd_isoline *isoline)
{
    for (uint32_t i = 0; i < isoline->line_count; i++) {
        const struct gd_isoline_line *line = &isoline->lines[i];
        if (own->query.options.geometry != PROTO_GEOMETRY_NONE)
            own->points += own->has_flat_points ? gd_isoline_flat_points(line, own->tolerance)
                                                : line->arc_count + UINT64_C(1);
        if (own->wanted.wants_arcs) own->arcs += line->arc_count;
    }
    if (own->points <= PROTO_ISOLINES_POINTS && own->arcs <= PROTO_ISOLINES_POINTS) return true;
    return proto_problem_exceed(
        own->query.problem, NULL, PROTO_ISOLINES_POINTS,
        "the lines have more than %d points or arcs; ask for fewer levels or a larger tolerance",
        PROTO_ISOLINES_POINTS);
}

/* Stores the line for a file; or writes the line, and returns its bytes to the budget. */
static enum gd_status line_flatten(struct isolines_query *own, const struct gd_isoline_line *line,
                                   const struct gd_control *control)
{
    struct server_query *query = &own->query;
    size_t bytes = gd_isoline_flat_points(line, own->tolerance) * sizeof(struct gd_point);
    struct gd_path path;
    enum gd_status status = server_query_take(query, bytes);
    if (status) return status;
    status = gd_isoline_flatten(query->surface->mesh, line, own->tolerance, control, &path);
    if (!status && own->is_file) {
        path.length = line->length; /* the length of the arcs */
        own->lines[own->line_count++] = path;
        return GD_OK;
    }
    if (!status) {
        status = points_write(query, path.points, path.count, path.count, control);
        gd_path_free(&path);
    }
    server_query_give(query, bytes);
    return status;
}

static enum gd_status line_write(struct isolines_query *own, const struct gd_isoline_line *line,
                                 const struct gd_control *control)
{
    struct server_query *query = &own->query;
    enum gd_status status = GD_OK;
    proto_write_object_begin(&query->draft);
    proto_member_bool(&query->draft, "closed", line->closed);
    proto_member_number(&query->draft, "length", line->length);
    if (query->options.geometry != PROTO_GEOMETRY_NONE) {
        proto_member_array(&query->draft, "points");
        status = own->has_flat_points ? line_flatten(own, line, control)
                                      : points_write(query, line->points, line->point_count,
                                                     line->arc_count + 1, control);
        proto_write_array_end(&query->draft);
    }
    if (own->wanted.wants_arcs) {
        proto_member_array(&query->draft, "arcs");
        for (uint32_t i = 0; i < line->arc_count && !status; i++) {
            proto_arc_encode(&query->draft, query->surface->mesh, &line->arcs[i]);
            if ((i + 1) % PORTION == 0) status = server_query_pause(query, control, 1);
        }
        proto_write_array_end(&query->draft);
    }
    proto_write_object_end(&query->draft);
    return status ? status : server_query_pause(query, control, 1);
}

static enum gd_status lines_reserve(struct isolines_query *own, uint32_t level)
{
    size_t more = own->isolines[level].line_count, count = own->line_count + more;
    if (!own->is_file || more == 0) return GD_OK;
    enum gd_status status =
        server_query_take(&own->query, more * (sizeof *own->lines + sizeof *own->levels));
    if (status) return status;
    struct gd_path *lines = realloc(own->lines, count * sizeof *lines);
    if (lines) own->lines = lines;
    double *levels = realloc(own->levels, count * sizeof *levels);
    if (levels) own->levels = levels;
    for (size_t i = own->line_count; i < count && levels; i++)
        levels[i] = own->wanted.levels[level];
    return lines && levels ? GD_OK : GD_NO_MEMORY;
}

static bool level_write(struct isolines_query *own)
{
    struct server_query *query = &own->query;
    uint32_t level = own->next++, levels = own->wanted.level_count;
    struct gd_isoline *isoline = &own->isolines[level];
    uint32_t count = isoline->line_count;
    enum gd_status status = lines_reserve(own, level);
    proto_write_object_begin(&query->draft);
    proto_member_number(&query->draft, "level", own->wanted.levels[level]);
    proto_member_array(&query->draft, "lines");
    for (uint32_t i = 0; i < count && !status; i++) {
        double share = (1 - TRACE_SHARE) / levels / count;
        struct server_monitor one =
            server_query_monitor(query, TRACE_SHARE + (level * (double)count + i) * share, share);
        const struct gd_control control = server_exchange_control(&one);
        status = line_write(own, &isoline->lines[i], &control);
    }
    proto_write_array_end(&query->draft);
    proto_write_object_end(&query->draft);
    own->traced_bytes -= isoline->bytes;
    server_query_give(query, isoline->bytes);
    gd_isoline_free(isoline);
    if (status) server_query_fail(query, status, WHAT);
    return !status;
}

/* Writes the remaining levels. A long answer is sent level by level. */
static enum server_query_turn levels_write(struct isolines_query *own)
{
    struct server_query *query = &own->query;
    while (own->next < own->wanted.level_count) {
        if (!level_write(own)) return SERVER_QUERY_FAILED;
        if (server_query_can_flush(query)) return SERVER_QUERY_FLUSH;
    }
    proto_write_array_end(&query->draft);
    proto_write_object_end(&query->draft);
    return server_query_end_draft(query, GD_OK, WHAT);
}

static enum gd_status level_trace(void *user, uint32_t number)
{
    struct isolines_query *own = user;
    uint32_t level = own->traced + number, count = own->wanted.level_count;
    struct server_monitor one =
        server_query_monitor(&own->query, TRACE_SHARE * level / count, TRACE_SHARE / count);
    struct server_budgeted_call call = {.workspaces = own->query.exchange->host->workspaces,
                                        .control = server_exchange_control(&one),
                                        .grant = trace_grant(&own->query, ISOLINE_EDGE)};
    while (server_budgeted_call_next(&call)) {
        call.status = gd_isoline_trace_indexed(own->index, own->wanted.levels[level], &call.control,
                                               &own->isolines[level]);
        call.kept = own->isolines[level].bytes;
    }
    return call.status;
}

/* Traces the next levels in parallel, and counts their lines. */
static bool levels_trace_some(struct isolines_query *own)
{
    struct server_tasks tasks = {.run = level_trace, .user = own};
    uint32_t rest = own->wanted.level_count - own->traced, some = rest < LEVELS ? rest : LEVELS;
    enum gd_status status = server_query_run_tasks(&own->query, &tasks, some);
    for (uint32_t i = own->traced; i < own->traced + some; i++) {
        own->query.held += own->isolines[i].bytes;
        own->traced_bytes += own->isolines[i].bytes;
    }
    own->traced += some;
    if (status) return server_query_refuse(&own->query, status, "the isoline");
    for (uint32_t i = own->traced - some; i < own->traced; i++)
        if (!lines_admit(own, &own->isolines[i])) return false;
    return true;
}

/* Traces all levels before the first one is sent, so that a request with too many lines is refused
 * as a whole. If the traced lines take much memory, some levels are already written to the
 * draft. */
static bool levels_trace(struct isolines_query *own)
{
    while (own->traced < own->wanted.level_count) {
        if (!levels_trace_some(own)) return false;
        while (own->traced_bytes > TRACED_BYTES)
            if (!level_write(own)) return false;
    }
    return true;
}

static enum server_query_turn isolines_answer(struct server_query *query,
                                              const struct gd_field *field)
{
    struct isolines_query *own = (struct isolines_query *)query;
    struct server_monitor part = server_query_monitor(query, 0, INDEX_SHARE);
    struct server_budgeted_call call = server_query_begin_call(query, &part, trace_grant(query, 0));
    own->isolines = server_query_allocate(query, own->wanted.level_count, sizeof *own->isolines);
    if (!own->isolines) return server_query_fail(query, GD_BUDGET, "the isolines");
    while (server_budgeted_call_next(&call)) {
        call.status = gd_isoline_index_create(field, &call.control, &own->index);
        call.kept = gd_isoline_index_bytes(query->surface->mesh);
    }
    if (call.status) return server_query_fail(query, call.status, "the isolines");
    proto_write_object_begin(&query->draft);
    proto_member_array(&query->draft, "isolines");
    server_query_pass(query, INDEX_SHARE);
    return levels_trace(own) ? levels_write(own) : SERVER_QUERY_FAILED;
}

static enum server_query_turn isolines_solve(struct server_query *query)
{
    struct isolines_query *own = (struct isolines_query *)query;
    return own->index ? levels_write(own) : server_field_query_solve(query);
}

static bool isolines_write(struct server_query *query, struct server_answer_file *out)
{
    if (!((const struct isolines_query *)query)->line_count)
        return server_result_refuse_nothing(query->problem,
                                            "there are no lines at these distances");
    return server_result_write_listed(query, out);
}

static bool isolines_list_arrays(struct server_query *query)
{
    const struct isolines_query *own = (const struct isolines_query *)query;
    const struct gd_path *lines = own->lines;
    uint32_t count = own->line_count;
    if (!server_query_list_lines(query, lines, sizeof *lines, count)) return false;
    server_arrays_add_numbers(&query->arrays, "level", 0, count, own->levels);
    server_arrays_add_member(&query->arrays, "length", count, lines ? &lines->length : NULL,
                             sizeof *lines);
    return true;
}

const struct server_query_kind server_query_isolines = {.name = "isolines",
                                                        .size = sizeof(struct isolines_query),
                                                        .forms = server_result_line_forms,
                                                        .has_bare_points = true,
                                                        .decode = isolines_decode,
                                                        .parse = isolines_parse,
                                                        .solve = isolines_solve,
                                                        .answer = isolines_answer,
                                                        .write = isolines_write,
                                                        .list_arrays = isolines_list_arrays,
                                                        .release = isolines_release};
