/* HTTP: the interface to libmicrohttpd. Converts requests to exchanges; does not depend on the
 * routes. */
#pragma once

#include "server/base/error.h"

struct server_config;
struct server_connections;
struct server_exchange;
struct server_host;
struct server_http;
struct server_tls;

/* The parts that HTTP uses, borrowed until server_http_stop. The functions must not block. */
struct server_http_parts {
    const struct server_config *config;
    struct server_host *host; /* shared by all exchanges */
    struct server_connections *connections;
    struct server_tls *tls; /* NULL means HTTP without TLS */
    /* Called after the headers. Replies, or leaves the reply to `end`. A reply with response.close
       is sent at once, without reading the body. */
    void (*begin)(struct server_exchange *exchange);
    /* Called after the body. Replies or defers. */
    void (*end)(struct server_exchange *exchange);
};

/* Serves requests on the listening socket, and takes over this socket. On failure, returns NULL
 * with a sentence in `error`. */
struct server_http *server_http_start(const struct server_http_parts *parts, int listening,
                                      char error[SERVER_ERROR]);

/* Accepts no new connections from now on. Open connections continue. */
void server_http_quiesce(struct server_http *http);

/* Closes all connections and frees `http`. Call this function when no exchange is deferred. NULL is
 * allowed. */
void server_http_stop(struct server_http *http);
