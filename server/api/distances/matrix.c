/* Matrix: workers compute the distances from each source to each target.
 *
 * DESIGN. The metric is symmetric: sources or targets, whichever are fewer, become the rows. Each
 * different point is one row or column. A row is evaluated in the cached field of its point. If
 * there is none, a propagation computes the columns' distances and keeps no field. Rows of few
 * columns are searched pair by pair. Distances between components are infinite and need no
 * computation.
 *
 * Each row is a task of an executor (executor.h) with its own workspace and its own grant from the
 * memory budget. The first failure ends all rows. A row that uses a field then ends within about a
 * millisecond. A row that uses searches ends after its current search. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "proto/queries/matrix.h"
#include "server/fields/cache.h"
#include "server/query/query.h"
#include "server/work/budgeted_call.h"

/* searches for this many columns take half as long as a field */
#define FEW_COLUMNS (SERVER_CACHE_SEARCHES / 2)
/* bytes that an evaluation needs for each column, see gd_field_distances */
#define BYTES_A_COLUMN 16

/* The different points of a list. */
struct point_index {
    struct gd_point *points;
    uint32_t count;
    /* for each position in the list: the index of its point in `points`; in the same allocation as
       `points` */
    uint32_t *number;
};

struct matrix_query {
    struct server_query query;           /* must be the first member */
    struct proto_located_points targets; /* the sources are the query's points */
    double max_distance;                 /* INFINITY means no limit */
    /* one row for each source; INFINITY means no path; NAN means farther than max_distance */
    double *distances;

    bool is_turned; /* true if the rows are the targets */
    struct point_index rows, columns;
    double *row_distances; /* rows x columns */
    atomic_size_t grant;   /* bytes that were sufficient for the rows computed so far */
    struct server_tasks tasks;
};

struct matrix_row {
    struct matrix_query *matrix;
    const struct gd_point *point;
    double *distances; /* one for each column */
    struct server_monitor monitor;
};

static void matrix_release(struct server_query *query)
{
    proto_located_points_free(&((struct matrix_query *)query)->targets);
}

static bool matrix_decode(struct server_query *query, const json_t *document)
{
    struct proto_problem *problem = query->problem;
    struct matrix_query *matrix = (struct matrix_query *)query;
    struct proto_matrix_request wanted;
    if (!proto_matrix_request_decode(document, &wanted, problem)) return false;
    bool ok = proto_matrix_check(&wanted, problem) && server_query_locate(query, &wanted.sources) &&
              proto_points_locate(query->surface->mesh, &wanted.targets, &matrix->targets, problem);
    matrix->max_distance = wanted.has_max_distance ? wanted.max_distance : INFINITY;
    proto_matrix_request_free(&wanted);
    return ok;
}

/* --- different points ------------------------------------------------------------------------- */

/* Orders points; returns zero for points that gd_point_equal considers equal. */
static int point_compare(const void *a, const void *b)
{
    const struct gd_point *x = *(const struct gd_point *const *)a,
                          *y = *(const struct gd_point *const *)b;
    if (x->kind != y->kind) return x->kind < y->kind ? -1 : 1;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    return memcmp(x->weight, y->weight, sizeof x->weight);
}

/* Lists the different points. Returns false if out of memory. O(n log n). */
static bool points_index(const struct proto_located_points *list, struct point_index *out)
{
    const struct gd_point **sorted = malloc(list->count * sizeof *sorted);
    out->points = malloc(list->count * (sizeof *out->points + sizeof *out->number));
    if (sorted && out->points) {
        out->number = (uint32_t *)(out->points + list->count);
        for (uint32_t i = 0; i < list->count; i++) sorted[i] = &list->points[i];
        qsort(sorted, list->count, sizeof *sorted, point_compare);
        for (uint32_t i = 0; i < list->count; i++) {
            if (!i || point_compare(&sorted[i - 1], &sorted[i]) != 0)
                out->points[out->count++] = *sorted[i];
            out->number[sorted[i] - list->points] = out->count - 1;
        }
    }
    free(sorted);
    return out->count;
}

/* --- a row from a field ----------------------------------------------------------------------- */

