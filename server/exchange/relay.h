/* Relay: an answer's text on its way from the worker that writes it to the client that reads it.
 *
 *     relay = server_relay_create(host, is_packed);
 *     stream = server_relay_open(relay);               for server_reply_stream
 *     server_relay_write(relay, text, size);           the writer, again and again
 *     if (server_relay_wait(relay, job)) return;       a worker parks its job when much is unread,
 *     if (!server_relay_block(relay)) stop;            a thread of its own blocks
 *     server_relay_end(relay, true);                   when all is written
 *     server_relay_release(relay);
 *
 * DESIGN. The worker writes into a buffer, and the stream's reader takes from its front. A writer
 * that is SERVER_RELAY_MOST bytes ahead lets its job be parked (workers.h) or blocks until half of
 * them are read, so memory is bounded however long the answer is; it counts as an answer's from the
 * beginning. When the client leaves, the stream is closed. Of locks, the events' ranks above the
 * relay's, the workers' below. */
#ifndef SERVER_EXCHANGE_RELAY_H
#define SERVER_EXCHANGE_RELAY_H

#include <stdbool.h>
#include <stddef.h>

#include "server/work/workers.h"

/* bytes that wait, besides those of the last write */
#define SERVER_RELAY_MOST ((size_t)256 << 10)

/* A relay whose writes are no larger never lacks memory: it is taken when the relay is created. */
#define SERVER_RELAY_BLOCK ((size_t)64 << 10)

struct server_host;
struct server_relay;
struct server_stream;

/* One reference. `is_packed`: the client reads gzip. NULL without memory, in the budget or in the
 * system. */
struct server_relay *server_relay_create(struct server_host *host, bool is_packed);
void server_relay_release(struct server_relay *relay); /* NULL is harmless */

/* The client's end, once. NULL without memory. */
struct server_stream *server_relay_open(struct server_relay *relay);

/* Hands on the text. Without memory the answer is cut. */
void server_relay_write(struct server_relay *relay, const char *text, size_t size);

/* Parks the job when too much waits: true, and it is not the caller's any more. False: there is
 * room, or nobody reads. */
bool server_relay_wait(struct server_relay *relay, struct server_job *job);

/* Blocks while too much waits. False: the client has gone, the answer was cut, or the daemon
 * ends. */
bool server_relay_block(struct server_relay *relay);

/* Nothing more comes; not whole: the client is to see that it was cut. */
void server_relay_end(struct server_relay *relay, bool is_whole);

/* The client has gone, or the answer was cut. */
bool server_relay_is_over(struct server_relay *relay);

#endif
