/* Isolines: the lines of a field at some levels, traced and written level by level, or collected
 * for a file. Always by a worker. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/isoline.h"
#include "proto/path.h"
#include "server/query/field_query.h"
#include "server/query/result.h"

#define BYTES_AN_EDGE 32 /* of the mesh, while a line is traced */
#define BYTES_A_LEVEL ((size_t)1 << 16)
#define TRACE_SHARE   0.5 /* of the work at a level; the rest is to write it */
#define PORTION       512 /* elements that are written between two looks at the control */
#define WHAT          "the answer"

struct isolines {
    struct server_field_query field; /* first */
    struct proto_isolines wanted;
    uint64_t points, arcs; /* written so far */
    struct gd_path *lines; /* of a file; the draft has none */
    double *levels;        /* one for each of these */
    uint32_t line_count;
};

static const struct gd_mesh *mesh_of(const struct isolines *isolines)
{
    return isolines->field.query.surface->mesh;
}

static bool is_file(const struct isolines *isolines)
{
    return isolines->field.query.form >= SERVER_FORM_FIRST;
}

/* --- limits ----------------------------------------------------------------------------------- */

/* The points of a line are the ends of its arcs, if these are told, unless more are asked for. */
static bool has_ends_only(const struct isolines *isolines)
{
    return isolines->wanted.wants_arcs && !(isolines->wanted.tolerance > 0);
}

static bool refuse_size(struct proto_problem *problem)
{
    proto_problem_set(
        problem, PROTO_PROBLEM_TOO_LARGE,
        "the lines have more than %d points or arcs; ask for fewer levels or a larger tolerance",
        PROTO_ISOLINES_POINTS);
    return proto_problem_limit(problem, PROTO_ISOLINES_POINTS);
}

/* Counts what the line adds to the answer. */
static bool admit(struct isolines *isolines, const struct gd_isoline_line *line,
                  struct proto_problem *problem)
{
    double tolerance = proto_isolines_tolerance(&isolines->wanted, mesh_of(isolines));
    if (isolines->field.query.options.geometry != PROTO_GEOMETRY_NONE)
        isolines->points += has_ends_only(isolines) ? line->arc_count + UINT64_C(1)
                                                    : gd_isoline_flat_points(line, tolerance);
    if (isolines->wanted.wants_arcs) isolines->arcs += line->arc_count;
    return (isolines->points <= PROTO_ISOLINES_POINTS && isolines->arcs <= PROTO_ISOLINES_POINTS) ||
           refuse_size(problem);
}

/* --- one line --------------------------------------------------------------------------------- */

static enum gd_status pause_at(struct isolines *isolines, const struct gd_control *control,
                               double fraction)
{
    enum gd_status status = server_query_check_draft(&isolines->field.query);
    return status ? status : gd_control_check(control, fraction);
}

/* `count` points, of which a closed line has stored all but the last. */
static enum gd_status write_points(struct isolines *isolines, const struct gd_point *points,
                                   uint32_t stored, uint32_t count,
                                   const struct gd_control *control)
{
    struct proto_writer *writer = &isolines->field.query.draft;
    enum gd_status status = GD_OK;
    proto_line_list_begin(writer, "points");
    for (uint32_t i = 0; i < count && !status; i++) {
        proto_path_point_encode(writer, mesh_of(isolines), &points[i % stored],
                                isolines->field.query.options.geometry);
        if ((i + 1) % PORTION == 0) status = pause_at(isolines, control, (double)i / count);
    }
    proto_line_list_end(writer);
    return status;
}

static enum gd_status write_arcs(struct isolines *isolines, const struct gd_isoline_line *line,
                                 const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    proto_line_list_begin(&isolines->field.query.draft, "arcs");
    for (uint32_t i = 0; i < line->arc_count && !status; i++) {
        proto_arc_encode(&isolines->field.query.draft, mesh_of(isolines), &line->arcs[i]);
        if ((i + 1) % PORTION == 0) status = pause_at(isolines, control, 1);
    }
    proto_line_list_end(&isolines->field.query.draft);
    return status;
}

