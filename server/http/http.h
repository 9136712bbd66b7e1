/* HTTP: the boundary to libmicrohttpd. Turns connections into exchanges and replies into responses;
 * knows no route. */
#ifndef SERVER_HTTP_HTTP_H
#define SERVER_HTTP_HTTP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct server;
struct server_http;

/* Serves the listening socket, which becomes its own, with `threads` threads. NULL with a sentence
 * in `error`. */
struct server_http *server_http_start(struct server *server, int listening, uint32_t threads,
                                      char *error, size_t error_size);

/* Takes no new connections from now on; those that are open go on. */
void server_http_quiesce(struct server_http *http);

/* Requests between their first line and the last byte of their answer. */
uint32_t server_http_active(struct server_http *http);

/* Closes all connections and frees. No exchange is deferred any more. NULL is harmless. */
void server_http_stop(struct server_http *http);

#endif
