/* See answer_stream.h. */
#include "server/exchange/answer_stream.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "server/exchange/events.h"
#include "server/exchange/relay.h"
#include "server/exchange/reply.h"

#define STACK_BYTES ((size_t)256 << 10) /* encoders are flat */

struct answer_stream {
    struct answer_stream *next;       /* of those that wait for a thread */
    struct server_exchange *exchange; /* has the state */
    void (*encode)(struct server_exchange *exchange, struct proto_writer *writer);
    struct server_relay *relay;
    struct proto_writer_sink sink;
    struct proto_writer writer;
};

struct server_answer_streams {
    pthread_mutex_t lock;
    pthread_cond_t change;
    struct answer_stream *first; /* under the lock, as the next one */
    bool is_ending;
    atomic_uint count;
    atomic_size_t held;
    uint32_t thread_count;
    pthread_t threads[SERVER_ANSWER_STREAMS];
};

/* --- the thread ------------------------------------------------------------------------------- */

static bool hand_on(void *user, const char *text, size_t size)
{
    const struct answer_stream *stream = user;
    server_relay_write(stream->relay, text, size);
    return server_relay_block(stream->relay);
}

static void answer_stream_destroy(struct answer_stream *stream)
{
    struct server_answer_streams *streams = stream->exchange->host->streams;
    proto_writer_free(&stream->writer);
    server_relay_release(stream->relay);
    atomic_fetch_sub(&streams->held, stream->exchange->response.held);
    server_exchange_destroy(stream->exchange);
    free(stream);
    atomic_fetch_sub(&streams->count, 1);
}

static void answer_stream_produce(struct answer_stream *stream)
{
    stream->encode(stream->exchange, &stream->writer);
    proto_writer_flush(&stream->writer);
    server_relay_end(stream->relay, !stream->writer.failure);
    answer_stream_destroy(stream);
}

static void *streams_work(void *user)
{
    struct server_answer_streams *streams = user;
    pthread_mutex_lock(&streams->lock);
    while (streams->first || !streams->is_ending) {
        struct answer_stream *stream = streams->first;
        if (!stream) {
            pthread_cond_wait(&streams->change, &streams->lock);
            continue;
        }
        streams->first = stream->next;
        pthread_mutex_unlock(&streams->lock);
        answer_stream_produce(stream);
        pthread_mutex_lock(&streams->lock);
    }
    pthread_mutex_unlock(&streams->lock);
    return NULL;
}

/* --- the pool --------------------------------------------------------------------------------- */

struct server_answer_streams *server_answer_streams_create(void)
{
    struct server_answer_streams *streams = calloc(1, sizeof *streams);
    pthread_attr_t attributes;
    if (!streams) return NULL;
    pthread_mutex_init(&streams->lock, NULL);
    pthread_cond_init(&streams->change, NULL);
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, STACK_BYTES);
    bool ok = true;
    while (ok && streams->thread_count < SERVER_ANSWER_STREAMS) {
        pthread_t *thread = &streams->threads[streams->thread_count];
        ok = pthread_create(thread, &attributes, streams_work, streams) == 0;
        streams->thread_count += ok;
    }
    pthread_attr_destroy(&attributes);
    if (ok) return streams;
    server_answer_streams_destroy(streams);
    return NULL;
}

void server_answer_streams_destroy(struct server_answer_streams *streams)
{
    if (!streams) return;
    pthread_mutex_lock(&streams->lock);
    streams->is_ending = true;
    pthread_cond_broadcast(&streams->change);
    pthread_mutex_unlock(&streams->lock);
    for (uint32_t i = 0; i < streams->thread_count; i++) pthread_join(streams->threads[i], NULL);
    pthread_cond_destroy(&streams->change);
    pthread_mutex_destroy(&streams->lock);
    free(streams);
}

struct server_answer_streams_load
server_answer_streams_load(const struct server_answer_streams *streams)
{
    if (!streams) return (struct server_answer_streams_load){0};
    return (struct server_answer_streams_load){atomic_load(&streams->count),
                                               atomic_load(&streams->held)};
}

static void streams_submit(struct server_answer_streams *streams, struct answer_stream *stream)
{
    pthread_mutex_lock(&streams->lock);
    stream->next = streams->first;
    streams->first = stream;
    pthread_cond_signal(&streams->change);
    pthread_mutex_unlock(&streams->lock);
}

/* --- the start -------------------------------------------------------------------------------- */

