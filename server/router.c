#include "server/server.h"

#include <stdatomic.h>
#include <string.h>
#include <strings.h>

#include "server/access/access.h"
#include "server/query/handlers.h"
#include "server/query/query.h"
#include "server/query/request.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"

/* limits on the bytes of the JSON of a query or a change, and of a new batch */
#define QUERY_BODY_LIMIT  (UINT64_C(1) << 20)
#define BATCH_BODY_LIMIT  (UINT64_C(4) << 20)
#define INLINE_BODY_LIMIT 8192 /* larger JSON is parsed by a worker */
#define CORS_SECONDS      600
#define CORS_HEADERS                                                                               \
    "Authorization, Content-Encoding, Content-Type, If-Match, If-None-Match, Prefer, "             \
    "X-Request-Id, traceparent"
#define REQUEST_ID_CHARACTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-"

/* Writes the hexadecimal digits of the value; returns their end. Faster than snprintf. */
static char *hex_write(uint64_t value, char *at)
{
    int digits = 1;
    while (digits < 16 && value >> 4 * digits) digits++;
    for (int digit = digits - 1; digit >= 0; digit--)
        *at++ = "0123456789abcdef"[value >> 4 * digit & 15];
    return at;
}

/* Adopts the client's X-Request-Id or generates one, unique in this process. */
static void set_request_id(struct server_exchange *exchange)
{
    static atomic_uint_least64_t serial;
    const char *given = server_exchange_header(exchange, "X-Request-Id");
    size_t size = given ? strlen(given) : 0;
    if (size > 0 && size < SERVER_REQUEST_ID && strspn(given, REQUEST_ID_CHARACTERS) == size) {
        strcpy(exchange->request_id, given);
        return;
    }
    char *at = hex_write(exchange->started_ns, exchange->request_id);
    *at++ = '-';
    *hex_write(atomic_fetch_add_explicit(&serial, 1, memory_order_relaxed), at) = '\0';
}

static bool request_admit(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct server_config *config = exchange->host->api->config;
    const struct server_guard_request request = {
        .host = server_exchange_host(exchange),
        .origin = server_exchange_header(exchange, "Origin"),
        .fetch_site = server_exchange_header(exchange, "Sec-Fetch-Site"),
        .is_http10 = exchange->is_http10,
    };
    if (!server_guard_admit(config, &request, problem)) return false;
    if (server_guard_lists(config, request.origin)) exchange->cors_origin = request.origin;
    return true;
}

/* Answers OPTIONS with the methods of the resource, or with all methods for the target "*" (RFC
 * 9110, 9.3.7); and a CORS preflight of a listed origin with the permitted headers. Needs no key,
 * since browsers send none. */
static bool answer_options(struct server_exchange *exchange, const struct proto_problem *problem)
{
    bool is_server = strcmp(exchange->path, "*") == 0;
    const char *allow = is_server ? PROTO_ROUTE_METHODS : problem->allow;
    if (!server_exchange_is(exchange, "OPTIONS") ||
        (!is_server && problem->code != PROTO_PROBLEM_METHOD_NOT_ALLOWED))
        return false;
    server_reply_header(exchange, "Allow", "%s, OPTIONS", allow);
    if (exchange->cors_origin &&
        server_exchange_header(exchange, "Access-Control-Request-Method")) {
        server_reply_header(exchange, "Access-Control-Allow-Methods", "%s", allow);
        server_reply_header(exchange, "Access-Control-Allow-Headers", "%s", CORS_HEADERS);
        server_reply_header(exchange, "Access-Control-Max-Age", "%d", CORS_SECONDS);
    }
    server_reply_empty(exchange, 204);
    return true;
}

/* Answers with the asset at the path. If there is one, but the method is neither GET nor HEAD,
 * returns false and changes the problem to method_not_allowed. */
static bool answer_asset(struct server_exchange *exchange, struct proto_problem *problem)
{
    static const char allow[] = "GET, HEAD";
    const struct proto_asset *asset = NULL;
    if (problem->code == PROTO_PROBLEM_NOT_FOUND)
        asset = proto_asset_find(proto_assets, proto_asset_count, exchange->path);
    if (!asset) return false;
    if (server_exchange_is(exchange, "GET") || server_exchange_is(exchange, "HEAD")) {
        server_reply_asset(exchange, asset);
        return true;
    }
    (void)proto_problem_set(problem, PROTO_PROBLEM_METHOD_NOT_ALLOWED, "this path accepts %s",
                            allow);
    memcpy(problem->allow, allow, sizeof allow);
    return false;
}

/* Checks the key. Unauthenticated clients get 401, never 404. */
static bool request_authorize(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct proto_route *route = exchange->match.route;
    const struct server_access_request request = {
        .authorization = server_exchange_header(exchange, "Authorization"),
        .authorization_count = server_exchange_count_headers(exchange, "Authorization"),
        .needed = route ? route->access : PROTO_ACCESS_READ,
        .is_follow_up = route && route->is_follow_up,
    };
    if (!server_access_admit(exchange->host->api->access, &request, &exchange->grant, problem))
        return false;
    exchange->tenant = server_grant_tenant(&exchange->grant);
    if (exchange->grant.key) exchange->share = exchange->grant.key->share;
    return true;
}

