/* See request_log.h. */
#include "server/http/request_log.h"

#include <netdb.h>
#include <netinet/in.h>
#include <stddef.h>

#include "server/exchange/exchange.h"
#include "server/base/log.h"

#define PEER_TEXT 64

static bool is_suspicious(unsigned status)
{
    return status == 400 || status == 401 || status == 403 || status == 429;
}

static const char *print_peer(const struct sockaddr *peer, char text[PEER_TEXT])
{
    if (!peer || (peer->sa_family != AF_INET && peer->sa_family != AF_INET6)) return NULL;
    socklen_t size =
        peer->sa_family == AF_INET6 ? sizeof(struct sockaddr_in6) : sizeof(struct sockaddr_in);
    return getnameinfo(peer, size, text, PEER_TEXT, NULL, 0, NI_NUMERICHOST) == 0 ? text : NULL;
}

/* The line's event and level; of several that it may be, the worst. */
struct kind {
    const char *event;
    enum server_log_level level;
};

static struct kind kind_of(const struct server_exchange *exchange, uint64_t nanoseconds)
{
    uint64_t slow_ms = exchange->host->slow_ms;
    bool is_slow = slow_ms && nanoseconds >= slow_ms * 1000000;
    if (exchange->response.status == 500) return (struct kind){"request", SERVER_LOG_ERROR};
    return is_slow ? (struct kind){"slow_request", SERVER_LOG_WARN}
                   : (struct kind){"request", SERVER_LOG_INFO};
}

void server_request_log(const struct server_exchange *exchange, const struct sockaddr *peer,
                        uint64_t nanoseconds)
{
    const struct server_response *response = &exchange->response;
    struct server_log_line line;
    char text[PEER_TEXT];
    const struct kind kind = kind_of(exchange, nanoseconds);
    if (!server_log_begin(&line, kind.level, kind.event)) return;
    server_log_text(&line, "method", exchange->method);
    server_log_text(&line, "path", exchange->path);
    server_log_text(&line, "route", exchange->match.route ? exchange->match.route->path : NULL);
    server_log_integer(&line, "status", response->status);
    server_log_text(&line, "code", server_exchange_code(exchange));
    server_log_text(&line, "key", server_grant_name(&exchange->grant));
    if (is_suspicious(response->status)) server_log_text(&line, "peer", print_peer(peer, text));
    server_log_integer(&line, "bytes", (int64_t)response->size);
    server_log_milliseconds(&line, "ms", nanoseconds);
    server_log_text(&line, "lane", exchange->work ? "worker" : "inline");
    server_log_text(&line, "request_id", exchange->request_id);
    server_log_text(&line, "traceparent", server_exchange_header(exchange, "traceparent"));
    server_log_end_soon(&line);
}
