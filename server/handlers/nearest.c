/* Nearest: the point of the surface that a point of any form names. O(log n): always in the first lane. */
#include "server/handlers/handlers.h"

#include "proto/nearest.h"
#include "server/handlers/description.h"
#include "server/handlers/request.h"
#include "server/reply.h"

static bool read_query(struct server_exchange *exchange, struct proto_options *options, struct proto_nearest *query,
                       struct proto_problem *problem)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    bool has_body = exchange->match.route->has_body;
    if (!proto_options_parse(&parameters, proto_point_fields, has_body ? NULL : proto_nearest_parameters, options,
                             problem))
        return false;
    if (!has_body) return proto_nearest_parse(&parameters, query, problem);
    json_t *document = server_request_document(exchange, problem);
    if (!document) return false;
    bool ok = proto_nearest_decode(document, query, problem);
    json_decref(document);
    return ok;
}

static void reply_nearest(struct server_exchange *exchange, const struct server_surface *surface)
{
    struct proto_options options;
    struct proto_nearest query;
    struct proto_problem problem;
    struct gd_point point;
    struct proto_writer writer;
    double snap_distance;
    if (!read_query(exchange, &options, &query, &problem) ||
        !proto_point_locate(surface->mesh, &query.point, &point, &snap_distance, &problem)) {
        server_reply_problem(exchange, &problem);
        return;
    }
    proto_writer_init(&writer, SERVER_REPLY_MOST);
    proto_nearest_encode(&writer, surface->mesh, &point, snap_distance, &options);
    server_description_tag(exchange, surface->record);
    server_reply_json(exchange, 200, &writer);
}

void server_handle_nearest(struct server_exchange *exchange)
{
    if (!server_reply_accepts_json(exchange)) return;
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    reply_nearest(exchange, surface);
    server_surface_release(surface);
}
