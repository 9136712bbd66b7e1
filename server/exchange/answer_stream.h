/* Answer streams: large answers that are encoded while the clients read them.
 *
 * DESIGN. An answer is first encoded into a buffer of SERVER_ANSWER_STREAM_FROM bytes. If the text
 * is longer, the encoder runs to the end without storing the text. So the size is known, and an
 * answer that is too large or too late is refused as a whole. Then a thread of the pool runs the
 * same encoder again, and blocks in a relay (relay.h) while the client is slow. Meanwhile the
 * budget counts the relay's buffer and the handler's state as an answer.
 *
 * Each of SERVER_ANSWER_STREAMS threads serves one stream. They start with the daemon, because the
 * sandbox forbids new threads. The whole text is stored in memory if all threads are in use, and
 * for jobs, HEAD and HTTP/1.0. */
#pragma once

#include "server/exchange/exchange.h"

#define SERVER_ANSWER_STREAMS     32
#define SERVER_ANSWER_STREAM_FROM ((size_t)1 << 20) /* bytes of text */

struct server_answer_streams;

/* Starts the threads. Returns NULL if there is no memory or no thread. */
struct server_answer_streams *server_answer_streams_create(void);

/* Call this function when no stream is running. NULL is allowed. */
void server_answer_streams_destroy(struct server_answer_streams *streams);

struct server_answer_streams_load {
    uint32_t count; /* running streams */
    /* bytes of SERVER_BUDGET_ANSWERS that the states of all streams hold, without the relays */
    size_t held;
};

/* Thread-safe. Returns zeros for NULL. */
struct server_answer_streams_load
server_answer_streams_load(const struct server_answer_streams *streams);

struct server_answer_encoder {
    /* Writes the text from the exchange's state. The function is called up to three times, and must
       write the same text each time. In a stream the exchange has no members except the host and
       the state. */
    void (*encode)(struct server_exchange *exchange, struct proto_writer *writer);
    /* bytes of SERVER_BUDGET_FLIGHT that the state holds; a stream moves them to
       SERVER_BUDGET_ANSWERS, and sets this number to 0 */
    size_t *held;
    const char *media_type; /* a static string; NULL means application/json */
};

/* Replies with the encoder's text, or with a problem. `writer` must be fresh from
 * server_reply_writer. A stream takes over the exchange's state, and frees the state when the
 * stream ends. */
void server_answer_reply(struct server_exchange *exchange, unsigned status,
                         struct proto_writer *writer, const struct server_answer_encoder *encoder);
