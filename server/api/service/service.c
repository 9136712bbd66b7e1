/* The daemon's descriptions of itself, and its static pages. */
#include "server/query/handlers.h"

#include "proto/http/service.h"
#include "server/base/version.h"
#include "server/exchange/reply.h"
#include "server/jobs/batch_runner.h"
#include "server/query/api.h"
#include "server/query/request.h"

#define ANSWER_MOST ((size_t)16 << 20) /* bytes */

static void reply_asset(struct server_exchange *exchange, const char *path)
{
    const struct proto_asset *asset = proto_asset_find(proto_assets, proto_asset_count, path);
    if (asset)
        server_reply_asset(exchange, asset);
    else
        server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND,
                             "this build of the program holds no %s", path);
}

/* Replies with the viewer. Any query string is allowed, because the page's scripts read it. */
void server_handle_get_viewer(struct server_exchange *exchange)
{
    reply_asset(exchange, "/");
}

void server_handle_get_openapi(struct server_exchange *exchange)
{
    if (server_request_is_plain(exchange)) reply_asset(exchange, "/openapi.json");
}

static void reply_health(struct server_exchange *exchange, unsigned status,
                         enum proto_health health, const char *reason)
{
    struct proto_writer writer;
    proto_writer_init(&writer, ANSWER_MOST);
    proto_health_encode(&writer, health, reason);
    server_reply_json(exchange, status, &writer);
}

void server_handle_get_livez(struct server_exchange *exchange)
{
    if (server_request_is_plain(exchange)) reply_health(exchange, 200, PROTO_HEALTH_OK, NULL);
}

/* Reports readiness. A daemon with a read-only store is ready, because it still answers queries. A
 * daemon whose shared store can't be reached is ready, too, because surfaces in memory can still be
 * queried, and because the other daemons can't reach the store either. */
void server_handle_get_readyz(struct server_exchange *exchange)
{
    const char *reason = server_registry_health(exchange->host->api->registry);
    if (!reason) reason = server_batch_runner_health(exchange->host->api->batches);
    if (!server_request_is_plain(exchange)) return;
    if (atomic_load(&exchange->host->is_draining)) {
        server_reply_header(exchange, "Retry-After", "1");
        reply_health(exchange, 503, PROTO_HEALTH_DRAINING, NULL);
    } else {
        enum proto_health broken = server_registry_is_shared(exchange->host->api->registry)
                                       ? PROTO_HEALTH_DEGRADED
                                       : PROTO_HEALTH_READ_ONLY;
        reply_health(exchange, 200, reason ? broken : PROTO_HEALTH_OK, reason);
    }
}

/* Replies with metrics. Only an operator's key gets the metrics of all tenants. A local address
 * does not identify an operator, because behind a proxy every client has a local address. */
void server_handle_get_metrics(struct server_exchange *exchange)
{
    const struct server_api *api = exchange->host->api;
    struct proto_writer writer;
    if (!server_request_is_plain(exchange)) return;
    proto_writer_init(&writer, ANSWER_MOST);
    api->write_metrics(api->metrics_source,
                       server_grant_is_operator(&exchange->grant) ? NULL : exchange->tenant,
                       &writer);
    server_reply_text(exchange, 200, "text/plain; version=0.0.4; charset=utf-8", &writer);
}

void server_handle_get_service(struct server_exchange *exchange)
{
    const struct server_config *config = exchange->host->api->config;
    const struct proto_service service = {
        .version = SERVER_VERSION,
        .limits = {.max_body_bytes = config->max_body,
                   .max_faces = config->max_faces,
                   .timeout_ms = config->timeout_ms,
                   .memory_budget_bytes = config->memory_budget,
                   .max_answer_bytes = server_share_largest_answer(exchange->share),
                   .workers = config->workers},
        .routes = proto_routes,
        .route_count = proto_route_count,
    };
    struct proto_writer writer;
    if (!server_reply_accepts_json(exchange) || !server_request_is_plain(exchange)) return;
    proto_writer_init(&writer, ANSWER_MOST);
    proto_service_encode(&writer, &service);
    server_reply_json(exchange, 200, &writer);
}
