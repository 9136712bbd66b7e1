/* Matrix: the distances from each source to each target, as rows of a field each
 * (server/query/matrix_rows.h). Always in the second lane. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/matrix.h"
#include "server/query/query.h"
#include "server/query/matrix_rows.h"

#define WHAT "the matrix"

struct matrix {
    struct server_query query; /* first */
    struct proto_located_points sources, targets;
    double max_distance;
    double *distances; /* a source a row; NULL: not there yet */
};

static void release(struct server_query *query)
{
    struct matrix *matrix = (struct matrix *)query;
    proto_located_points_free(&matrix->sources);
    proto_located_points_free(&matrix->targets);
    free(matrix->distances);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct matrix *matrix = (struct matrix *)query;
    const struct gd_mesh *mesh = query->surface->mesh;
    struct proto_matrix wanted;
    if (!proto_matrix_decode(document, &wanted, problem)) return false;
    bool ok = proto_points_locate(mesh, &wanted.sources, &matrix->sources, problem) &&
              proto_points_locate(mesh, &wanted.targets, &matrix->targets, problem);
    matrix->max_distance = wanted.max_distance;
    proto_matrix_free(&wanted);
    return ok;
}

static struct server_matrix_request request_of(const struct matrix *matrix)
{
    return (struct server_matrix_request){.surface = matrix->query.surface,
                                          .sources = matrix->sources.points,
                                          .source_count = matrix->sources.count,
                                          .targets = matrix->targets.points,
                                          .target_count = matrix->targets.count,
                                          .max_distance = matrix->max_distance};
}

static enum gd_status reserve(struct matrix *matrix)
{
    size_t bytes = (size_t)matrix->sources.count * matrix->targets.count * sizeof(double);
    enum gd_status status = server_query_take(&matrix->query, bytes);
    if (status) return status;
    matrix->distances = malloc(bytes);
    return matrix->distances ? GD_OK : GD_NO_MEMORY;
}

/* With bytes of the budget for solving. */
static enum gd_status fill(struct matrix *matrix)
{
    struct server_matrix_request request = request_of(matrix);
    struct server_monitor part = server_query_monitor(&matrix->query, 0, 1);
    size_t cost = server_matrix_cost(&request);
    enum gd_status status = server_query_take(&matrix->query, cost);
    if (status) return status;
    status = server_matrix_solve(&part, &request, matrix->distances);
    server_query_give(&matrix->query, cost);
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct matrix *matrix = (struct matrix *)query;
    enum gd_status status = reserve(matrix);
    if (!status) status = fill(matrix);
    return status ? server_query_fail(query, status, WHAT, problem) : SERVER_QUERY_DONE;
}

static struct proto_matrix_answer answer_of(const struct server_query *query)
{
    const struct matrix *matrix = (const struct matrix *)query;
    return (struct proto_matrix_answer){matrix->distances, matrix->sources.count,
                                        matrix->targets.count};
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    struct proto_matrix_answer answer = answer_of(query);
    proto_matrix_encode(writer, &answer, &query->options);
}

static size_t bytes(const struct server_query *query, void *out)
{
    struct proto_matrix_answer answer = answer_of(query);
    return proto_matrix_bytes(&answer, out);
}

const struct server_query_kind server_query_matrix = {.name = "matrix",
                                                      .size = sizeof(struct matrix),
                                                      .fields = proto_matrix_fields,
                                                      .decode = decode,
                                                      .solve = solve,
                                                      .encode = encode,
                                                      .bytes = bytes,
                                                      .release = release};

void server_handle_matrix(struct server_exchange *exchange)
{
    server_query_handle(exchange, &server_query_matrix);
}
