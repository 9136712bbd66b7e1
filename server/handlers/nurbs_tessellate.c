/* Tessellate: a NURBS surface becomes a mesh resource whose vertices remember their (u, v). A worker makes it, the registry's
 * writer stores it and answers. */
#include "server/handlers/handlers.h"

#include <stdlib.h>

#include "proto/tessellation.h"
#include "server/call.h"
#include "server/handlers/description.h"
#include "server/handlers/making.h"
#include "server/handlers/query.h"
#include "server/handlers/request.h"
#include "server/handlers/vertex_parameters.h"
#include "server/nurbs.h"
#include "server/reply.h"
#include "server/server.h"

#define TESSELLATION_BYTES ((size_t)8 << 20) /* that most take while they are built */
#define WHAT               "the tessellation"

struct tessellating {
    struct server_query query; /* first */
    struct proto_tessellation wanted;
    struct gd_tessellation *tessellation;
    struct server_monitor monitor;
    struct gd_detail detail;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT, for the tessellation */
    struct server_making making;
};

static bool decode(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    uint32_t max_faces = (uint32_t)query->exchange->server->config.max_faces;
    return proto_tessellation_decode(document, max_faces, &((struct tessellating *)query)->wanted, problem);
}

/* --- the mesh ----------------------------------------------------------------------------------------------------- */

static enum gd_status build(void *user, const struct gd_control *control, size_t *kept)
{
    struct tessellating *tessellating = user;
    enum gd_status status =
        gd_tessellation_build(server_nurbs_of(tessellating->query.surface)->surface, &tessellating->wanted.options,
                              control, &tessellating->tessellation, &tessellating->detail);
    if (!status) *kept = gd_tessellation_memsize(tessellating->tessellation);
    return status;
}

static bool tessellate(struct tessellating *tessellating, struct proto_problem *problem)
{
    const struct server_query *query = &tessellating->query;
    tessellating->monitor = server_query_monitor(query, 0, 0.5);
    const struct server_call call = {.make = build,
                                     .user = tessellating,
                                     .control = server_exchange_control(&tessellating->monitor),
                                     .grant = TESSELLATION_BYTES};
    enum gd_status status = server_call_make(query->exchange->server, &call);
    if (!status) {
        tessellating->held = gd_tessellation_memsize(tessellating->tessellation);
        return true;
    }
    server_query_fail(query, status, WHAT, problem);
    if (status != GD_BUDGET) proto_problem_from_status(problem, status, &tessellating->detail);
    if (status == GD_TOO_LARGE) proto_problem_limit(problem, GD_TESSELLATION_FACES_MAX);
    return false;
}

/* With the attachment, of which the making has a copy of its own. */
static bool add_mesh(struct tessellating *tessellating, struct proto_problem *problem)
{
    const struct server_query *query = &tessellating->query;
    struct server_budget *budget = &query->exchange->server->budget;
    size_t cost = server_vertex_parameters_cost(tessellating->tessellation), size;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, cost))
        return server_budget_refuse(budget, WHAT, cost, problem);
    void *bytes = server_vertex_parameters_write(query->surface->record, tessellating->tessellation, &size);
    bool ok = bytes ? server_making_add(&tessellating->making, tessellating->wanted.mesh,
                                        gd_tessellation_polygons(tessellating->tessellation),
                                        &(struct server_attachment){bytes, size}, problem)
                    : proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    free(bytes);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, cost);
    return ok;
}

/* By the writer, which answers as an upload does. */
static bool store(struct server_exchange *exchange)
{
    struct tessellating *tessellating = exchange->state;
    enum server_store_outcome outcome = server_making_store(&tessellating->making);
    if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
        server_request_fail(exchange, outcome);
        return true;
    }
    struct server_surface *mesh = tessellating->making.made[0].surface;
    const struct server_listed listed = {mesh->record, mesh};
    server_reply_header(exchange, "Location", "/v1/meshes/%s", mesh->record->name);
    server_description_reply(exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &listed);
    return true;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct tessellating *tessellating = (struct tessellating *)query;
    if (!tessellate(tessellating, problem)) return SERVER_QUERY_FAILED;
    server_making_begin(&tessellating->making, query->exchange);
    if (!add_mesh(tessellating, problem)) return SERVER_QUERY_FAILED;
    (void)server_request_write(query->exchange, store);
    return SERVER_QUERY_PARKED;
}

static void release(struct server_query *query)
{
    struct tessellating *tessellating = (struct tessellating *)query;
    server_making_end(&tessellating->making);
    gd_tessellation_release(tessellating->tessellation);
    server_budget_give(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, tessellating->held);
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
