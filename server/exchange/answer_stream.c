#include "server/exchange/answer_stream.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "server/base/thread.h"
#include "server/exchange/events.h"
#include "server/exchange/relay.h"
#include "server/exchange/reply.h"

/* A thread of the pool, and the stream that the thread serves. */
struct answer_stream {
    struct server_thread *thread;
    atomic_bool is_taken;
    struct server_answer_streams *pool;
    struct server_exchange *exchange; /* owns the state */
    void (*encode)(struct server_exchange *exchange, struct proto_writer *writer);
    struct server_relay *relay;
    struct proto_writer_sink sink;
    struct proto_writer writer;
};

struct server_answer_streams {
    atomic_size_t held;
    struct answer_stream all[SERVER_ANSWER_STREAMS];
};

/* --- the pool --------------------------------------------------------------------------------- */

static bool stream_pass_on(void *user, const char *text, size_t size)
{
    const struct answer_stream *stream = user;
    server_relay_write(stream->relay, text, size);
    return server_relay_block(stream->relay);
}

static void stream_release(struct answer_stream *stream)
{
    proto_writer_free(&stream->writer);
    server_relay_release(stream->relay);
    if (stream->exchange) atomic_fetch_sub(&stream->pool->held, stream->exchange->response.held);
    server_exchange_destroy(stream->exchange);
    atomic_store(&stream->is_taken, false);
}

static void stream_run(void *user, struct server_thread *thread)
{
    struct answer_stream *stream = user;
    while (server_thread_pause(thread, SERVER_THREAD_FOREVER)) {
        stream->encode(stream->exchange, &stream->writer);
        proto_writer_flush(&stream->writer);
        server_relay_end(stream->relay, !stream->writer.failure);
        stream_release(stream);
    }
}

struct server_answer_streams *server_answer_streams_create(void)
{
    struct server_answer_streams *streams = calloc(1, sizeof *streams);
    if (!streams) return NULL;
    for (int i = 0; i < SERVER_ANSWER_STREAMS; i++) {
        struct answer_stream *stream = &streams->all[i];
        stream->pool = streams;
        stream->thread = server_thread_start(stream_run, stream);
        if (stream->thread) continue;
        server_answer_streams_destroy(streams);
        return NULL;
    }
    return streams;
}

void server_answer_streams_destroy(struct server_answer_streams *streams)
{
    if (!streams) return;
    for (int i = 0; i < SERVER_ANSWER_STREAMS; i++) server_thread_stop(streams->all[i].thread);
    free(streams);
}

struct server_answer_streams_load
server_answer_streams_load(const struct server_answer_streams *streams)
{
    struct server_answer_streams_load load = {0};
    if (!streams) return load;
    load.held = atomic_load(&streams->held);
    for (int i = 0; i < SERVER_ANSWER_STREAMS; i++)
        load.count += atomic_load(&streams->all[i].is_taken);
    return load;
}

/* --- the start -------------------------------------------------------------------------------- */

/* Takes a thread of the pool. Returns NULL if all threads are in use or memory is short. */
static struct answer_stream *stream_take(const struct server_exchange *from, bool is_packed)
{
    static const struct server_transport none = {0};
    struct server_host *host = from->host;
    struct answer_stream *stream = host->streams->all, *end = stream + SERVER_ANSWER_STREAMS;
    while (stream < end && atomic_exchange(&stream->is_taken, true)) stream++;
    if (stream == end) return NULL;
    stream->sink = (struct proto_writer_sink){stream_pass_on, stream, SERVER_RELAY_BLOCK};
    stream->writer = (struct proto_writer){0};
    stream->relay = server_relay_create(host, from->share, is_packed);
    stream->exchange = server_exchange_create(host, &none, "/");
    if (stream->relay && stream->exchange) {
        stream->exchange->share = from->share;
        server_reply_writer(stream->exchange, &stream->writer);
        stream->writer.sink = &stream->sink;
        proto_writer_expect(&stream->writer, SERVER_RELAY_BLOCK);
        if (!stream->writer.failure) return stream;
    }
    stream_release(stream);
    return NULL;
}

/* Moves the state to the stream and counts it as an answer. Returns false if the budget of answers
 * has no room for it. */
static bool stream_take_state(struct answer_stream *stream, struct server_exchange *from,
                              size_t *held)
{
    struct server_exchange *to = stream->exchange;
    if (!server_share_move_to_answers(from->share, *held)) return false;
    atomic_fetch_add(&stream->pool->held, *held);
    to->response.held = *held;
    *held = 0;
    server_exchange_keep(to, from->state, from->free_state);
    server_exchange_keep(from, NULL, NULL);
    return true;
}

static const char *encoder_media_type(const struct server_answer_encoder *encoder)
{
    return encoder->media_type ? encoder->media_type : "application/json";
}

/* Starts the stream. On failure returns false; the exchange then still owns the state. */
static bool stream_start(struct server_exchange *exchange, unsigned status, size_t size,
                         const struct server_answer_encoder *encoder)
{
    bool is_packed = server_reply_takes_gzip(exchange);
    struct answer_stream *stream = stream_take(exchange, is_packed);
    if (!stream) return false;
    struct server_stream *client = server_relay_open(stream->relay);
    if (!client || !stream_take_state(stream, exchange, encoder->held)) {
        server_stream_close(client);
        stream_release(stream);
        return false;
    }
    stream->encode = encoder->encode;
    server_thread_wake(stream->thread);
    server_reply_coding(exchange, is_packed);
    server_reply_stream(exchange, status, encoder_media_type(encoder), client);
    if (!is_packed) exchange->response.size = size;
    return true;
}

/* --- the answer ------------------------------------------------------------------------------- */

struct counting {
    struct server_monitor monitor;
    enum gd_status status;
};

static bool counting_check(void *user, const char *text, size_t size)
{
    struct counting *counting = user;
    const struct gd_control control = server_exchange_control(&counting->monitor);
    (void)text, (void)size;
    counting->status = gd_control_check(&control, 1);
    return !counting->status;
}

/* Encodes a short text, or measures a long one. If the deadline has passed, replies and returns
 * false. */
static bool answer_measure(struct server_exchange *exchange, struct proto_writer *writer,
                           const struct server_answer_encoder *encoder)
{
    struct counting counting = {.monitor = {.exchange = exchange}};
    const struct proto_writer_sink sink = {counting_check, &counting, SERVER_ANSWER_STREAM_FROM};
    struct proto_problem problem;
    writer->sink = &sink;
    encoder->encode(exchange, writer);
    if (writer->flushed) proto_writer_flush(writer);
    writer->sink = NULL;
    if (!counting.status) return true;
    (void)proto_problem_from_status(&problem, counting.status, NULL);
    server_reply_problem(exchange, &problem);
    return false;
}

void server_answer_reply(struct server_exchange *exchange, unsigned status,
                         struct proto_writer *writer, const struct server_answer_encoder *encoder)
{
    bool can_stream = exchange->transport->can_stream && exchange->work && !exchange->is_http10 &&
                      !server_exchange_is(exchange, "HEAD");
    if (!can_stream) {
        encoder->encode(exchange, writer);
    } else if (!answer_measure(exchange, writer, encoder)) {
        proto_writer_free(writer);
        return;
    } else if (!writer->failure && writer->flushed) {
        size_t size = writer->flushed;
        proto_writer_free(writer);
        if (stream_start(exchange, status, size, encoder)) return;
        proto_writer_expect(writer, size);
        encoder->encode(exchange, writer);
    }
    server_reply_text(exchange, status, encoder_media_type(encoder), writer);
}
