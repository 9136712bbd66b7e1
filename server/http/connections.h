/* Connections: the deadlines of all open connections, and a thread that shuts down connections
 * after their deadlines.
 *
 * The HTTP library has only an idle timer, so a client that sends a byte now and then could keep
 * its connection for ever. Therefore each phase of a connection has an absolute deadline:
 *     head    30 s from the opening of the connection, or from the request line of a later request
 *     body    30 s, and a second more for each 4 KiB received; at most 30 s without a byte
 *     work    no deadline: jobs have their own
 *     answer  30 s plus the time of its bytes at 16 KiB/s; the client must acknowledge 8 KiB/s
 *             in any 30 s
 *     idle    30 s
 *
 * An eighth of the allowed connections is the reserve for new clients. While the reserve is in use,
 * the thread shuts down connections that wait for their clients. Let n be the largest number of
 * such connections from one address. The thread chooses connections from addresses that have at
 * least n/2 of them. It begins with unfinished heads older than a second, the oldest first. Then it
 * shuts down idle connections, the longest idle first. While less than half of the reserve is free,
 * it also shuts down connections with younger heads and connections of other addresses. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

struct server_budget;
struct server_connections;

/* The record of one connection, for the HTTP thread that serves it. */
struct server_connection;

struct server_connections_statistics {
    uint64_t open; /* now */
    /* connections shut down during a head, a body or an answer, since the start */
    uint64_t cut;
    uint64_t refusals; /* malformed requests since the start */
};

/* Starts the thread. While `budget` (may be NULL) has no room for answers, the thread shuts down
 * one connection a second. It chooses the connection that has acknowledged nothing for the longest
 * time, if that is at least 10 s. Returns NULL if there is no memory or no thread. */
struct server_connections *server_connections_create(const struct server_budget *budget);

/* Sets the limit on open connections. Call this function before the first connection is opened. 0,
 * the default, means no limit. */
void server_connections_limit(struct server_connections *connections, uint32_t most);

/* Call this function when no connection is open. NULL is allowed. */
void server_connections_destroy(struct server_connections *connections);

/* Shuts down connections whose deadline is before `now_ns`. Also shuts down the receiving side of
 * connections that the client has half-closed, because the library does not detect an end of file
 * that arrives with the last bytes. The thread calls it every second. Thread-safe. */
void server_connections_check(struct server_connections *connections, uint64_t now_ns);

/* Shuts down connections that wait for their clients, until the reserve is free. Called by the
 * thread when a connection is opened while the reserve is in use. Thread-safe. */
void server_connections_relieve(struct server_connections *connections, uint64_t now_ns);

/* Returns the number of connections with a current request, from its request line to the last byte
 * of its answer. Thread-safe. */
uint32_t server_connections_active(struct server_connections *connections);

/* Thread-safe. Returns zeros for NULL. */
struct server_connections_statistics
server_connections_statistics(struct server_connections *connections);

/* --- one connection --------------------------------------------------------------------------- */

/* Opens a record. `client` is the client's address; may be NULL. Returns NULL if out of memory. */
struct server_connection *server_connection_open(struct server_connections *connections,
                                                 int descriptor, const struct sockaddr *client);

/* Frees the record, before the socket is closed. */
void server_connection_close(struct server_connection *connection);

/* Record the events of a request. In the order of the functions: the request line was read; the
 * headers were read; `size` bytes of the body were read; the whole body was read; the answer is
 * queued; the request has ended. */
void server_connection_ask(struct server_connection *connection, uint64_t now_ns);
void server_connection_head(struct server_connection *connection, bool has_body, uint64_t now_ns);
void server_connection_body(struct server_connection *connection, size_t size, uint64_t now_ns);
void server_connection_work(struct server_connection *connection);
void server_connection_answer(struct server_connection *connection, size_t size, bool is_stream,
                              uint64_t now_ns);
void server_connection_end(struct server_connection *connection);

/* Counts a malformed request. */
void server_connection_refuse(struct server_connection *connection);
