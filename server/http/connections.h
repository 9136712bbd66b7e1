/* Connections: the deadlines of all open connections, and a thread that shuts late sockets down.
 *
 * The HTTP library has a timer for silence only: a client that sends a byte now and then keeps its
 * connection for ever. So each phase of a connection has an absolute deadline here:
 *     head    30 s from the opening of the connection, or from the request line of a later request
 *     body    30 s, and longer as long as the client sends 4 KiB/s on average; 30 s without a byte
 *     work    none: jobs have deadlines of their own
 *     answer  30 s, and longer as long as it takes at 16 KiB/s; the client acknowledges 8 KiB/s in
 *             any 30 s
 *     idle    30 s
 *
 * An eighth of all places is a reserve for new clients. While less is free, the thread shuts down
 * connections that wait for their clients, of the addresses that have most of them: heads older
 * than a second, the oldest first, then the connections that have been idle for longest. While less
 * than half of the reserve is free, younger heads and connections of other addresses go, too. */
#ifndef SERVER_HTTP_CONNECTIONS_H
#define SERVER_HTTP_CONNECTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

struct server_budget;
struct server_connections;

/* The record of one connection. Its functions are called by the HTTP thread that serves the
 * connection. */
struct server_connection;

struct server_connections_statistics {
    uint64_t open;     /* now */
    uint64_t cut;      /* since the start: shut down at a deadline that was not of idle time */
    uint64_t refusals; /* since the start: requests that are no HTTP */
};

/* Starts the thread. While `budget` (NULL: none) has no room for answers, the thread shuts down one
 * connection a second: the one whose client has acknowledged nothing of its answer for longest, if
 * that is 10 s. NULL without memory or thread. */
struct server_connections *server_connections_create(const struct server_budget *budget);

/* Sets how many connections there can be at a time, before the first is opened. 0, as at first: any
 * number. */
void server_connections_limit(struct server_connections *connections, uint32_t most);

/* When no connection is open. NULL is harmless. */
void server_connections_destroy(struct server_connections *connections);

/* Shuts down the connections whose deadline is before that time, and the receiving side of those
 * whose client has ended its own: the library overlooks an end that arrives with the last bytes.
 * Called every second by the thread. Thread-safe. */
void server_connections_check(struct server_connections *connections, uint64_t now_ns);

/* Shuts down connections that wait for their clients until the reserve is free. Called by the thread
 * when a connection is opened while the reserve is not. Thread-safe. */
void server_connections_relieve(struct server_connections *connections, uint64_t now_ns);

/* Connections between a request line and the last byte of its answer. Thread-safe.
 * O(connections). */
uint32_t server_connections_active(struct server_connections *connections);

/* Thread-safe. NULL: zeros. */
struct server_connections_statistics
server_connections_statistics(struct server_connections *connections);

/* --- one connection --------------------------------------------------------------------------- */

/* `client`: its address; NULL: none. NULL without memory. */
struct server_connection *server_connection_open(struct server_connections *connections,
                                                 int descriptor, const struct sockaddr *client);

/* Frees the record, before the socket is closed. */
void server_connection_close(struct server_connection *connection);

/* The phases of a request, in order: the request line was read; the headers were; `size` bytes of
 * the body; all of the body; the answer is queued; it is over. */
void server_connection_ask(struct server_connection *connection, uint64_t now_ns);
void server_connection_head(struct server_connection *connection, bool has_body, uint64_t now_ns);
void server_connection_body(struct server_connection *connection, size_t size, uint64_t now_ns);
void server_connection_work(struct server_connection *connection);
void server_connection_answer(struct server_connection *connection, size_t size, bool is_stream,
                              uint64_t now_ns);
void server_connection_end(struct server_connection *connection);

/* Counts a request that is no HTTP. */
void server_connection_refuse(struct server_connection *connection);

#endif