/* Cancels a row if another row has failed. */
static bool row_on_progress(void *user, double fraction)
{
    struct matrix_row *row = user;
    if (atomic_load_explicit(&row->matrix->tasks.failure, memory_order_relaxed)) return false;
    struct gd_control control = server_exchange_control(&row->monitor);
    return control.progress(control.user, fraction);
}

static struct gd_control row_control(struct matrix_row *row)
{
    struct gd_control control = server_exchange_control(&row->monitor);
    control.progress = row_on_progress;
    control.user = row;
    return control;
}

static bool column_is_apart(const struct matrix_row *row, uint32_t column)
{
    const struct gd_mesh *mesh = row->matrix->query.surface->mesh;
    return gd_point_component(mesh, row->point) !=
           gd_point_component(mesh, &row->matrix->columns.points[column]);
}

/* Replaces distances to other components by INFINITY, and distances beyond the limit by NAN. */
static void row_limit(const struct matrix_row *row)
{
    for (uint32_t i = 0; i < row->matrix->columns.count; i++) {
        if (column_is_apart(row, i))
            row->distances[i] = INFINITY;
        else if (!(row->distances[i] <= row->matrix->max_distance))
            row->distances[i] = NAN;
    }
}

static enum gd_status row_evaluate(const struct matrix_row *row, const struct gd_field *field,
                                   const struct gd_control *control)
{
    const struct point_index *columns = &row->matrix->columns;
    enum gd_status status =
        gd_field_distances(field, columns->points, columns->count, control, row->distances);
    if (!status) row_limit(row);
    return status;
}

/* Returns the request of a row's field. The field reaches just beyond the limit, so that distances
 * equal to the limit are final. */
static struct gd_field_request row_request(const struct matrix_row *row, struct gd_seed *seed)
{
    double limit = row->matrix->max_distance;
    *seed = (struct gd_seed){.point = *row->point};
    return (struct gd_field_request){
        .seeds = seed, .seed_count = 1, .radius = isfinite(limit) ? nextafter(limit, INFINITY) : 0};
}

/* Computes a row without keeping a field. The next row begins with this row's grant. */
static enum gd_status row_from_propagation(const struct matrix_row *row,
                                           const struct gd_control *control)
{
    const struct point_index *columns = &row->matrix->columns;
    struct gd_seed seed;
    struct gd_field_request request = row_request(row, &seed);
    request.points = columns->points;
    request.point_count = columns->count;
    enum gd_status status = gd_field_distances_only(row->matrix->query.surface->mesh, &request,
                                                    control, row->distances, NULL);
    if (status) return status;
    atomic_store(&row->matrix->grant, control->budget_bytes);
    row_limit(row);
    return GD_OK;
}

static enum gd_status row_propagate(struct matrix_row *row)
{
    struct matrix_query *matrix = row->matrix;
    struct server_budgeted_call call = {.workspaces = row->monitor.exchange->host->workspaces,
                                        .control = row_control(row),
                                        .grant = atomic_load(&matrix->grant),
                                        .aside = (size_t)matrix->columns.count * BYTES_A_COLUMN};
    while (server_budgeted_call_next(&call)) call.status = row_from_propagation(row, &call.control);
    return call.status;
}

/* --- a row by searches ------------------------------------------------------------------------ */

static enum gd_status row_search(const struct matrix_row *row)
{
    const struct matrix_query *matrix = row->matrix;
    uint32_t count = matrix->columns.count;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        const struct server_pair pair = {row->point, &matrix->columns.points[i], GD_PAIR_DISTANCE};
        struct server_monitor part = row->monitor;
        struct gd_pair_answer answer;
        part.share /= count;
        part.begun += i * part.share;
        status = server_pair_solve(&part, matrix->query.surface, &pair, &answer);
        if (!status) row->distances[i] = answer.distance;
    }
    return status;
}

/* --- rows ------------------------------------------------------------------------------------- */