/* A free place, taken. */
static bool take_place(struct server_answer_streams *streams)
{
    if (atomic_fetch_add(&streams->count, 1) < SERVER_ANSWER_STREAMS) return true;
    atomic_fetch_sub(&streams->count, 1);
    return false;
}

/* Takes a place. NULL without one, or without memory. */
static struct answer_stream *answer_stream_create(struct server_host *host,
                                                  void (*encode)(struct server_exchange *,
                                                                 struct proto_writer *),
                                                  bool is_packed)
{
    static const struct server_transport none = {0};
    if (!take_place(host->streams)) return NULL;
    struct answer_stream *stream = calloc(1, sizeof *stream);
    struct server_exchange *exchange = stream ? server_exchange_create(host, &none, "/") : NULL;
    if (!exchange) {
        free(stream);
        atomic_fetch_sub(&host->streams->count, 1);
        return NULL;
    }
    *stream = (struct answer_stream){
        .exchange = exchange, .encode = encode, .sink = {hand_on, stream, SERVER_RELAY_BLOCK}};
    server_reply_writer(exchange, &stream->writer);
    stream->writer.sink = &stream->sink;
    proto_writer_expect(&stream->writer, SERVER_RELAY_BLOCK);
    stream->relay = server_relay_create(host, is_packed);
    if (stream->relay && !stream->writer.failure) return stream;
    answer_stream_destroy(stream);
    return NULL;
}

/* Moves the state to the stream, and counts it as an answer's, which have a bound of their own. */
static bool take_state(struct answer_stream *stream, struct server_exchange *from, size_t *held)
{
    struct server_host *host = from->host;
    struct server_exchange *to = stream->exchange;
    if (!server_budget_move_to_answers(host->budget, *held)) return false;
    atomic_fetch_add(&host->streams->held, *held);
    to->response.held = *held;
    *held = 0;
    server_exchange_keep(to, from->state, from->free_state);
    server_exchange_keep(from, NULL, NULL);
    return true;
}

/* False: the state is still the exchange's. */
static bool answer_stream_start(struct server_exchange *exchange, unsigned status, size_t size,
                                const struct server_answer_encoder *encoder)
{
    bool is_packed = server_reply_takes_gzip(exchange);
    struct answer_stream *stream = answer_stream_create(exchange->host, encoder->encode, is_packed);
    if (!stream) return false;
    struct server_stream *client = server_relay_open(stream->relay);
    if (!client || !take_state(stream, exchange, encoder->held)) {
        server_stream_close(client);
        answer_stream_destroy(stream);
        return false;
    }
    streams_submit(exchange->host->streams, stream);
    server_reply_coding(exchange, is_packed);
    server_reply_stream(exchange, status, "application/json", client);
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

/* True: the writer holds all of the text, or a problem is replied. */
static bool encode_small(struct server_exchange *exchange, struct proto_writer *writer,
                         const struct server_answer_encoder *encoder, size_t *size)
{
    struct counting counting = {.monitor = {.exchange = exchange}};
    const struct proto_writer_sink sink = {counting_check, &counting, SERVER_ANSWER_STREAM_FROM};
    struct proto_problem problem;
    writer->sink = &sink;
    encoder->encode(exchange, writer);
    if (writer->flushed) proto_writer_flush(writer);
    writer->sink = NULL;
    *size = writer->flushed;
    if (!counting.status && (writer->failure || !writer->flushed)) return true;
    proto_writer_free(writer);
    if (!counting.status) return false;
    (void)proto_problem_from_status(&problem, counting.status, NULL);
    server_reply_problem(exchange, &problem);
    return true;
}

static bool can_stream(const struct server_exchange *exchange)
{
    return exchange->transport->can_stream && exchange->work && !exchange->is_http10 &&
           !server_exchange_is(exchange, "HEAD");
}

void server_answer_reply(struct server_exchange *exchange, unsigned status,
                         struct proto_writer *writer, const struct server_answer_encoder *encoder)
{
    size_t size = 0;
    bool is_text = !can_stream(exchange);
    if (!is_text && !encode_small(exchange, writer, encoder, &size)) {
        if (answer_stream_start(exchange, status, size, encoder)) return;
        is_text = true;
        proto_writer_expect(writer, size);
    }
    if (is_text) encoder->encode(exchange, writer);
    if (!exchange->response.status) server_reply_json(exchange, status, writer);
}
