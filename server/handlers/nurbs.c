/* NURBS: evaluated at places, and the place nearest to a point of space. */
#include "server/handlers/handlers.h"

#include "proto/jet.h"
#include "server/call.h"
#include "server/handlers/draft.h"
#include "server/handlers/query.h"
#include "server/nurbs.h"
#include "server/server.h"

/* --- evaluate ----------------------------------------------------------------------------------------------------- */

#define QUICK_PLACES 8  /* evaluated by the HTTP thread: some microseconds each */
#define ROUND        64 /* places between looks at clock and budget */

struct evaluating {
    struct server_query query; /* first */
    struct proto_uvs places;
    struct server_draft draft;
};

static bool decode_evaluate(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    return proto_jets_decode(document, server_nurbs_of(query->surface)->surface, &evaluating->places, problem);
}

static enum gd_status write_jets(struct evaluating *evaluating)
{
    const struct server_query *query = &evaluating->query;
    const struct gd_parametric *surface = server_nurbs_of(query->surface)->surface;
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct gd_control control = server_exchange_control(&monitor);
    uint32_t count = evaluating->places.count;
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        struct gd_jet jet;
        const double *uv = evaluating->places.items[i];
        status = gd_parametric_evaluate(surface, uv[0], uv[1], &jet);
        if (!status) proto_jet_encode(&evaluating->draft.writer, &jet, query->options.fields);
        if (!status && i % ROUND == 0) status = gd_control_check(&control, (double)i / count);
        if (!status && i % ROUND == 0) status = server_draft_hold(&evaluating->draft);
    }
    return status ? status : server_draft_hold(&evaluating->draft);
}

static enum server_query_turn solve_evaluate(struct server_query *query, struct proto_problem *problem)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    struct proto_writer *writer = &evaluating->draft.writer;
    server_draft_begin(&evaluating->draft, query);
    proto_write_object_begin(writer);
    proto_write_key(writer, "points");
    proto_write_array_begin(writer);
    enum gd_status status = write_jets(evaluating);
    proto_write_array_end(writer);
    proto_write_object_end(writer);
    if (status) return server_query_fail(query, status, "the answer", problem);
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
    proto_uvs_free(&evaluating->places);
}

static const struct server_query_kind evaluate_kind = {.name = "evaluate",
                                                       .size = sizeof(struct evaluating),
                                                       .fields = proto_jet_fields,
                                                       .decode = decode_evaluate,
                                                       .glance = glance_evaluate,
                                                       .solve = solve_evaluate,
                                                       .encode = encode_evaluate,
                                                       .release = release_evaluate};

void server_handle_nurbs_evaluate(struct server_exchange *exchange)
{
    server_query_handle(exchange, &evaluate_kind);
}

/* --- nearest ------------------------------------------------------------------------------------------------------ */

#define APPROACH_BYTES ((size_t)1 << 20)

struct approaching {
    struct server_query query; /* first */
    struct gd_vec3 xyz;
    struct gd_parametric_foot foot;
};

static bool decode_nearest(struct server_query *query, const json_t *document, struct proto_problem *problem)
{
    return proto_foot_decode(document, &((struct approaching *)query)->xyz, problem);
}

static enum gd_status approach(void *user, const struct gd_control *control, size_t *kept)
{
    struct approaching *approaching = user;
    (void)kept; /* nothing */
    return gd_parametric_nearest(server_nurbs_of(approaching->query.surface)->surface, approaching->xyz, control,
                                 &approaching->foot, NULL);
}

static enum server_query_turn solve_nearest(struct server_query *query, struct proto_problem *problem)
{
    struct server_monitor monitor = server_query_monitor(query, 0, 1);
    const struct server_call call = {
        .make = approach, .user = query, .control = server_exchange_control(&monitor), .grant = APPROACH_BYTES};
    enum gd_status status = server_call_make(query->exchange->server, &call);
    return status ? server_query_fail(query, status, "the search", problem) : SERVER_QUERY_DONE;
}

static void encode_nearest(const struct server_query *query, struct proto_writer *writer)
{
    proto_foot_encode(writer, &((const struct approaching *)query)->foot, query->options.fields);
}

static const struct server_query_kind nearest_kind = {.name = "nearest",
                                                      .size = sizeof(struct approaching),
                                                      .fields = proto_foot_fields,
                                                      .decode = decode_nearest,
                                                      .solve = solve_nearest,
                                                      .encode = encode_nearest};

void server_handle_nurbs_nearest(struct server_exchange *exchange)
{
    server_query_handle(exchange, &nearest_kind);
}
