/* Discretize: a subdivision surface becomes a mesh resource whose vertices remember their places. A
 * worker makes it, the registry's writer stores it and answers. */
#include <stdlib.h>

#include "proto/discretization.h"
#include "server/query/handlers.h"
#include "server/query/request.h"
#include "server/api/surfaces/subdivisions.h"
#include "server/api/surfaces/vertex_origins.h"
#include "server/query/api.h"

#define BYTES_A_DISCRETIZATION ((size_t)16 << 20) /* that most take while they are made */
#define WHAT                   "the discretization"

struct discretizing {
    struct server_query query; /* first */
    struct proto_discretization wanted;
    struct gd_discretization fine;
    struct gd_detail detail;
    struct server_derived_meshes making;
};

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    uint32_t max_faces = (uint32_t)query->exchange->host->api->config->max_faces;
    return proto_discretization_decode(document, server_subdivision_of(query->surface)->surface,
                                       max_faces, &((struct discretizing *)query)->wanted, problem);
}

/* --- the mesh --------------------------------------------------------------------------------- */

static size_t bytes_of(const struct gd_discretization *fine)
{
    size_t a_vertex =
        sizeof *fine->polygons.positions + sizeof *fine->places + sizeof *fine->normals;
    return fine->polygons.position_count * a_vertex +
           gd_polygons_corner_count(&fine->polygons) * sizeof *fine->polygons.corners;
}

static enum gd_status make(void *user, const struct gd_control *control, size_t *kept)
{
    struct discretizing *discretizing = user;
    enum gd_status status = gd_discretize(
        server_subdivision_of(discretizing->query.surface)->surface, &discretizing->wanted.options,
        control, &discretizing->fine, &discretizing->detail);
    if (!status) *kept = bytes_of(&discretizing->fine);
    return status;
}

static bool discretize(struct discretizing *discretizing, struct proto_problem *problem)
{
    struct server_query *query = &discretizing->query;
    struct server_monitor monitor = server_query_monitor(query, 0, 0.3);
    enum gd_status status =
        server_query_call(query, &monitor, make, discretizing, BYTES_A_DISCRETIZATION);
    return !status || server_smooth_fail(query, status, &discretizing->detail, WHAT, problem) ==
                          SERVER_QUERY_DONE;
}

static bool store(struct server_exchange *exchange)
{
    return server_vertex_origins_store(exchange, &((struct discretizing *)exchange->state)->making);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct discretizing *discretizing = (struct discretizing *)query;
    if (!discretize(discretizing, problem)) return SERVER_QUERY_FAILED;
    server_derived_meshes_begin(&discretizing->making, query->exchange);
    if (!server_vertex_places_make(query, discretizing->wanted.mesh, &discretizing->fine,
                                   &discretizing->making, problem))
        return SERVER_QUERY_FAILED;
    (void)server_request_write(query->exchange, store);
    return SERVER_QUERY_PARKED;
}

static void release(struct server_query *query)
{
    struct discretizing *discretizing = (struct discretizing *)query;
    server_derived_meshes_free(&discretizing->making);
    gd_discretization_free(&discretizing->fine);
}

static const char *const no_fields[] = {NULL};

static const struct server_query_kind discretize_kind = {.name = "discretize",
                                                         .size = sizeof(struct discretizing),
                                                         .fields = no_fields,
                                                         .decode = decode,
                                                         .solve = solve,
                                                         .release = release};

void server_handle_subdivision_discretize(struct server_exchange *exchange)
{
    server_query_handle(exchange, &discretize_kind);
}
