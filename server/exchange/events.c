/* See events.h. */
#include "server/exchange/events.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "gd/control.h"

#define PROGRESS_NS UINT64_C(100000000) /* between two messages of a stream, unless it is woken */
/* without a message: proxies and clients take longer silence for a broken line */
#define HEARTBEAT_NS UINT64_C(15000000000)
#define LOOK_NS      UINT64_C(1000000000) /* between two looks at the sockets of paused readers */
#define MESSAGE_MOST 65536                /* bytes */

static const char heartbeat[] = ":\n\n";

struct server_stream {
    struct server_events *events;
    struct server_stream *next, *previous;
    struct server_event_source source;
    struct server_stream_reader reader;
    struct proto_writer message; /* what is being read, */
    size_t read;                 /* and how much of it was */
    uint64_t told_version, told_ns;
    bool is_paused, is_woken;
    bool has_ended; /* nothing comes after the message */
};

struct server_events {
    pthread_mutex_t lock;
    struct server_stream *first;
    atomic_uint count;
    uint64_t looked_ns;
    bool is_ending;
};

struct server_events *server_events_create(void)
{
    struct server_events *events = calloc(1, sizeof *events);
    if (events) pthread_mutex_init(&events->lock, NULL);
    return events;
}

void server_events_destroy(struct server_events *events)
{
    if (!events) return;
    pthread_mutex_destroy(&events->lock);
    free(events);
}

uint32_t server_events_count(const struct server_events *events)
{
    return events ? atomic_load_explicit(&events->count, memory_order_relaxed) : 0;
}

/* --- streams ---------------------------------------------------------------------------------- */

struct server_stream *server_stream_open(struct server_events *events,
                                         const struct server_event_source *source)
{
    struct server_stream *stream = calloc(1, sizeof *stream);
    if (!stream) return NULL;
    stream->events = events;
    stream->source = *source;
    stream->is_woken = true; /* the first message tells how things stand */
    proto_writer_init(&stream->message, MESSAGE_MOST);
    pthread_mutex_lock(&events->lock);
    stream->next = events->first;
    if (stream->next) stream->next->previous = stream;
    events->first = stream;
    atomic_fetch_add(&events->count, 1);
    pthread_mutex_unlock(&events->lock);
    return stream;
}

void server_stream_attach(struct server_stream *stream, struct server_stream_reader reader)
{
    stream->reader = reader; /* not called before its first pause */
}

void server_stream_close(struct server_stream *stream)
{
    if (!stream) return;
    struct server_events *events = stream->events;
    pthread_mutex_lock(&events->lock);
    if (stream->next) stream->next->previous = stream->previous;
    *(stream->previous ? &stream->previous->next : &events->first) = stream->next;
    atomic_fetch_sub(&events->count, 1);
    pthread_mutex_unlock(&events->lock);
    stream->source.release(stream->source.user);
    proto_writer_free(&stream->message);
    free(stream);
}

/* --- reading, under the lock ------------------------------------------------------------------ */

static bool stream_is_due(const struct server_stream *stream, uint64_t now_ns)
{
    const struct server_event_source *source = &stream->source;
    uint64_t silence = now_ns - stream->told_ns;
    if (source->read) return false; /* a wake alone resumes its reader */
    if (stream->is_woken) return true;
    return silence >= HEARTBEAT_NS ||
           (silence >= PROGRESS_NS && source->version(source->user) != stream->told_version);
}

/* The version is read first: what happens meanwhile is told twice rather than never. */
static void stream_compose(struct server_stream *stream, uint64_t now_ns)
{
    const struct server_event_source *source = &stream->source;
    uint64_t version = source->version(source->user);
    bool is_news = stream->is_woken || version != stream->told_version;
    proto_writer_free(&stream->message);
    proto_writer_init(&stream->message, MESSAGE_MOST);
    if (is_news)
        stream->has_ended = !source->tell(source->user, &stream->message);
    else
        proto_append(&stream->message, heartbeat, strlen(heartbeat));
    if (stream->message.failure || stream->events->is_ending) stream->has_ended = true;
    stream->read = 0;
    stream->is_woken = false;
    stream->told_version = version;
    stream->told_ns = now_ns;
}

static ptrdiff_t stream_read_message(struct server_stream *stream, char *bytes, size_t size)
{
    uint64_t now = gd_now_ns();
    if (stream->read == stream->message.size && !stream->has_ended && stream_is_due(stream, now))
        stream_compose(stream, now);
    size_t left = stream->message.size - stream->read;
    if (!left) return stream->has_ended ? SERVER_STREAM_END : 0;
    if (size > left) size = left;
    memcpy(bytes, stream->message.data + stream->read, size);
    stream->read += size;
    return (ptrdiff_t)size;
}

ptrdiff_t server_stream_read(struct server_stream *stream, char *bytes, size_t size)
{
    const struct server_event_source *source = &stream->source;
    ptrdiff_t read;
    pthread_mutex_lock(&stream->events->lock);
    if (!source->read)
        read = stream_read_message(stream, bytes, size);
    else
        read = stream->has_ended ? SERVER_STREAM_CUT : source->read(source->user, bytes, size);
    stream->is_paused = read == 0;
    if (stream->is_paused) stream->reader.pause(stream->reader.user);
    pthread_mutex_unlock(&stream->events->lock);
    return read;
}

/* --- waking ----------------------------------------------------------------------------------- */

static void stream_resume(struct server_stream *stream)
{
    if (!stream->is_paused) return;
    stream->is_paused = false;
    stream->reader.resume(stream->reader.user);
}

/* A stream whose client has hung up ends, so that its reader is resumed and finds out. */
void server_events_tick(struct server_events *events, uint64_t now_ns)
{
    if (server_events_count(events) == 0) return;
    pthread_mutex_lock(&events->lock);
    bool looks = now_ns - events->looked_ns >= LOOK_NS;
    if (looks) events->looked_ns = now_ns;
    for (struct server_stream *stream = events->first; stream; stream = stream->next) {
        if (!stream->is_paused) continue;
        if (looks && stream->reader.is_gone(stream->reader.user)) stream->has_ended = true;
        if (stream->has_ended || stream_is_due(stream, now_ns)) stream_resume(stream);
    }
    pthread_mutex_unlock(&events->lock);
}

void server_events_wake(struct server_events *events, const void *user)
{
    if (server_events_count(events) == 0) return;
    pthread_mutex_lock(&events->lock);
    for (struct server_stream *stream = events->first; stream; stream = stream->next) {
        if (stream->source.user != user) continue;
        stream->is_woken = true;
        stream_resume(stream);
    }
    pthread_mutex_unlock(&events->lock);
}

void server_events_end(struct server_events *events)
{
    pthread_mutex_lock(&events->lock);
    events->is_ending = true;
    for (struct server_stream *stream = events->first; stream; stream = stream->next) {
        if (stream->source.read) continue;
        stream->has_ended = true;
        stream_resume(stream);
    }
    pthread_mutex_unlock(&events->lock);
}
