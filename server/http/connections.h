/* Connections: what is known of each while it is open, and when it is cut.
 *
 * The HTTP library closes a connection on which nothing has come or gone for a while in the middle
 * of a body; a client that sends a byte now and then keeps it for ever, and the library's timer
 * takes a dozen looks at the clock a request. So a request's head, an answer and the idle time
 * between requests have absolute deadlines, after which a thread of its own shuts the socket down
 * (bodies: body.h).
 *
 * An answer has 30 s, and beyond it as long as it takes at 16 KiB/s. Meanwhile the client has to
 * take something: every 30 s the thread asks the kernel how many bytes the client has acknowledged.
 * What the library writes is no measure of that, since the kernel buffers megabytes.
 *
 * A part of the connections is kept free, so that a new client finds a place. When fewer are free,
 * connections that wait for their clients are cut, of the addresses that have most of them: heads
 * that are overdue for a second, the oldest first; then those that are idle for longest; then other
 * heads. */
#ifndef SERVER_HTTP_CONNECTIONS_H
#define SERVER_HTTP_CONNECTIONS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

#include "server/http/grammar.h"

struct server_connections;

/* One connection. It belongs to the HTTP thread that serves it. */
struct server_connection {
    struct server_grammar grammar; /* of what has come in */
    /* what the library is still to be given of a faulty request's; NULL: nothing */
    const char *ending;
    uint64_t requests; /* whose target the library has read */
    /* between a request's target and the last byte of its answer; its thread sets it */
    atomic_bool is_asked;
    bool is_busy;  /* from the request's headers on */
    bool is_brief; /* its answer's deadline will do for the idle time after it */
    bool is_encrypted;
};

struct server_connections_statistics {
    uint64_t open, cut,
        /* now; since the start: past a deadline that was not of idle time, and with a request that
           is no HTTP */
        faults;
};

/* Starts its thread. NULL without memory or thread. */
struct server_connections *server_connections_create(void);

/* How many there can be at a time; to be called before the first is opened. 0, as at first: any
 * number. */
void server_connections_limit(struct server_connections *connections, uint32_t most);

/* When no connection is open. NULL is harmless. */
void server_connections_destroy(struct server_connections *connections);

/* Cuts those whose deadline is before that time. What the thread does every second; thread-safe. */
void server_connections_cut(struct server_connections *connections, uint64_t now_ns);

/* Cuts heads and idle connections until enough places are free. What the thread does when a
 * connection is opened while they are not; thread-safe. */
void server_connections_relieve(struct server_connections *connections, uint64_t now_ns);

/* Has the threads of connections look again whose clients have ended them: the library overlooks an
 * end that comes together with the last bytes, and would wait for its timeout. Done every second as
 * well; thread-safe. */
void server_connections_remind(struct server_connections *connections);

/* A new connection, whose socket is watched from now on (wire.h). `client`: its address; NULL:
 * none. NULL without memory. */
struct server_connection *server_connections_open(struct server_connections *connections,
                                                  int descriptor, const struct sockaddr *client,
                                                  bool is_encrypted);

/* To be called before the socket is closed. */
void server_connections_close(struct server_connection *connection);

/* Bytes have come in and were followed by the grammar. */
void server_connection_received(struct server_connection *connection);

/* A request's target was read; its headers were; the answer, of `size` bytes, is on its way, or a
 * stream that ends when it ends; it is over. */
void server_connection_ask(struct server_connection *connection);
void server_connection_begin(struct server_connection *connection);
void server_connection_answer(struct server_connection *connection, size_t size, bool is_stream,
                              uint64_t now_ns);
void server_connection_end(struct server_connection *connection);

/* After a request's headers: is there more of its body to come? */
bool server_connection_is_in_body(const struct server_connection *connection);

/* How many have been asked and have not answered to the end. It looks at each, so that none has to
 * count for all of them. Thread-safe. */
uint32_t server_connections_under_way(struct server_connections *connections);

/* Thread-safe. NULL: nothing. */
struct server_connections_statistics
server_connections_statistics(struct server_connections *connections);

#endif
