/* NURBS: evaluated at places, and the place nearest to a point of space. */
#include "server/query/handlers.h"

#include "proto/jet.h"
#include "server/api/smooth/smooth.h"
#include "server/surfaces/kinds.h"

static const struct gd_parametric *surface_of(const struct server_query *query)
{
    return server_nurbs_of(query->surface)->surface;
}

/* --- evaluate --------------------------------------------------------------------------------- */

struct evaluating {
    struct server_smooth_evaluation evaluation; /* first */
    struct proto_uvs places;
};

static enum gd_status write_jets(struct server_smooth_evaluation *evaluation, uint32_t first,
                                 uint32_t count, const struct gd_control *control)
{
    struct server_query *query = &evaluation->query;
    const double(*places)[2] = ((const struct evaluating *)evaluation)->places.items + first;
    enum gd_status status = GD_OK;
    (void)control; /* of so few */
    for (uint32_t i = 0; i < count && !status; i++) {
        struct gd_jet jet;
        status = gd_parametric_evaluate(surface_of(query), places[i][0], places[i][1], &jet);
        if (!status) proto_jet_encode(&query->draft, &jet, query->options.fields);
    }
    return status;
}

static bool decode_evaluate(struct server_query *query, const json_t *document,
                            struct proto_problem *problem)
{
    struct evaluating *evaluating = (struct evaluating *)query;
    if (!proto_jets_decode(document, surface_of(query), &evaluating->places, problem)) return false;
    evaluating->evaluation.count = evaluating->places.count;
    evaluating->evaluation.quick = 8; /* some microseconds each */
    evaluating->evaluation.round = 64;
    evaluating->evaluation.write = write_jets;
    return true;
}

static void release_evaluate(struct server_query *query)
{
    proto_uvs_free(&((struct evaluating *)query)->places);
}

static const struct server_query_kind evaluate_kind = {.name = "evaluate",
                                                       .size = sizeof(struct evaluating),
                                                       .fields = proto_jet_fields,
                                                       .decode = decode_evaluate,
                                                       .glance = server_smooth_evaluation_glance,
                                                       .solve = server_smooth_evaluation_solve,
                                                       .release = release_evaluate};

void server_handle_nurbs_evaluate(struct server_exchange *exchange)
{
    server_query_handle(exchange, &evaluate_kind);
}

/* --- nearest ---------------------------------------------------------------------------------- */

struct approaching {
    struct server_smooth_approach approach; /* first */
    struct gd_parametric_foot foot;
};

static enum gd_status find(struct server_smooth_approach *approach,
                           const struct gd_control *control)
{
    return gd_parametric_nearest(surface_of(&approach->query), approach->xyz, control,
                                 &((struct approaching *)approach)->foot, NULL);
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
    proto_foot_encode(writer, &((const struct approaching *)query)->foot, query->options.fields);
}

static const struct server_query_kind nearest_kind = {.name = "nearest",
                                                      .size = sizeof(struct approaching),
                                                      .fields = proto_foot_fields,
                                                      .decode = decode_nearest,
                                                      .solve = server_smooth_approach_solve,
                                                      .encode = encode_nearest};

void server_handle_nurbs_nearest(struct server_exchange *exchange)
{
    server_query_handle(exchange, &nearest_kind);
}
