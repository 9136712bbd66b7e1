/* Subdivision surfaces: evaluated at places, and the place nearest to a point of space. */
#include "server/api/surfaces/subdivisions.h"

#include "proto/limit_jet.h"
#include "server/query/handlers.h"
#include "server/query/api.h"

static const struct gd_subdivision *surface_of(const struct server_query *query)
{
    return server_subdivision_of(query->surface)->surface;
}

enum gd_status server_subdivision_discretization(const struct server_query *query, uint32_t level,
                                                 double share, struct server_discretization **out,
                                                 struct gd_detail *detail)
{
    struct server_subdivision *subdivision = server_subdivision_of(query->surface);
    struct server_monitor monitor = server_query_monitor(query, 0, share);
    const struct server_discretization_request request = {.slot = &subdivision->slot,
                                                          .surface = subdivision->surface,
                                                          .level = level,
                                                          .control =
                                                              server_exchange_control(&monitor),
                                                          .detail = detail};
    return server_discretizations_get(query->exchange->host->api->discretizations, &request, out);
}

/* --- evaluate --------------------------------------------------------------------------------- */

#define ROUND 256

struct evaluating {
    struct server_smooth_evaluation evaluation; /* first */
    struct proto_limit_places places;
};

static enum gd_status write_jets(struct server_smooth_evaluation *evaluation, uint32_t first,
                                 uint32_t count, const struct gd_control *control)
{
    struct server_query *query = &evaluation->query;
    const struct gd_limit_point *places =
        ((const struct evaluating *)evaluation)->places.items + first;
    struct gd_limit_jet jets[ROUND];
    enum gd_status status = gd_limit_evaluate_many(surface_of(query), places, count, control, jets,
                                                   &evaluation->detail);
    for (uint32_t i = 0; i < count && !status; i++)
        proto_limit_jet_encode(&query->draft, &jets[i], query->options.fields);
    return status;
}

static bool decode_evaluate(struct server_query *query, const json_t *document,
                            struct proto_problem *problem)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    if (!proto_limit_jets_decode(document, surface_of(query), &evaluating->places, problem))
        return false;
    evaluating->evaluation.count = evaluating->places.count;
    evaluating->evaluation.quick = 4; /* some microseconds each, ten times that near a vertex */
    evaluating->evaluation.round = ROUND;
    evaluating->evaluation.write = write_jets;
    return true;
}

static void release_evaluate(struct server_query *query)
{
    proto_limit_places_free(&((struct evaluating *)query)->places);
}

static const struct server_query_kind evaluate_kind = {.name = "evaluate",
                                                       .size = sizeof(struct evaluating),
                                                       .fields = proto_limit_jet_fields,
                                                       .decode = decode_evaluate,
                                                       .glance = server_smooth_evaluation_glance,
                                                       .solve = server_smooth_evaluation_solve,
                                                       .release = release_evaluate};

void server_handle_subdivision_evaluate(struct server_exchange *exchange)
{
    server_query_handle(exchange, &evaluate_kind);
}

/* --- nearest ---------------------------------------------------------------------------------- */

struct approaching {
    struct server_smooth_approach approach; /* first */
    struct gd_limit_foot foot;
};

static enum gd_status find(struct server_smooth_approach *approach,
                           const struct gd_control *control)
{
    return gd_limit_nearest(surface_of(&approach->query), approach->xyz, control,
                            &((struct approaching *)approach)->foot, &approach->detail);
}

static bool decode_nearest(struct server_query *query, const json_t *document,
                           struct proto_problem *problem)
{
    struct server_smooth_approach *approach = (struct server_smooth_approach *)query;
    approach->find = find;
    return server_smooth_approach_decode(approach, document, problem);
}

static void encode_nearest(const struct server_query *query, struct proto_writer *writer)
{
    proto_limit_foot_encode(writer, &((const struct approaching *)query)->foot,
                            query->options.fields);
}

static const struct server_query_kind nearest_kind = {.name = "nearest",
                                                      .size = sizeof(struct approaching),
                                                      .fields = proto_limit_foot_fields,
                                                      .decode = decode_nearest,
                                                      .solve = server_smooth_approach_solve,
                                                      .encode = encode_nearest};

void server_handle_subdivision_nearest(struct server_exchange *exchange)
{
    server_query_handle(exchange, &nearest_kind);
}
