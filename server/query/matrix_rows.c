/* See matrix.h. */
#include "server/query/matrix_rows.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "server/work/budgeted_call.h"
#include "server/query/distinct_points.h"
#include "server/work/executor.h"
#include "server/query/field_build.h"
#include "server/surfaces/landmarks.h"
#include "server/query/pair_search.h"
#include "server/query/api.h"

/* so many searches take half as long as a field */
#define FEW_COLUMNS    (SERVER_CACHE_SEARCHES / 2)
#define BYTES_A_COLUMN 16 /* of an evaluation, see gd_field_distances */
/* of a row without wedges: 7 to 30, see gd_field_distances_only */
#define BYTES_AN_EDGE 96
/* of one on any mesh: the queue, and what is taken in advance */
#define BYTES_A_ROW ((size_t)1 << 20)

struct matrix {
    const struct server_monitor *part;
    struct server_surface *surface;
    const struct server_distinct *rows, *columns;
    const uint32_t *vertices; /* per column: its vertex index; NULL: not all of them are vertices */
    double max_distance;
    const struct gd_landmarks *landmarks; /* NULL: there are none */
    double *distances;                    /* rows x columns */
    bool *is_left;                        /* per row: it found too little memory while others ran */
    bool is_alone;                        /* one row at a time */
    /* bytes that were enough for the rows so far, see server_budgeted_call */
    atomic_size_t grant;
    atomic_int status; /* the first failure */
};

/* One row on its way. */
struct row {
    struct matrix *matrix;
    const struct gd_point *point;
    double *distances; /* per column */
    struct server_monitor monitor;
};

/* --- what a row is told ----------------------------------------------------------------------- */

/* Tells the exchange, and the row that another one has failed. */
static bool on_progress(void *user, double fraction)
{
    struct row *row = user;
    if (atomic_load_explicit(&row->matrix->status, memory_order_relaxed) != GD_OK) return false;
    struct gd_control control = server_exchange_control(&row->monitor);
    return control.progress(control.user, fraction);
}

static struct gd_control control_of(struct row *row)
{
    struct gd_control control = server_exchange_control(&row->monitor);
    control.progress = on_progress;
    control.user = row;
    return control;
}

/* --- a row from a field ----------------------------------------------------------------------- */

static bool is_apart(const struct row *row, uint32_t column)
{
    const struct gd_mesh *mesh = row->matrix->surface->mesh;
    return gd_point_component(mesh, row->point) !=
           gd_point_component(mesh, &row->matrix->columns->points[column]);
}

/* Why there are no distances, and to points that are too far. */
static void tell_reasons(const struct row *row)
{
    for (uint32_t i = 0; i < row->matrix->columns->count; i++) {
        if (is_apart(row, i))
            row->distances[i] = INFINITY;
        else if (!(row->distances[i] <= row->matrix->max_distance))
            row->distances[i] = NAN;
    }
}

static enum gd_status measure(const struct row *row, const struct gd_field *field,
                              const struct gd_control *control)
{
    const struct server_distinct *columns = row->matrix->columns;
    enum gd_status status =
        gd_field_distances(field, columns->points, columns->count, control, row->distances);
    if (!status) tell_reasons(row);
    return status;
}

/* A bound just above the limit: what lies at the limit itself is final. */
static struct gd_field_request request_of(const struct row *row, struct gd_seed *seed)
{
    double limit = row->matrix->max_distance;
    *seed = (struct gd_seed){.point = *row->point};
    return (struct gd_field_request){
        .seeds = seed, .seed_count = 1, .radius = isfinite(limit) ? nextafter(limit, INFINITY) : 0};
}

/* Rows are alike: they begin with what was enough for another, so that none is begun in vain. */
static void learn(const struct row *row, const struct gd_control *control)
{
    atomic_store(&row->matrix->grant, control->budget_bytes);
}

/* By a field that is dropped. */
static enum gd_status measure_points(void *user, const struct gd_control *control, size_t *kept)
{
    const struct row *row = user;
    struct gd_seed seed;
    const struct gd_field_request request = request_of(row, &seed);
    struct gd_field *field;
    *kept = 0;
    enum gd_status status =
        gd_field_build(row->matrix->surface->mesh, &request, control, NULL, &field, NULL);
    if (status) return status;
    learn(row, control);
    status = measure(row, field, control);
    gd_field_release(field);
    return status;
}

/* By no field at all: of a vertex the distance is known without the wedges, which are most of a
 * field's memory. */
