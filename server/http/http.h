/* HTTP: the boundary to libmicrohttpd. Turns requests into exchanges and their responses into
 * answers; knows no route. */
#ifndef SERVER_HTTP_HTTP_H
#define SERVER_HTTP_HTTP_H

#include <stddef.h>
#include <stdint.h>

struct server_config;
struct server_connections;
struct server_exchange;
struct server_host;
struct server_http;
struct server_tls;

/* What the HTTP side uses; everything is borrowed until server_http_stop. The functions are called
 * by HTTP threads, and must not block. */
struct server_http_parts {
    const struct server_config *config;
    struct server_host *host; /* of all exchanges */
    struct server_connections *connections;
    struct server_tls *tls; /* NULL: HTTP without TLS */
    /* The headers are there. Replies, or leaves it to `end`. A reply with response.close is sent at
     * once, and the body is not read. */
    void (*begin)(struct server_exchange *exchange);
    /* The body is there. Replies or defers. */
    void (*end)(struct server_exchange *exchange);
};

/* Serves the listening socket, which becomes its own. NULL with a sentence in `error`. */
struct server_http *server_http_start(const struct server_http_parts *parts, int listening,
                                      char *error, size_t error_size);

/* Takes no new connections from now on; those that are open go on. */
void server_http_quiesce(struct server_http *http);

/* Closes all connections and frees. No exchange is deferred any more. NULL is harmless. */
void server_http_stop(struct server_http *http);

#endif
