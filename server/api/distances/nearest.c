/* Nearest: the point of the surface that a point of any form names. O(log n): always in the first
 * lane. */
#include "server/query/handlers.h"

#include "proto/nearest.h"
#include "server/query/query.h"

struct nearest {
    struct server_query query; /* first */
    struct gd_point point;
    double snap_distance;
};

static bool locate(struct server_query *query, const struct proto_nearest *wanted,
                   struct proto_problem *problem)
{
    struct nearest *nearest = (struct nearest *)query;
    return proto_point_locate(query->surface->mesh, &wanted->point, &nearest->point,
                              &nearest->snap_distance, problem);
}

static bool decode(struct server_query *query, const json_t *document,
                   struct proto_problem *problem)
{
    struct proto_nearest wanted;
    return proto_nearest_decode(document, &wanted, problem) && locate(query, &wanted, problem);
}

static bool parse(struct server_query *query, const struct proto_parameters *parameters,
                  struct proto_problem *problem)
{
    struct proto_nearest wanted;
    return proto_nearest_parse(parameters, &wanted, problem) && locate(query, &wanted, problem);
}

/* Nothing is left to do. */
static enum server_query_turn solve(struct server_query *query, struct proto_problem *problem)
{
    (void)query, (void)problem;
    return SERVER_QUERY_DONE;
}

static void encode(const struct server_query *query, struct proto_writer *writer)
{
    const struct nearest *nearest = (const struct nearest *)query;
    proto_nearest_encode(writer, query->surface->mesh, &nearest->point, nearest->snap_distance,
                         &query->options);
}

const struct server_query_kind server_query_nearest = {.name = "nearest",
                                                       .size = sizeof(struct nearest),
                                                       .fields = proto_point_fields,
                                                       .parameters = proto_nearest_parameters,
                                                       .decode = decode,
                                                       .parse = parse,
                                                       .glance = solve,
                                                       .solve = solve,
                                                       .encode = encode};

void server_handle_nearest(struct server_exchange *exchange)
{
    server_query_handle(exchange, &server_query_nearest);
}
