/* Sampling: farthest points, one after the other, by a worker. */
#include "server/query/handlers.h"

#include <math.h>
#include <stdlib.h>

#include "gd/sampling.h"
#include "proto/sampling.h"
#include "server/query/field_build.h"
#include "server/query/query.h"
#include "server/query/api.h"
#include "server/work/executor.h"

#define BYTES_A_POINT 512 /* of the points, their radii, and the answer's text */
#define WHAT          "the sampling"

struct sampling {
    struct server_query query; /* first */
    uint32_t count;
    bool has_start;
    struct gd_point start;
    double snap; /* how far the start was moved; NAN: not at all */
    struct gd_point *points;
    double *radii;
};

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct sampling *sampling = (struct sampling *)query;
    struct proto_sampling wanted;
    if (!proto_sampling_decode(document, &wanted, problem)) return false;
    sampling->count = wanted.count;
    sampling->has_start = wanted.has_start;
    sampling->snap = NAN;
    return !wanted.has_start || proto_point_locate(query->surface->mesh, &wanted.start,
                                                   &sampling->start, &sampling->snap, problem);
}

/* Memory for the answer, and bytes of the budget. */
static enum gd_status reserve(struct sampling *sampling)
{
    enum gd_status status =
        server_query_take(&sampling->query, (size_t)sampling->count * BYTES_A_POINT);
    if (status) return status;
    sampling->points = malloc(sampling->count * sizeof *sampling->points);
    sampling->radii = malloc(sampling->count * sizeof *sampling->radii);
    return sampling->points && sampling->radii ? GD_OK : GD_NO_MEMORY;
}

struct choosing {
    struct sampling *sampling;
    const struct gd_executor *executor;
};

static enum gd_status choose(void *user, const struct gd_control *control, size_t *kept)
{
    const struct choosing *choosing = user;
    struct sampling *sampling = choosing->sampling;
    *kept = 0;
    return gd_sampling_farthest(
        sampling->query.surface->mesh, sampling->has_start ? &sampling->start : NULL,
        sampling->count, control, choosing->executor, sampling->points, sampling->radii, NULL);
}

static enum gd_status choose_points(struct sampling *sampling)
{
    struct server_host *host = sampling->query.exchange->host;
    struct server_monitor part = server_query_monitor(&sampling->query, 0, 1);
    struct choosing choosing = {
        sampling,
        server_executor_start(host->workers, 2, sampling->query.exchange->job.deadline_ns)};
    enum gd_status status =
        server_query_call(&sampling->query, &part, choose, &choosing,
                          server_field_build_grant(sampling->query.surface->mesh));
    server_executor_stop(choosing.executor);
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct sampling *sampling = (struct sampling *)query;
    enum gd_status status = reserve(sampling);
    if (!status) status = choose_points(sampling);
    return status ? server_query_fail(query, status, WHAT, problem) : SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct sampling *sampling = (const struct sampling *)query;
    proto_sampling_encode(writer, query->surface->mesh, sampling->points, sampling->radii,
                          sampling->count, sampling->snap, &query->options);
}

static void release(struct server_query *query)
{
    struct sampling *sampling = (struct sampling *)query;
    free(sampling->points);
    free(sampling->radii);
}

static const struct server_query_kind sampling_kind = {.name = "farthest-points",
                                                       .size = sizeof(struct sampling),
                                                       .fields = proto_sampling_fields,
                                                       .decode = decode,
                                                       .solve = solve,
                                                       .encode = encode,
                                                       .release = release};

void server_handle_farthest_points(struct server_exchange *exchange)
{
    server_query_handle(exchange, &sampling_kind);
}