static enum gd_status measure_vertices(void *user, const struct gd_control *control, size_t *kept)
{
    const struct row *row = user;
    const struct gd_mesh *mesh = row->matrix->surface->mesh;
    struct gd_seed seed;
    const struct gd_field_request request = request_of(row, &seed);
    double *distances = malloc(gd_mesh_summary(mesh)->index_count * sizeof *distances);
    *kept = 0;
    enum gd_status status = distances
                                ? gd_field_distances_only(mesh, &request, control, distances, NULL)
                                : GD_NO_MEMORY;
    if (!status) {
        learn(row, control);
        for (uint32_t i = 0; i < row->matrix->columns->count; i++)
            row->distances[i] = distances[row->matrix->vertices[i]];
        tell_reasons(row);
    }
    free(distances);
    return status;
}

static enum gd_status row_by_propagation(struct row *row)
{
    struct matrix *matrix = row->matrix;
    bool is_plain = matrix->vertices != NULL;
    const struct gd_mesh_summary *summary = gd_mesh_summary(matrix->surface->mesh);
    const struct server_budgeted_call call = {
        .make = is_plain ? measure_vertices : measure_points,
        .user = row,
        .control = control_of(row),
        .grant = atomic_load(&matrix->grant),
        .aside = is_plain ? summary->index_count * sizeof(double)
                          : (size_t)matrix->columns->count * BYTES_A_COLUMN};
    return server_budgeted_call_run(row->monitor.exchange->host->workspaces, &call);
}

/* False: the cache has no field of the row's point that reaches far enough. */
static bool row_from_cache(struct row *row, enum gd_status *status)
{
    struct gd_seed seed;
    const struct gd_field_request request = request_of(row, &seed);
    const struct server_cached *cached =
        server_cache_find_field(row->matrix->surface->fields, &request);
    if (!cached) return false;
    struct gd_control control = control_of(row);
    *status = measure(row, cached->field, &control);
    server_cache_unpin(cached);
    return true;
}

/* --- a row by searches ------------------------------------------------------------------------ */

static enum gd_status search(const struct row *row, uint32_t column)
{
    const struct matrix *matrix = row->matrix;
    double share = row->monitor.share / matrix->columns->count;
    struct server_monitor monitor = {.exchange = row->monitor.exchange,
                                     .begun = row->monitor.begun + share * column,
                                     .share = share};
    struct gd_pair_answer answer;
    enum gd_status status =
        server_pair_search(&monitor, matrix->surface->mesh, row->point,
                           &matrix->columns->points[column], false, matrix->landmarks, &answer);
    if (!status) row->distances[column] = answer.distance;
    return status;
}

static enum gd_status row_by_searches(const struct row *row)
{
    const struct matrix *matrix = row->matrix;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < matrix->columns->count && !status; i++) {
        const struct server_cached *cached =
            server_cache_find(matrix->surface->fields, &matrix->columns->points[i]);
        if (!cached || gd_field_distance(cached->field, row->point, &row->distances[i]) != GD_OK)
            status = search(row, i);
        server_cache_unpin(cached);
    }
    return status;
}

/* --- rows ------------------------------------------------------------------------------------- */

static bool is_all_apart(const struct row *row)
{
    uint32_t column = 0;
    while (column < row->matrix->columns->count && is_apart(row, column)) column++;
    return column == row->matrix->columns->count;
}

static enum gd_status solve_row(struct row *row)
{
    const struct matrix *matrix = row->matrix;
    enum gd_status status;
    if (is_all_apart(row)) {
        tell_reasons(row);
        return GD_OK;
    }
    if (row_from_cache(row, &status)) return status;
    bool is_short = matrix->columns->count < FEW_COLUMNS && !isfinite(matrix->max_distance);
    return is_short ? row_by_searches(row) : row_by_propagation(row);
}

static void run_row(void *user, uint32_t number)
{
    struct matrix *matrix = user;
    double share = (matrix->part->share > 0 ? matrix->part->share : 1) / matrix->rows->count;
    struct row row = {.matrix = matrix,
                      .point = &matrix->rows->points[number],
                      .distances = matrix->distances + (size_t)number * matrix->columns->count,
                      .monitor = {.exchange = matrix->part->exchange,
                                  .begun = matrix->part->begun + share * number,
                                  .share = share}};
    int none = GD_OK;
    if (atomic_load(&matrix->status) != GD_OK) return;
    enum gd_status status = solve_row(&row);
    matrix->is_left[number] = status == GD_BUDGET && !matrix->is_alone;
    if (status && !matrix->is_left[number])
        atomic_compare_exchange_strong(&matrix->status, &none, (int)status);
}

