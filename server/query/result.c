#include "server/query/result.h"

#include <stdlib.h>

#include "proto/flat_strip.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define WHAT "the file"

/* Counts so many more bytes for the exchange. */
static bool hold(const struct server_query *query, size_t bytes, struct proto_problem *problem)
{
    struct server_budget *budget = query->exchange->host->budget;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, bytes))
        return server_budget_refuse(budget, WHAT, bytes, problem);
    query->exchange->held += bytes;
    return true;
}

/* Corrects what was counted, `bytes` of it for what turned out to be `actual`. */
static void settle(const struct server_query *query, size_t bytes, size_t actual)
{
    server_budget_adjust(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes, actual);
    query->exchange->held += actual;
    query->exchange->held -= bytes;
}

static bool write(const struct server_query *query, const struct gd_result *result,
                  enum gd_result_format format, char **bytes, size_t *size,
                  struct proto_problem *problem)
{
    size_t cost = gd_result_cost(result);
    if (!hold(query, cost, problem)) return false;
    enum gd_status status = gd_write_result(result, format, bytes, size);
    settle(query, cost, status ? 0 : *size);
    if (status) server_query_fail(query, status, WHAT, problem);
    return !status;
}

/* What the mesh's polygons take while they are written. */
static size_t polygons_bytes(const struct gd_mesh *mesh)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    return summary->index_count * sizeof(double[3]) + summary->faces * sizeof(uint32_t[3]);
}

bool server_result_write(const struct server_query *query, const struct gd_result *result,
                         bool with_mesh, enum gd_result_format format, char **bytes, size_t *size,
                         struct proto_problem *problem)
{
    const struct gd_mesh *mesh = query->surface->mesh;
    if (!with_mesh) return write(query, result, format, bytes, size, problem);
    struct gd_polygons polygons;
    struct gd_result whole = *result;
    size_t cost = polygons_bytes(mesh);
    if (!hold(query, cost, problem)) return false;
    enum gd_status status = gd_mesh_polygons(mesh, &polygons);
    whole.mesh = &polygons;
    bool ok = !status && write(query, &whole, format, bytes, size, problem);
    if (status) server_query_fail(query, status, WHAT, problem);
    if (!status) gd_polygons_free(&polygons);
    settle(query, cost, 0);
    return ok;
}

/* --- lines ------------------------------------------------------------------------------------ */

/* `first` tells where each path's points are, and how many there are. */
static bool write_lines(const struct server_query *query, const struct server_result_lines *lines,
                        const uint32_t *first, char **bytes, size_t *size,
                        struct proto_problem *problem)
{
    static const enum gd_result_format formats[] = {GD_RESULT_OBJ, GD_RESULT_GLB, GD_RESULT_CSV};
    double(*positions)[3] = malloc(first[lines->count] * sizeof *positions);
    if (!positions) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < lines->count; i++)
        gd_points_positions(query->surface->mesh, lines->paths[i].points, lines->paths[i].count,
                            positions + first[i]);
    const struct gd_result result = {.points = (const double(*)[3])positions,
                                     .first = first,
                                     .line_count = lines->count,
                                     .levels = lines->levels};
    bool ok = server_result_write(query, &result, query->with_mesh,
                                  formats[query->form - SERVER_FORM_FIRST], bytes, size, problem);
    free(positions);
    return ok;
}

bool server_result_write_lines(const struct server_query *query,
                               const struct server_result_lines *lines, char **bytes, size_t *size,
                               struct proto_problem *problem)
{
    uint32_t count = lines->count, *first = calloc(count + (size_t)1, sizeof *first);
    if (!first) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    for (uint32_t i = 0; i < count; i++) first[i + 1] = first[i] + lines->paths[i].count;
    size_t cost = first[count] * sizeof(double[3]) + count * sizeof *first;
    bool ok = hold(query, cost, problem);
    if (ok) {
        ok = write_lines(query, lines, first, bytes, size, problem);
        settle(query, cost, 0);
    }
    free(first);
    return ok;
}

/* --- as a drawing ----------------------------------------------------------------------------- */

/* faces and their gates, twice while they grow; a path goes around few vertices */
#define STRIP_BYTES_A_POINT 512
#define STRIP_BYTES_LEAST   ((size_t)1 << 20)

static bool draw(const struct server_query *query, const struct gd_flat_strip *strip, double length,
                 char **bytes, size_t *size, struct proto_problem *problem)
{
    struct proto_writer writer;
    proto_writer_init(&writer, query->exchange->host->budget->largest_answer);
    proto_writer_expect(&writer, proto_flat_strip_bytes(strip));
    proto_flat_strip_svg(&writer, strip, length);
    bool ok = proto_writer_check(&writer, problem);
    if (ok) *bytes = proto_writer_take(&writer, size);
    proto_writer_free(&writer);
    return ok;
}

bool server_result_write_strip(const struct server_query *query, const struct gd_path *path,
                               char **bytes, size_t *size, struct proto_problem *problem)
{
    size_t cost = STRIP_BYTES_LEAST + (size_t)path->count * STRIP_BYTES_A_POINT;
    struct server_monitor monitor = server_query_monitor(query, 1, 0);
    struct gd_control control = server_exchange_control(&monitor);
    struct gd_flat_strip strip;
    if (!hold(query, 2 * cost, problem)) return false;
    control.budget_bytes = cost;
    enum gd_status status = gd_flat_strip_of(query->surface->mesh, path, &control, &strip);
    bool ok = !status && draw(query, &strip, path->length, bytes, size, problem);
    if (status) server_query_fail(query, status, WHAT, problem);
    if (!status) gd_flat_strip_free(&strip);
    settle(query, 2 * cost, ok ? *size : 0);
    return ok;
}

/* --- none ------------------------------------------------------------------------------------- */

bool server_result_refuse_nothing(struct proto_problem *problem, const char *why)
{
    return proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "%s, so there is nothing to draw; as JSON the answer says so", why);
}
