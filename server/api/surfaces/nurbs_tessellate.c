/* Tessellate: a NURBS surface becomes a mesh resource whose vertices remember their (u, v). A
 * worker makes it, the registry's writer stores it and answers. */
#include "server/query/handlers.h"

#include <stdlib.h>

#include "proto/tessellation.h"
#include "server/query/query.h"
#include "server/query/request.h"
#include "server/api/surfaces/vertex_origins.h"
#include "server/surfaces/kinds.h"
#include "server/query/api.h"

#define TESSELLATION_BYTES ((size_t)8 << 20) /* that most take while they are built */
#define WHAT               "the tessellation"

struct tessellating {
    struct server_query query; /* first */
    struct proto_tessellation wanted;
    struct gd_tessellation *tessellation;
    struct server_monitor monitor;
    struct gd_detail detail;
    struct server_derived_meshes making;
};

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    uint32_t max_faces = (uint32_t)query->exchange->host->api->config->max_faces;
    return proto_tessellation_decode(document, max_faces, &((struct tessellating *)query)->wanted,
                                     problem);
}

/* --- the mesh --------------------------------------------------------------------------------- */

static enum gd_status build(void *user, const struct gd_control *control, size_t *kept)
{
    struct tessellating *tessellating = user;
    enum gd_status status = gd_tessellation_build(
        server_nurbs_of(tessellating->query.surface)->surface, &tessellating->wanted.options,
        control, &tessellating->tessellation, &tessellating->detail);
    if (!status) *kept = gd_tessellation_memsize(tessellating->tessellation);
    return status;
}

static bool tessellate(struct tessellating *tessellating, struct proto_problem *problem)
{
    struct server_query *query = &tessellating->query;
    tessellating->monitor = server_query_monitor(query, 0, 0.5);
    enum gd_status status =
        server_query_call(query, &tessellating->monitor, build, tessellating, TESSELLATION_BYTES);
    if (!status) return true;
    server_query_fail(query, status, WHAT, problem);
    if (status != GD_BUDGET) proto_problem_from_status(problem, status, &tessellating->detail);
    if (status == GD_TOO_LARGE) proto_problem_limit(problem, GD_TESSELLATION_FACES_MAX);
    return false;
}

static bool store(struct server_exchange *exchange)
{
    return server_vertex_origins_store(exchange, &((struct tessellating *)exchange->state)->making);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct tessellating *tessellating = (struct tessellating *)query;
    if (!tessellate(tessellating, problem)) return SERVER_QUERY_FAILED;
    server_derived_meshes_begin(&tessellating->making, query->exchange);
    if (!server_vertex_parameters_make(query, tessellating->wanted.mesh, tessellating->tessellation,
                                       &tessellating->making, problem))
        return SERVER_QUERY_FAILED;
    (void)server_request_write(query->exchange, store);
    return SERVER_QUERY_PARKED;
}

static void release(struct server_query *query)
{
    struct tessellating *tessellating = (struct tessellating *)query;
    server_derived_meshes_free(&tessellating->making);
    gd_tessellation_release(tessellating->tessellation);
}

static const char *const no_fields[] = {NULL};

static const struct server_query_kind tessellate_kind = {.name = "tessellate",
                                                         .size = sizeof(struct tessellating),
                                                         .fields = no_fields,
                                                         .decode = decode,
                                                         .solve = solve,
                                                         .release = release};

void server_handle_nurbs_tessellate(struct server_exchange *exchange)
{
    server_query_handle(exchange, &tessellate_kind);
}