static enum gd_status row_solve(struct matrix_row *row)
{
    const struct matrix_query *matrix = row->matrix;
    struct gd_seed seed;
    const struct gd_field_request request = row_request(row, &seed);
    uint32_t column = 0;
    while (column < matrix->columns.count && column_is_apart(row, column)) column++;
    if (column == matrix->columns.count) {
        row_limit(row);
        return GD_OK;
    }
    const struct server_cached *cached =
        server_cache_find_field(matrix->query.surface->fields, &request);
    if (cached) {
        const struct gd_control control = row_control(row);
        enum gd_status status = row_evaluate(row, cached->field, &control);
        server_cache_unpin(cached);
        return status;
    }
    bool is_short = matrix->columns.count < FEW_COLUMNS && !isfinite(matrix->max_distance);
    return is_short ? row_search(row) : row_propagate(row);
}

static enum gd_status row_run(void *user, uint32_t number)
{
    struct matrix_query *matrix = user;
    double share = 1.0 / matrix->rows.count;
    struct matrix_row row = {
        .matrix = matrix,
        .point = &matrix->rows.points[number],
        .distances = matrix->row_distances + (size_t)number * matrix->columns.count,
        .monitor = server_query_monitor(&matrix->query, number * share, share)};
    return row_solve(&row);
}

/* --- the matrix ------------------------------------------------------------------------------- */

/* Copies the distances of different points to all positions of the lists. */
static void matrix_spread(struct matrix_query *matrix)
{
    const uint32_t *row = matrix->rows.number, *column = matrix->columns.number;
    size_t columns = matrix->columns.count;
    double *out = matrix->distances;
    for (size_t i = 0; i < matrix->query.points.count; i++)
        for (size_t j = 0; j < matrix->targets.count; j++)
            *out++ = matrix->row_distances[matrix->is_turned ? row[j] * columns + column[i]
                                                             : row[i] * columns + column[j]];
}

static enum gd_status matrix_work(struct matrix_query *matrix)
{
    struct point_index sources = {0}, targets = {0};
    bool ok =
        points_index(&matrix->query.points, &sources) && points_index(&matrix->targets, &targets);
    matrix->is_turned = targets.count < sources.count;
    matrix->rows = matrix->is_turned ? targets : sources;
    matrix->columns = matrix->is_turned ? sources : targets;
    matrix->grant = server_distances_only_grant(matrix->query.surface->mesh);
    matrix->row_distances =
        malloc((size_t)matrix->rows.count * matrix->columns.count * sizeof *matrix->row_distances);
    matrix->tasks = (struct server_tasks){.run = row_run, .user = matrix};
    enum gd_status status =
        ok && matrix->row_distances
            ? server_query_run_tasks(&matrix->query, &matrix->tasks, matrix->rows.count)
            : GD_NO_MEMORY;
    if (!status) matrix_spread(matrix);
    free(sources.points);
    free(targets.points);
    free(matrix->row_distances);
    return status;
}

static enum server_query_turn matrix_solve(struct server_query *query)
{
    struct matrix_query *matrix = (struct matrix_query *)query;
    size_t points = (size_t)query->points.count + matrix->targets.count,
           entries = (size_t)query->points.count * matrix->targets.count,
           cost = entries * sizeof(double) +
                  points * (sizeof(struct gd_point) + 2 * sizeof(uint32_t) + sizeof(bool));
    matrix->distances = server_query_allocate(query, entries, sizeof *matrix->distances);
    enum gd_status status = matrix->distances ? server_query_take(query, cost) : GD_BUDGET;
    if (!status) {
        status = matrix_work(matrix);
        server_query_give(query, cost);
    }
    return server_query_end_draft(query, status, "the matrix");
}

static void matrix_encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct matrix_query *matrix = (const struct matrix_query *)query;
    const struct proto_matrix_answer answer = {matrix->distances, query->points.count,
                                               matrix->targets.count};
    proto_matrix_encode(writer, &answer, &query->options);
}

static bool matrix_list_arrays(struct server_query *query)
{
    const struct matrix_query *matrix = (const struct matrix_query *)query;
    server_arrays_add_numbers(&query->arrays, "distances", matrix->targets.count,
                              query->points.count, matrix->distances);
    return true;
}

const struct server_query_kind server_query_matrix = {.name = "matrix",
                                                      .size = sizeof(struct matrix_query),
                                                      .decode = matrix_decode,
                                                      .solve = matrix_solve,
                                                      .encode = matrix_encode,
                                                      .has_bytes = true,
                                                      .list_arrays = matrix_list_arrays,
                                                      .release = matrix_release};