static enum gd_status write_flat(struct isolines *isolines, const struct gd_isoline_line *line,
                                 double tolerance, const struct gd_control *control)
{
    struct gd_path path;
    enum gd_status status = gd_isoline_flatten(mesh_of(isolines), line, tolerance, control, &path);
    if (status) return status;
    if (is_file(isolines)) {
        isolines->lines[isolines->line_count++] = path;
        return GD_OK;
    }
    status = write_points(isolines, path.points, path.count, path.count, control);
    gd_path_free(&path);
    return status;
}

/* Flattened, with its points counted in the budget as long as they are there. */
static enum gd_status flatten(struct isolines *isolines, const struct gd_isoline_line *line,
                              const struct gd_control *control)
{
    double tolerance = proto_isolines_tolerance(&isolines->wanted, mesh_of(isolines));
    size_t bytes = gd_isoline_flat_points(line, tolerance) * sizeof(struct gd_point);
    enum gd_status status = server_query_take(&isolines->field.query, bytes);
    if (status) return status;
    status = write_flat(isolines, line, tolerance, control);
    if (!is_file(isolines)) server_query_give(&isolines->field.query, bytes);
    return status;
}

static enum gd_status write_line(struct isolines *isolines, const struct gd_isoline_line *line,
                                 const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    proto_line_begin(&isolines->field.query.draft, line);
    if (isolines->field.query.options.geometry != PROTO_GEOMETRY_NONE)
        status = has_ends_only(isolines) ? write_points(isolines, line->points, line->point_count,
                                                        line->arc_count + 1, control)
                                         : flatten(isolines, line, control);
    if (!status && isolines->wanted.wants_arcs) status = write_arcs(isolines, line, control);
    proto_line_end(&isolines->field.query.draft);
    return status ? status : pause_at(isolines, control, 1);
}

/* --- one level -------------------------------------------------------------------------------- */

static bool write_lines(struct isolines *isolines, const struct gd_isoline *isoline,
                        const struct server_monitor *part, struct proto_problem *problem)
{
    proto_isoline_begin(&isolines->field.query.draft, isoline->level);
    for (uint32_t i = 0; i < isoline->line_count; i++) {
        struct server_monitor monitor = server_monitor_portion(
            part, (double)i / isoline->line_count, 1.0 / isoline->line_count);
        const struct gd_control control = server_exchange_control(&monitor);
        if (!admit(isolines, &isoline->lines[i], problem)) return false;
        enum gd_status status = write_line(isolines, &isoline->lines[i], &control);
        if (status) {
            server_query_fail(&isolines->field.query, status, WHAT, problem);
            return false;
        }
    }
    proto_isoline_end(&isolines->field.query.draft);
    return true;
}

static enum gd_status grow(struct isolines *isolines, size_t count)
{
    struct gd_path *lines = realloc(isolines->lines, count * sizeof *lines);
    if (!lines) return GD_NO_MEMORY;
    isolines->lines = lines;
    double *levels = realloc(isolines->levels, count * sizeof *levels);
    if (!levels) return GD_NO_MEMORY;
    isolines->levels = levels;
    return GD_OK;
}

/* For so many more lines of a file, of a level. */
static bool make_room(struct isolines *isolines, uint32_t more, double level,
                      struct proto_problem *problem)
{
    size_t count = isolines->line_count + (size_t)more;
    if (!is_file(isolines) || more == 0) return true;
    enum gd_status status = server_query_take(
        &isolines->field.query, more * (sizeof *isolines->lines + sizeof *isolines->levels));
    if (!status) status = grow(isolines, count);
    for (size_t i = isolines->line_count; i < count && !status; i++) isolines->levels[i] = level;
    return !status ||
           server_query_fail(&isolines->field.query, status, WHAT, problem) == SERVER_QUERY_DONE;
}

struct tracing {
    const struct gd_field *field;
    double level;
    struct gd_isoline *out;
};

static enum gd_status trace(void *user, const struct gd_control *control, size_t *kept)
{
    const struct tracing *wanted = user;
    enum gd_status status = gd_isoline_trace(wanted->field, wanted->level, control, wanted->out);
    if (!status) *kept = wanted->out->bytes;
    return status;
}

static enum gd_status trace_level(struct isolines *isolines, const struct gd_field *field,
                                  double level, struct server_monitor *part, struct gd_isoline *out)
{
    struct tracing wanted = {field, level, out};
    size_t grant =
        BYTES_A_LEVEL + gd_mesh_summary(mesh_of(isolines))->edges * (size_t)BYTES_AN_EDGE;
    return server_query_call(&isolines->field.query, part, trace, &wanted, grant);
}

