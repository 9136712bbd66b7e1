/* Distance and shortest path between two places of a subdivision surface, by a worker. */
#include "proto/limit_pair.h"
#include "server/query/handlers.h"
#include "server/api/surfaces/subdivisions.h"

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
};

static void release(struct server_query *query)
{
    struct pairing *pairing = (struct pairing *)query;
    gd_limit_shortest_free(&pairing->found);
    server_discretization_release(pairing->fine);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    return proto_limit_pair_decode(document, server_subdivision_of(query->surface)->surface,
                                   &((struct pairing *)query)->wanted, problem);
}

/* --- the search ------------------------------------------------------------------------------- */

static enum gd_status find(void *user, const struct gd_control *control, size_t *kept)
{
    struct pairing *pairing = user;
    enum gd_status status =
        gd_limit_shortest_find(pairing->fine->mesh, &pairing->wanted.from, &pairing->wanted.to,
                               control, &pairing->found, &pairing->detail);
    if (!status) *kept = 2 * (size_t)pairing->found.step_count * sizeof *pairing->found.steps;
    return status;
}

static enum gd_status search(struct pairing *pairing)
{
    struct server_monitor monitor =
        server_query_monitor(&pairing->query, BUILD_SHARE, 1 - BUILD_SHARE);
    const struct gd_mesh *mesh = gd_limit_mesh_mesh(pairing->fine->mesh);
    return server_query_call(&pairing->query, &monitor, find, pairing,
                             BYTES_A_SEARCH + (size_t)gd_mesh_summary(mesh)->edges * BYTES_AN_EDGE);
}

static enum gd_status locate_ends(struct pairing *pairing)
{
    const struct gd_subdivision *surface = server_subdivision_of(pairing->query.surface)->surface;
    const struct gd_limit_point places[2] = {pairing->wanted.from, pairing->wanted.to};
    struct gd_limit_jet jets[2];
    enum gd_status status =
        gd_limit_evaluate_many(surface, places, 2, NULL, jets, &pairing->detail);
    for (int i = 0; i < 2 && !status; i++) pairing->ends[i] = jets[i].position;
    return status;
}

static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    struct pairing *pairing = (struct pairing *)query;
    enum gd_status status = server_subdivision_discretization(
        query, pairing->wanted.level, BUILD_SHARE, &pairing->fine, &pairing->detail);
    if (!status) status = locate_ends(pairing);
    if (!status) status = search(pairing);
    if (status) return server_smooth_fail(query, status, &pairing->detail, WHAT, problem);
    proto_limit_pair_encode(&query->draft, &pairing->wanted, pairing->ends, &pairing->found,
                            &query->options);
    return server_query_end_draft(query, GD_OK, "the answer", problem);
}

#define PAIR_STEPS                                                                                 \
    .size = sizeof(struct pairing), .decode = decode, .solve = solve, .release = release

static const struct server_query_kind distance_kind = {
    .name = "distance", .fields = proto_limit_distance_fields, PAIR_STEPS};
static const struct server_query_kind path_kind = {
    .name = "path", .fields = proto_limit_path_fields, PAIR_STEPS};

void server_handle_subdivision_distance(struct server_exchange *exchange)
{
    server_query_handle(exchange, &distance_kind);
}

void server_handle_subdivision_path(struct server_exchange *exchange)
{
    server_query_handle(exchange, &path_kind);
}
