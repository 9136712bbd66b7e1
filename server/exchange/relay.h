/* Relay: a bounded buffer between the worker that writes an answer's text and its client.
 *
 *     relay = server_relay_create(host, share, is_packed);
 *     stream = server_relay_open(relay);               passed to server_reply_stream
 *     server_relay_write(relay, text, size);           by the writer, repeatedly
 *     if (server_relay_wait(relay, job)) return;       a worker parks its job at the relay;
 *     if (!server_relay_block(relay)) stop;            any other thread blocks
 *     server_relay_end(relay, true);                   when all is written
 *     server_relay_release(relay);
 *
 * DESIGN. The worker appends to a buffer, and the stream's reader removes bytes from the front of
 * the buffer. When SERVER_RELAY_MOST bytes are unread, the writer parks its job (workers.h) or
 * blocks until half of them are read. So memory is bounded for answers of any length. The budget
 * counts the buffer as an answer from the beginning. When the client disconnects, the stream is
 * closed. Order of locks: events, relay, workers. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "server/work/workers.h"

/* limit on unread bytes, not counting the last write */
#define SERVER_RELAY_MOST ((size_t)256 << 10)

/* A write of at most this size never lacks memory, because server_relay_create reserves that
 * memory. */
#define SERVER_RELAY_BLOCK ((size_t)64 << 10)

struct server_host;
struct server_relay;
struct server_share;
struct server_stream;

/* Creates a relay with one reference, which compresses the text if `is_packed` is true. Returns
 * NULL if out of memory. */
struct server_relay *server_relay_create(struct server_host *host, struct server_share *share,
                                         bool is_packed);
void server_relay_release(struct server_relay *relay); /* NULL is allowed */

/* Opens the stream from which the client reads. Call this function once. Returns NULL if out of
 * memory. */
struct server_stream *server_relay_open(struct server_relay *relay);

/* Appends text. If memory is short, the answer is cut. */
void server_relay_write(struct server_relay *relay, const char *text, size_t size);

/* Parks the job if too much is unread. Returns true if the job is parked; the caller must not use
 * it any more. Returns false if there is room or the client has disconnected. */
bool server_relay_wait(struct server_relay *relay, struct server_job *job);

/* Blocks while too much is unread. Returns false if the client has disconnected, the answer was
 * cut, or the daemon is stopping. */
bool server_relay_block(struct server_relay *relay);

/* Ends the text. If `is_whole` is false, the client sees that the answer was cut. */
void server_relay_end(struct server_relay *relay, bool is_whole);

/* Returns true if the client has disconnected or the answer was cut. */
bool server_relay_is_over(struct server_relay *relay);