static bool write_level(struct isolines *isolines, const struct gd_field *field, double level,
                        const struct server_monitor *part, struct proto_problem *problem)
{
    struct server_monitor first = server_monitor_portion(part, 0, TRACE_SHARE),
                          second = server_monitor_portion(part, TRACE_SHARE, 1 - TRACE_SHARE);
    struct gd_isoline isoline;
    enum gd_status status = trace_level(isolines, field, level, &first, &isoline);
    if (status) {
        server_query_fail(&isolines->field.query, status, "the isoline", problem);
        return false;
    }
    bool ok = make_room(isolines, isoline.line_count, level, problem) &&
              write_lines(isolines, &isoline, &second, problem);
    server_query_give(&isolines->field.query, isoline.bytes);
    gd_isoline_free(&isoline);
    return ok;
}

/* --- the steps -------------------------------------------------------------------------------- */

static enum server_query_turn answer(struct server_field_query *query, const struct gd_field *field,
                                     struct server_monitor *part, struct proto_problem *problem)
{
    struct isolines *isolines = (struct isolines *)query;
    uint32_t count = isolines->wanted.level_count;
    proto_isolines_begin(&isolines->field.query.draft);
    for (uint32_t i = 0; i < count; i++) {
        struct server_monitor one = server_monitor_portion(part, (double)i / count, 1.0 / count);
        if (!write_level(isolines, field, isolines->wanted.levels[i], &one, problem))
            return SERVER_QUERY_FAILED;
    }
    proto_isolines_end(&isolines->field.query.draft);
    return server_query_end_draft(&query->query, GD_OK, WHAT, problem);
}

/* The request was read. A file has polylines only, and always. */
static bool settle(struct isolines *isolines, struct proto_problem *problem)
{
    isolines->field.answer = answer;
    if (is_file(isolines)) {
        isolines->field.query.options.geometry = PROTO_GEOMETRY_XYZ;
        isolines->wanted.wants_arcs = false;
    }
    return proto_isolines_settle(&isolines->wanted, &isolines->field.resource->description,
                                 problem);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct isolines *isolines = (struct isolines *)query;
    return server_field_query_of_resource(&isolines->field, problem) &&
           proto_isolines_decode(document, &isolines->wanted, problem) && settle(isolines, problem);
}

static bool parse(struct server_query *query, const struct proto_parameters *parameters,
                  struct proto_problem *problem)
{
    struct isolines *isolines = (struct isolines *)query;
    return server_field_query_of_resource(&isolines->field, problem) &&
           proto_isolines_parse(parameters, &isolines->wanted, problem) &&
           settle(isolines, problem);
}

static bool write_file(const struct server_query *query, char **bytes, size_t *size,
                       struct proto_problem *problem)
{
    const struct isolines *isolines = (const struct isolines *)query;
    if (!isolines->line_count)
        return server_result_refuse_nothing(problem, "there are no lines at these distances");
    const struct server_result_lines lines = {isolines->lines, isolines->levels,
                                              isolines->line_count};
    return server_result_write_lines(query, &lines, bytes, size, problem);
}

static void release(struct server_query *query)
{
    struct isolines *isolines = (struct isolines *)query;
    for (uint32_t i = 0; i < isolines->line_count; i++) gd_path_free(&isolines->lines[i]);
    free(isolines->lines);
    free(isolines->levels);
    proto_isolines_free(&isolines->wanted);
    server_field_query_release(query);
}

static const struct server_form isolines_forms[] = {SERVER_RESULT_LINE_FORMS, {NULL, NULL, false}};

static const struct server_query_kind isolines_kind = {.name = "isolines",
                                                       .size = sizeof(struct isolines),
                                                       .fields = proto_isolines_fields,
                                                       .parameters = proto_isolines_parameters,
                                                       .decode = decode,
                                                       .parse = parse,
                                                       .glance = server_field_query_glance,
                                                       .join = server_field_query_join,
                                                       .solve = server_field_query_solve,
                                                       .forms = isolines_forms,
                                                       .write = write_file,
                                                       .release = release};

void server_handle_isolines(struct server_exchange *exchange)
{
    server_query_handle(exchange, &isolines_kind);
}
