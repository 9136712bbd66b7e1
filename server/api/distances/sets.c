/* Sets: distances of points to a set. */
#include "server/query/handlers.h"

#include "server/query/evaluation.h"

static bool locate(struct server_evaluation *evaluation, struct proto_set *set,
                   const struct proto_evaluation *wanted, struct proto_problem *problem)
{
    return server_field_query_of_set(&evaluation->field, set, 0, problem) &&
           server_evaluation_locate(evaluation, wanted, problem);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct proto_set set;
    struct proto_evaluation wanted;
    if (!proto_evaluation_decode_with_set(document, &set, &wanted, problem)) return false;
    bool ok = locate((struct server_evaluation *)query, &set, &wanted, problem);
    proto_evaluation_free(&wanted);
    proto_set_free(&set);
    return ok;
}

const struct server_query_kind server_query_distance_to_set = {
    .name = "distance-to-set",
    .size = sizeof(struct server_evaluation),
    .fields = proto_distance_to_set_fields,
    .decode = decode,
    .glance = server_field_query_glance,
    .join = server_field_query_join,
    .solve = server_field_query_solve,
    .release = server_evaluation_release};

void server_handle_distance_to_set(struct server_exchange *exchange)
{
    server_query_handle(exchange, &server_query_distance_to_set);
}
