/* Distance and shortest path between two places of a subdivision surface, by a worker. */
#include "proto/limit_pair.h"
#include "server/call.h"
#include "server/handlers/draft.h"
#include "server/handlers/handlers.h"
#include "server/handlers/subdivisions.h"
#include "server/server.h"

#define BYTES_AN_EDGE  224               /* as a search on any mesh (pair_search.c) */
#define BYTES_A_SEARCH ((size_t)4 << 20) /* with the traces that straighten the path */
#define BUILD_SHARE    0.3               /* of the work, if there is no discretization yet */
#define WHAT           "the search"

struct pairing {
    struct server_query query; /* first */
    struct proto_limit_pair wanted;
    struct server_discretization *fine;
    struct gd_vec3 ends[2];
    struct gd_limit_shortest found;
    struct gd_detail detail;
    struct server_draft draft;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT, for what was found */
};

static void release(struct server_query *query)
{
    struct pairing *pairing = (struct pairing *)query;
    server_draft_end(&pairing->draft);
    gd_limit_shortest_free(&pairing->found);
    server_budget_give(&query->exchange->server->budget, SERVER_BUDGET_FLIGHT, pairing->held);
    server_discretization_release(pairing->fine);
}

static bool decode(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    return proto_limit_pair_decode(document, server_subdivision_of(query->surface)->surface,
                                   &((struct pairing *)query)->wanted, problem);
}

/* --- the search --------------------------------------------------------------------------------------------------- */

static size_t found_bytes(const struct gd_limit_shortest *found)
{
    return 2 * (size_t)found->step_count * sizeof *found->steps;
}

static enum gd_status find(void *user, const struct gd_control *control, size_t *kept)
{
    struct pairing *pairing = user;
    enum gd_status status = gd_limit_shortest_find(pairing->fine->mesh, &pairing->wanted.from, &pairing->wanted.to,
                                                   control, &pairing->found, &pairing->detail);
    if (!status) *kept = found_bytes(&pairing->found);
    return status;
}

static enum gd_status search(struct pairing *pairing)
{
    const struct server_query *query = &pairing->query;
    struct server_monitor monitor = server_query_monitor(query, BUILD_SHARE, 1 - BUILD_SHARE);
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(pairing->fine->mesh);
    const struct server_call call = {.make = find,
                                     .user = pairing,
                                     .control = server_exchange_control(&monitor),
                                     .grant = BYTES_A_SEARCH + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE};
    enum gd_status status = server_call_make(query->exchange->server, &call);
    pairing->held = status ? 0 : found_bytes(&pairing->found);
    return status;
}

static enum gd_status locate_ends(struct pairing *pairing)
{
    const struct gd_subdivision *surface = server_subdivision_of(pairing->query.surface)->surface;
    const struct gd_limit_point places[2] = {pairing->wanted.from, pairing->wanted.to};
    struct gd_limit_jet jets[2];
    enum gd_status status = gd_limit_evaluate_many(surface, places, 2, NULL, jets, &pairing->detail);
    for (int i = 0; i < 2 && !status; i++) pairing->ends[i] = jets[i].position;
    return status;
}

static enum gd_status write_answer(struct pairing *pairing)
{
    server_draft_begin(&pairing->draft, &pairing->query);
    proto_limit_pair_encode(&pairing->draft.writer, &pairing->wanted, pairing->ends, &pairing->found,
                            &pairing->query.options);
    return server_draft_hold(&pairing->draft);
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct pairing *pairing = (struct pairing *)query;
    enum gd_status status =
        server_subdivision_discretization(query, pairing->wanted.level, BUILD_SHARE, &pairing->fine, &pairing->detail);
    if (!status) status = locate_ends(pairing);
    if (!status) status = search(pairing);
    if (!status) status = write_answer(pairing);
    if (status) return server_subdivision_fail(query, status, &pairing->detail, WHAT, problem);
    return proto_writer_check(&pairing->draft.writer, problem) ? SERVER_QUERY_DONE : SERVER_QUERY_FAILED;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    server_draft_encode(&((const struct pairing *)query)->draft, writer);
}

#define PAIR_STEPS                                                                                                     \
    .size = sizeof(struct pairing), .decode = decode, .solve = solve, .encode = encode, .release = release

static const struct server_query_kind distance_kind = {
    .name = "distance", .fields = proto_limit_distance_fields, PAIR_STEPS};
static const struct server_query_kind path_kind = {.name = "path", .fields = proto_limit_path_fields, PAIR_STEPS};

void server_handle_subdivision_distance(struct server_exchange *exchange)
{
    server_query_handle(exchange, &distance_kind);
}

void server_handle_subdivision_path(struct server_exchange *exchange)
{
    server_query_handle(exchange, &path_kind);
}