static bool prepare_coding(struct server_exchange *exchange, struct proto_problem *problem)
{
    const char *coding = server_exchange_header(exchange, "Content-Encoding");
    if (!coding || strcasecmp(coding, "identity") == 0) return true;
    if (server_exchange_count_headers(exchange, "Content-Encoding") == 1 &&
        (strcasecmp(coding, "gzip") == 0 || strcasecmp(coding, "x-gzip") == 0))
        return server_body_unpack(&exchange->body, problem);
    return proto_problem_set(
        problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
        "a request can only have Content-Encoding: gzip, once; else send the body uncompressed");
}

/* The characters that need no quotes in a shell. */
#define PLAIN_PATH "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-/"

/* Rejects an HTML form where the body is a file. */
static bool check_media_type(const struct server_exchange *exchange, struct proto_problem *problem)
{
    static const char form[] = "multipart/";
    const struct proto_route *route = exchange->match.route;
    const char *type = server_exchange_header(exchange, "Content-Type"), *path = exchange->path;
    bool is_plain = path[strspn(path, PLAIN_PATH)] == '\0';
    if ((route->handle != server_handle_create_surface &&
         route->handle != server_handle_put_surface) ||
        !type || strncasecmp(type, form, strlen(form)) != 0)
        return true;
    return proto_problem_set(problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
                             "the body is the file itself, not a form: send it with "
                             "curl -X %s --data-binary @FILE http://HOST%s",
                             exchange->method, is_plain ? path : route->path);
}

static bool prepare_body(struct server_exchange *exchange, struct proto_problem *problem)
{
    const struct proto_route *route = exchange->match.route;
    uint64_t limit = exchange->host->api->config->max_body;
    if (!route->has_body)
        return exchange->body.declared == 0 ||
               proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "this operation takes no request body; send none");
    if (!exchange->has_body)
        return proto_problem_set(problem, PROTO_PROBLEM_LENGTH_REQUIRED,
                                 "send the request body with a Content-Length, or chunked");
    if (!check_media_type(exchange, problem)) return false;
    bool is_bulk = route->kind && ((const struct server_query_kind *)route->kind)->read_arrays;
    if (route->query && !is_bulk && limit > QUERY_BODY_LIMIT) limit = QUERY_BODY_LIMIT;
    if (route->handle == server_handle_update_surface && limit > QUERY_BODY_LIMIT)
        limit = QUERY_BODY_LIMIT;
    if (route->handle == server_handle_create_batch && limit > BATCH_BODY_LIMIT)
        limit = BATCH_BODY_LIMIT;
    return server_body_prepare(&exchange->body, exchange->share, exchange->body.declared, limit,
                               problem) &&
           prepare_coding(exchange, problem);
}

static bool request_begin(struct server_exchange *exchange, struct proto_problem *problem)
{
    exchange->response.close = true; /* after a fault the end of the request is unknown */
    if (exchange->fault)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST, "%s", exchange->fault);
    /* a refusal that leaves a body unread closes the connection */
    exchange->response.close = exchange->body.declared != 0;
    if (!request_admit(exchange, problem)) return false;
    if (proto_route_find(proto_routes, proto_route_count, exchange->method, exchange->path,
                         &exchange->match, problem))
        return request_authorize(exchange, problem) && server_exchange_rename(exchange, problem) &&
               prepare_body(exchange, problem);
    if (answer_asset(exchange, problem) || answer_options(exchange, problem)) return true;
    struct proto_problem unauthorized;
    if (!request_authorize(exchange, &unauthorized)) *problem = unauthorized;
    return false;
}

void server_router_begin(struct server_exchange *exchange)
{
    struct proto_problem problem;
    set_request_id(exchange);
    if (!request_begin(exchange, &problem)) server_reply_problem(exchange, &problem);
    if (!exchange->response.status) exchange->response.close = false;
}

/* Runs on a worker. */
static bool run_handler(struct server_exchange *exchange)
{
    exchange->match.route->handle(exchange);
    return true;
}

void server_router_dispatch(struct server_exchange *exchange)
{
    const struct proto_route *route = exchange->match.route;
    /* the timeout starts when the body is read */
    uint64_t now_ns = exchange->body.size ? gd_now_ns() : exchange->started_ns;
    exchange->job.deadline_ns = now_ns + exchange->host->timeout_ms * 1000000;
    if (server_request_follows_first(exchange)) return;
    if (route->query && exchange->body.size > INLINE_BODY_LIMIT)
        server_exchange_defer(exchange, run_handler, NULL);
    else
        route->handle(exchange);
}

void server_router_end(struct server_exchange *exchange)
{
    struct proto_problem problem;
    if (exchange->response.status) return;
    if (!server_body_check(&exchange->body, &problem))
        server_reply_problem(exchange, &problem);
    else if (exchange->match.route->is_async && server_exchange_prefers(exchange, "respond-async"))
        server_handle_async(exchange);
    else
        server_router_dispatch(exchange);
}