static enum gd_status run_rows(struct matrix *matrix)
{
    const struct server_exchange *exchange = matrix->part->exchange;
    const struct gd_executor *executor = server_executor_start(
        exchange->host->workers, matrix->rows->count, exchange->job.deadline_ns);
    gd_executor_run(executor, run_row, matrix, matrix->rows->count);
    server_executor_stop(executor);
    matrix->is_alone = true;
    for (uint32_t i = 0; i < matrix->rows->count; i++)
        if (matrix->is_left[i]) run_row(matrix, i);
    return (enum gd_status)atomic_load(&matrix->status);
}

/* --- the matrix ------------------------------------------------------------------------------- */

/* From different points to all of them. `is_turned`: the rows are the targets. */
static void spread(const struct matrix *matrix, const struct server_matrix_request *request,
                   bool is_turned, double *out)
{
    size_t columns = matrix->columns->count;
    const uint32_t *row = matrix->rows->number, *column = matrix->columns->number;
    for (size_t i = 0; i < request->source_count; i++)
        for (size_t j = 0; j < request->target_count; j++)
            *out++ = matrix->distances[is_turned ? row[j] * columns + column[i]
                                                 : row[i] * columns + column[j]];
}

/* The columns' vertex indices, by malloc; NULL when one is no vertex, or without memory. */
static uint32_t *vertices_of(const struct gd_mesh *mesh, const struct server_distinct *columns)
{
    uint32_t *vertices = malloc(columns->count * sizeof *vertices), i = 0;
    for (; vertices && i < columns->count && columns->points[i].kind == GD_POINT_VERTEX; i++) {
        struct gd_point_description description;
        gd_point_describe(mesh, &columns->points[i], &description);
        vertices[i] = description.vertex.index;
    }
    if (i == columns->count) return vertices;
    free(vertices);
    return NULL;
}

static size_t first_grant(const struct gd_mesh *mesh, bool is_plain)
{
    return is_plain ? BYTES_A_ROW + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE
                    : server_field_build_grant(mesh);
}

static enum gd_status solve(const struct server_monitor *part,
                            const struct server_matrix_request *request,
                            const struct server_distinct *sources,
                            const struct server_distinct *targets, double *out)
{
    bool is_turned = targets->count < sources->count;
    const struct server_distinct *rows = is_turned ? targets : sources,
                                 *columns = is_turned ? sources : targets;
    const struct gd_mesh *mesh = request->surface->mesh;
    struct server_landmark_set *set =
        columns->count < FEW_COLUMNS
            ? server_landmarks_find(part->exchange->host->api->landmarks, request->surface)
            : NULL;
    uint32_t *vertices = vertices_of(mesh, columns);
    struct matrix matrix = {
        .part = part,
        .surface = request->surface,
        .rows = rows,
        .columns = columns,
        .vertices = vertices,
        .max_distance = request->max_distance,
        .grant = first_grant(mesh, vertices != NULL),
        .landmarks = set ? set->landmarks : NULL,
        .distances = malloc((size_t)rows->count * columns->count * sizeof *matrix.distances),
        .is_left = calloc(rows->count, sizeof *matrix.is_left)};
    enum gd_status status = matrix.distances && matrix.is_left ? run_rows(&matrix) : GD_NO_MEMORY;
    if (!status) spread(&matrix, request, is_turned, out);
    server_landmark_set_release(set);
    free(matrix.distances);
    free(matrix.is_left);
    free(vertices);
    return status;
}

enum gd_status server_matrix_solve(const struct server_monitor *part,
                                   const struct server_matrix_request *request, double *out)
{
    struct server_distinct sources = {0}, targets = {0};
    enum gd_status status = GD_NO_MEMORY;
    if (server_distinct_find(request->sources, request->source_count, &sources) &&
        server_distinct_find(request->targets, request->target_count, &targets))
        status = solve(part, request, &sources, &targets, out);
    server_distinct_free(&sources);
    server_distinct_free(&targets);
    return status;
}

size_t server_matrix_cost(const struct server_matrix_request *request)
{
    size_t points = (size_t)request->source_count + request->target_count;
    return (size_t)request->source_count * request->target_count * sizeof(double) +
           points * (sizeof(struct gd_point) + 2 * sizeof(uint32_t) + sizeof(bool));
}
