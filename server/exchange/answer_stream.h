/* Answer streams: large answers that are encoded while their clients read them.
 *
 * DESIGN. An answer is first encoded into a buffer of SERVER_ANSWER_STREAM_FROM bytes. An encoder
 * that passes it runs on to the end, and its text is counted and dropped: so the size is known, and
 * an answer that is too large, or late, is refused as a whole. Then the same encoder runs again on
 * a thread of its own, which blocks in a relay (relay.h) until the client has read enough.
 * Meanwhile the budget counts the relay's buffer and the handler's state as an answer's.
 *
 * Each of SERVER_ANSWER_STREAMS threads serves one stream. They are started with the daemon, since
 * the sandbox allows no new threads later. When all are taken, and for jobs, HEAD and HTTP/1.0, an
 * answer is held as a text. */
#ifndef SERVER_EXCHANGE_ANSWER_STREAM_H
#define SERVER_EXCHANGE_ANSWER_STREAM_H

#include "server/exchange/exchange.h"

#define SERVER_ANSWER_STREAMS     32
#define SERVER_ANSWER_STREAM_FROM ((size_t)1 << 20) /* bytes of text */

struct server_answer_streams;

/* Starts the threads. NULL without memory or threads. */
struct server_answer_streams *server_answer_streams_create(void);

/* When no stream is under way. NULL is harmless. */
void server_answer_streams_destroy(struct server_answer_streams *streams);

struct server_answer_streams_load {
    uint32_t count; /* of streams under way */
    size_t held;    /* bytes of SERVER_BUDGET_ANSWERS that their states hold, without the relays */
};

/* Thread-safe. NULL: zeros. */
struct server_answer_streams_load
server_answer_streams_load(const struct server_answer_streams *streams);

struct server_answer_encoder {
    /* Writes the text of the exchange's state; called up to three times, with the same outcome. The
     * exchange is the request's or, for a stream, one that has only the host and the state. */
    void (*encode)(struct server_exchange *exchange, struct proto_writer *writer);
    /* bytes of SERVER_BUDGET_FLIGHT that the state holds; set to 0 when a stream counts them */
    size_t *held;
    const char *media_type; /* static; NULL: application/json */
};

/* Replies with the encoder's text, or with a problem. `writer` is empty, of
 * server_reply_writer. A stream takes the exchange's state over and frees it at its end. */
void server_answer_reply(struct server_exchange *exchange, unsigned status,
                         struct proto_writer *writer, const struct server_answer_encoder *encoder);

#endif
