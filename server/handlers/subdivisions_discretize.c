/* Discretize: a subdivision surface becomes a mesh resource whose vertices remember their places. A worker makes it, the registry's
 * writer stores it and answers. */
#include <stdlib.h>

#include "proto/discretization.h"
#include "server/call.h"
#include "server/handlers/description.h"
#include "server/handlers/handlers.h"
#include "server/handlers/making.h"
#include "server/handlers/request.h"
#include "server/handlers/subdivisions.h"
#include "server/handlers/vertex_places.h"
#include "server/reply.h"
#include "server/server.h"

#define BYTES_A_DISCRETIZATION ((size_t)16 << 20) /* that most take while they are made */
#define WHAT                   "the discretization"

struct discretizing {
    struct server_query query; /* first */
    struct proto_discretization wanted;
    struct gd_discretization fine;
    struct gd_detail detail;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT, for the discretization */
    struct server_making making;
};

static bool decode(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    uint32_t max_faces = (uint32_t)query->exchange->server->config.max_faces;
    return proto_discretization_decode(document, server_subdivision_of(query->surface)->surface, max_faces,
                                       &((struct discretizing *)query)->wanted, problem);
}

/* --- the mesh ----------------------------------------------------------------------------------------------------- */

static size_t bytes_of(const struct gd_discretization *fine)
{
    size_t a_vertex = sizeof *fine->polygons.positions + sizeof *fine->places + sizeof *fine->normals;
    return fine->polygons.position_count * a_vertex +
           gd_polygons_corner_count(&fine->polygons) * sizeof *fine->polygons.corners;
}

static enum gd_status make(void *user, const struct gd_control *control, size_t *kept)
{
    struct discretizing *discretizing = user;
    enum gd_status status =
        gd_discretize(server_subdivision_of(discretizing->query.surface)->surface, &discretizing->wanted.options,
                      control, &discretizing->fine, &discretizing->detail);
    if (!status) *kept = bytes_of(&discretizing->fine);
    return status;
}

static bool discretize(struct discretizing *discretizing, struct proto_problem *problem)
{
    const struct server_query *query = &discretizing->query;
    struct server_monitor monitor = server_query_monitor(query, 0, 0.3);
    const struct server_call call = {.make = make,
                                     .user = discretizing,
                                     .control = server_exchange_control(&monitor),
                                     .grant = BYTES_A_DISCRETIZATION};
    enum gd_status status = server_call_make(query->exchange->server, &call);
    discretizing->held = status ? 0 : bytes_of(&discretizing->fine);
    return !status || server_subdivision_fail(query, status, &discretizing->detail, WHAT, problem) == SERVER_QUERY_DONE;
}

/* With the attachment, of which the making has a copy of its own. */
static bool add_mesh(struct discretizing *discretizing, struct proto_problem *problem)
{
    const struct server_query *query = &discretizing->query;
    const struct gd_discretization *fine = &discretizing->fine;
    struct server_budget *budget = &query->exchange->server->budget;
    size_t cost = server_vertex_places_cost(fine->polygons.position_count);
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, cost))
        return server_budget_refuse(budget, WHAT, cost, problem);
    void *bytes = server_vertex_places_write(query->surface->record, fine);
    bool ok = bytes ? server_making_add(&discretizing->making, discretizing->wanted.mesh, &fine->polygons,
                                        &(struct server_attachment){bytes, cost}, problem)
                    : proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    free(bytes);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, cost);
    return ok;
}

/* By the writer, which answers as an upload does. */
static bool store(struct server_exchange *exchange)
{
    struct discretizing *discretizing = exchange->state;
    enum server_store_outcome outcome = server_making_store(&discretizing->making);
    if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
        server_request_fail(exchange, outcome);
        return true;
    }
    struct server_surface *mesh = discretizing->making.made[0].surface;
    const struct server_listed listed = {mesh->record, mesh};
    server_reply_header(exchange, "Location", "/v1/meshes/%s", mesh->record->name);
    server_description_reply(exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &listed);
    return true;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct discretizing *discretizing = (struct discretizing *)query;
    if (!discretize(discretizing, problem)) return SERVER_QUERY_FAILED;
    server_making_begin(&discretizing->making, query->exchange);
    if (!add_mesh(discretizing, problem)) return SERVER_QUERY_FAILED;
    (void)server_request_write(query->exchange, store);
    return SERVER_QUERY_PARKED;
}

static void release(struct server_query *query)
{
    struct discretizing *discretizing = (struct discretizing *)query;
    server_making_end(&discretizing->making);
    gd_discretization_free(&discretizing->fine);
    server_budget_give(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, discretizing->held);
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
