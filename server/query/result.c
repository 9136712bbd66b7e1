#include "server/query/result.h"

#include <stdlib.h>

#include "proto/values/flat_strip.h"
#include "server/query/request.h"

#define WHAT "the file"

/* Bytes of a strip's faces and edges for each point of its path: twice their size, because arrays
 * are copied when they grow. Assumes that the path passes through few vertices. */
#define STRIP_BYTES_A_POINT 512
#define STRIP_BYTES_LEAST   ((size_t)1 << 20)

const struct server_form server_result_line_forms[] = {SERVER_RESULT_LINE_FORMS,
                                                       {NULL, NULL, false}};
const struct server_form server_result_smooth_line_forms[] = {{"obj", "model/obj", false},
                                                              {"glb", "model/gltf-binary", false},
                                                              {"csv", "text/csv", false},
                                                              {NULL, NULL, false}};

/* in the order of SERVER_RESULT_LINE_FORMS */
static const enum gd_result_format line_formats[] = {GD_RESULT_OBJ, GD_RESULT_GLB, GD_RESULT_CSV};

/* Replaces `bytes` of the held bytes by `actual`. Returns true if there was no failure. */
static bool file_settle(const struct server_query *query, size_t bytes, size_t actual,
                        enum gd_status status)
{
    server_budget_adjust(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes, actual);
    query->exchange->held += actual;
    query->exchange->held -= bytes;
    if (status) server_query_fail_file(query, status, WHAT);
    return !status;
}

static bool result_write(const struct server_query *query, const struct gd_result *result,
                         enum gd_result_format format, struct server_answer_file *out)
{
    size_t cost = gd_result_cost(result);
    if (!server_request_take(query->exchange, WHAT, cost, query->problem)) return false;
    enum gd_status status = gd_write_result(result, format, &out->bytes, &out->size);
    return file_settle(query, cost, status ? 0 : out->size, status);
}

bool server_result_write(const struct server_query *query, const struct gd_result *result,
                         enum gd_result_format format, struct server_answer_file *out)
{
    if (!query->with_mesh) return result_write(query, result, format, out);
    const struct gd_mesh_summary *summary = gd_mesh_summary(query->surface->mesh);
    size_t cost = summary->index_count * sizeof(double[3]) + summary->faces * sizeof(uint32_t[3]);
    struct gd_polygons polygons;
    struct gd_result whole = *result;
    if (!server_request_take(query->exchange, WHAT, cost, query->problem)) return false;
    enum gd_status status = gd_mesh_polygons(query->surface->mesh, &polygons);
    whole.mesh = &polygons;
    bool ok = !status && result_write(query, &whole, format, out);
    if (!status) gd_polygons_free(&polygons);
    return file_settle(query, cost, 0, status) && ok;
}

bool server_result_write_poses(struct server_query *query, const struct gd_pose *poses,
                               uint32_t count, struct server_answer_file *out)
{
    if (!query->kind->list_arrays(query)) return false;
    const struct server_array *points = server_arrays_find(&query->arrays, "points"),
                              *first = server_arrays_find(&query->arrays, "first"),
                              *levels = server_arrays_find(&query->arrays, "level");
    if (!points || !points->rows)
        return server_result_refuse_nothing(query->problem, "the answer has no lines");
    double(*positions)[3] = server_query_allocate(query, points->rows, sizeof *positions);
    if (!positions) return server_query_refuse(query, GD_BUDGET, WHAT);
    server_array_copy(points, positions);
    const struct gd_result result = {.points = (const double(*)[3])positions,
                                     .first = first->source,
                                     .line_count = (uint32_t)first->rows - 1,
                                     .levels = levels ? levels->source : NULL,
                                     .poses = poses,
                                     .pose_count = count};
    return server_result_write(query, &result, line_formats[query->form - SERVER_FORM_FIRST], out);
}

bool server_result_write_listed(struct server_query *query, struct server_answer_file *out)
{
    return server_result_write_poses(query, NULL, 0, out);
}

bool server_result_write_strip(const struct server_query *query, const struct gd_path *path,
                               struct server_answer_file *out)
{
    size_t cost = STRIP_BYTES_LEAST + (size_t)path->count * STRIP_BYTES_A_POINT;
    struct server_monitor monitor = server_query_monitor(query, 1, 0);
    struct gd_control control = server_exchange_control(&monitor);
    struct gd_flat_strip strip;
    struct proto_writer writer;
    if (!server_request_take(query->exchange, WHAT, 2 * cost, query->problem)) return false;
    control.budget_bytes = cost;
    enum gd_status status = gd_flat_strip_of(query->surface->mesh, path, &control, &strip);
    if (status) return file_settle(query, 2 * cost, 0, status);
    proto_writer_init(&writer, query->exchange->host->budget->largest_answer);
    proto_writer_expect(&writer, proto_flat_strip_bytes(&strip));
    proto_flat_strip_svg(&writer, &strip, path->length);
    bool ok = proto_writer_check(&writer, query->problem);
    if (ok) out->bytes = proto_writer_take(&writer, &out->size);
    proto_writer_free(&writer);
    gd_flat_strip_free(&strip);
    file_settle(query, 2 * cost, ok ? out->size : 0, GD_OK);
    return ok;
}

bool server_result_refuse_nothing(struct proto_problem *problem, const char *why)
{
    return proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "%s, so there is nothing to draw; ask for JSON instead", why);
}
