/* Subdivision surfaces: evaluated at places, and the place nearest to a point of space. */
#include "server/handlers/subdivisions.h"

#include "proto/jet.h"
#include "proto/limit_jet.h"
#include "server/call.h"
#include "server/handlers/draft.h"
#include "server/handlers/handlers.h"
#include "server/server.h"

/* --- what all share ----------------------------------------------------------------------------------------------- */

enum server_query_turn server_subdivision_fail(const struct server_query *query, enum gd_status status,
                                               const struct gd_detail *detail, const char *what,
                                               struct proto_problem *problem)
{
    if (status == GD_BUDGET || !detail->text[0]) return server_query_fail(query, status, what, problem);
    if (status == GD_INTERNAL) status = GD_DEGENERATE_FACE;
    proto_problem_from_status(problem, status, detail);
    if (status == GD_TOO_LARGE) proto_problem_limit(problem, query->exchange->server->config.max_faces);
    return SERVER_QUERY_FAILED;
}

enum gd_status server_subdivision_discretization(const struct server_query *query, uint32_t level, double share,
                                                 struct server_discretization **out, struct gd_detail *detail)
{
    struct server_subdivision *subdivision = server_subdivision_of(query->surface);
    struct server_monitor monitor = server_query_monitor(query, 0, share);
    const struct server_discretization_request request = {.slot = &subdivision->slot,
                                                          .surface = subdivision->surface,
                                                          .level = level,
                                                          .monitor = &monitor,
                                                          .detail = detail};
    return server_discretizations_get(query->exchange->server->discretizations, &request, out);
}

/* --- evaluate ----------------------------------------------------------------------------------------------------- */

#define QUICK_PLACES 4   /* evaluated by the HTTP thread: some microseconds each, ten times that near a vertex */
#define ROUND        256 /* places of one call, between looks at the budget */

struct evaluating {
    struct server_query query; /* first */
    struct proto_limit_places places;
    struct gd_detail detail;
    struct server_draft draft;
};

static bool decode_evaluate(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    return proto_limit_jets_decode(document, server_subdivision_of(query->surface)->surface, &evaluating->places,
                                   problem);
}

static enum gd_status write_round(struct evaluating *evaluating, uint32_t first, uint32_t count)
{
    const struct server_query *query = &evaluating->query;
    struct server_monitor monitor =
        server_query_monitor(query, (double)first / evaluating->places.count, (double)count / evaluating->places.count);
    const struct gd_control control = server_exchange_control(&monitor);
    struct gd_limit_jet jets[ROUND];
    enum gd_status status =
        gd_limit_evaluate_many(server_subdivision_of(query->surface)->surface, evaluating->places.items + first, count,
                               &control, jets, &evaluating->detail);
    if (status) return status;
    for (uint32_t i = 0; i < count; i++)
        proto_limit_jet_encode(&evaluating->draft.writer, &jets[i], query->options.fields);
    return server_draft_hold(&evaluating->draft);
}

static enum gd_status write_jets(struct evaluating *evaluating)
{
    uint32_t count = evaluating->places.count;
    enum gd_status status = GD_OK;
    proto_write_key(&evaluating->draft.writer, "points");
    proto_write_array_begin(&evaluating->draft.writer);
    for (uint32_t i = 0; i < count && !status; i += ROUND)
        status = write_round(evaluating, i, count - i < ROUND ? count - i : ROUND);
    proto_write_array_end(&evaluating->draft.writer);
    return status;
}

static enum server_query_turn solve_evaluate(struct server_query *query, struct proto_problem *problem)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    struct proto_writer *writer = &evaluating->draft.writer;
    server_draft_begin(&evaluating->draft, query);
    proto_write_object_begin(writer);
    enum gd_status status = write_jets(evaluating);
    proto_write_object_end(writer);
    if (status) return server_subdivision_fail(query, status, &evaluating->detail, "the answer", problem);
    return proto_writer_check(writer, problem) ? SERVER_QUERY_DONE : SERVER_QUERY_FAILED;
}

static enum server_query_turn glance_evaluate(struct server_query *query, struct proto_problem *problem)
{
    if (((struct evaluating *)query)->places.count > QUICK_PLACES) return SERVER_QUERY_AGAIN;
    return solve_evaluate(query, problem);
}

static void encode_evaluate(const struct server_query *query, struct proto_writer *writer)
{
    server_draft_encode(&((const struct evaluating *)query)->draft, writer);
}

static void release_evaluate(struct server_query *query)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    server_draft_end(&evaluating->draft);
    proto_limit_places_free(&evaluating->places);
}

static const struct server_query_kind evaluate_kind = {.name = "evaluate",
                                                       .size = sizeof(struct evaluating),
                                                       .fields = proto_limit_jet_fields,
                                                       .decode = decode_evaluate,
                                                       .glance = glance_evaluate,
                                                       .solve = solve_evaluate,
                                                       .encode = encode_evaluate,
                                                       .release = release_evaluate};

void server_handle_subdivision_evaluate(struct server_exchange *exchange)
{
    server_query_handle(exchange, &evaluate_kind);
}

/* --- nearest ------------------------------------------------------------------------------------------------------ */

#define APPROACH_BYTES ((size_t)1 << 20)

struct approaching {
    struct server_query query; /* first */
    struct gd_vec3 xyz;
    struct gd_limit_foot foot;
    struct gd_detail detail;
};

static bool decode_nearest(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    return proto_foot_decode(document, &((struct approaching *)query)->xyz, problem);
}

static enum gd_status approach(void *user, const struct gd_control *control, size_t *kept)
{
    struct approaching *approaching = user;
    (void)kept; /* nothing */
    return gd_limit_nearest(server_subdivision_of(approaching->query.surface)->surface, approaching->xyz, control,
                            &approaching->foot, &approaching->detail);
}

static enum server_query_turn solve_nearest(struct server_query *query, struct proto_problem *problem)
{
    struct approaching *approaching = (struct approaching *)query;
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct server_call call = {
        .make = approach, .user = query, .control = server_exchange_control(&monitor), .grant = APPROACH_BYTES};
    enum gd_status status = server_call_make(query->exchange->server, &call);
    if (status) return server_subdivision_fail(query, status, &approaching->detail, "the search", problem);
    return SERVER_QUERY_DONE;
}

static void encode_nearest(const struct server_query *query, struct proto_writer *writer)
{
    proto_limit_foot_encode(writer, &((const struct approaching *)query)->foot, query->options.fields);
}

static const struct server_query_kind nearest_kind = {.name = "nearest",
                                                      .size = sizeof(struct approaching),
                                                      .fields = proto_limit_foot_fields,
                                                      .decode = decode_nearest,
                                                      .solve = solve_nearest,
                                                      .encode = encode_nearest};

void server_handle_subdivision_nearest(struct server_exchange *exchange)
{
    server_query_handle(exchange, &nearest_kind);
}
