#include "server/exchange/events.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>

#include "gd/control.h"
#include "server/base/thread.h"

/* time between two messages of a stream, unless the stream is woken */
#define PROGRESS_NS UINT64_C(100000000)
/* longest time without bytes: after a longer time, proxies and clients regard the connection as
 * broken */
#define HEARTBEAT_NS UINT64_C(15000000000)
/* time between two checks of the sockets of paused readers */
#define LOOK_NS      UINT64_C(1000000000)
#define MESSAGE_MOST 65536 /* bytes */

static const char heartbeat[] = ":\n\n";

struct server_stream {
    struct server_events *events;
    LIST_ENTRY(server_stream) next;
    struct server_event_source source;
    struct server_stream_reader reader;
    struct proto_writer message; /* the message that the client is reading */
    size_t read;                 /* number of bytes of the message that the client has read */
    uint64_t sent_version, sent_ns;
    bool is_paused, is_woken;
    bool has_ended; /* the message is the last one */
};

struct server_events {
    pthread_mutex_t lock;
    LIST_HEAD(, server_stream) streams;
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
    stream->is_woken = true; /* the first message is the current state */
    proto_writer_init(&stream->message, MESSAGE_MOST);
    SERVER_LOCK(&events->lock);
    LIST_INSERT_HEAD(&events->streams, stream, next);
    atomic_fetch_add(&events->count, 1);
    return stream;
}

void server_stream_attach(struct server_stream *stream, struct server_stream_reader reader)
{
    stream->reader = reader; /* the reader is not called before its first pause */
}

void server_stream_close(struct server_stream *stream)
{
    if (!stream) return;
    struct server_events *events = stream->events;
    pthread_mutex_lock(&events->lock);
    LIST_REMOVE(stream, next);
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
    uint64_t silence = now_ns - stream->sent_ns;
    if (source->read) return false; /* only server_events_wake resumes the stream's reader */
    if (stream->is_woken) return true;
    return silence >= HEARTBEAT_NS ||
           (silence >= PROGRESS_NS && source->version(source->user) != stream->sent_version);
}

/* Reads the version before the message. So a change during the call may be sent twice, but is never
 * lost. */
static void stream_compose(struct server_stream *stream, uint64_t now_ns)
{
    const struct server_event_source *source = &stream->source;
    uint64_t version = source->version(source->user);
    bool is_news = stream->is_woken || version != stream->sent_version;
    proto_writer_free(&stream->message);
    proto_writer_init(&stream->message, MESSAGE_MOST);
    if (is_news)
        stream->has_ended = !source->write(source->user, &stream->message);
    else
        proto_append(&stream->message, heartbeat, strlen(heartbeat));
    if (stream->message.failure || stream->events->is_ending) stream->has_ended = true;
    stream->read = 0;
    stream->is_woken = false;
    stream->sent_version = version;
    stream->sent_ns = now_ns;
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
    SERVER_LOCK(&stream->events->lock);
    if (!source->read)
        read = stream_read_message(stream, bytes, size);
    else
        read = stream->has_ended ? SERVER_STREAM_CUT : source->read(source->user, bytes, size);
    stream->is_paused = read == 0;
    if (stream->is_paused) stream->reader.pause(stream->reader.user);
    return read;
}

/* --- waking ----------------------------------------------------------------------------------- */

static void stream_resume(struct server_stream *stream)
{
    if (!stream->is_paused) return;
    stream->is_paused = false;
    stream->reader.resume(stream->reader.user);
}

/* Ends the stream of a client that has hung up, and resumes its reader. */
void server_events_tick(struct server_events *events, uint64_t now_ns)
{
    struct server_stream *stream;
    if (server_events_count(events) == 0) return;
    SERVER_LOCK(&events->lock);
    bool looks = now_ns - events->looked_ns >= LOOK_NS;
    if (looks) events->looked_ns = now_ns;
    LIST_FOREACH(stream, &events->streams, next)
    {
        if (!stream->is_paused) continue;
        if (looks && stream->reader.is_gone(stream->reader.user)) stream->has_ended = true;
        if (stream->has_ended || stream_is_due(stream, now_ns)) stream_resume(stream);
    }
}

void server_events_wake(struct server_events *events, const void *user)
{
    struct server_stream *stream;
    if (server_events_count(events) == 0) return;
    SERVER_LOCK(&events->lock);
    LIST_FOREACH(stream, &events->streams, next)
    {
        if (stream->source.user != user) continue;
        stream->is_woken = true;
        stream_resume(stream);
    }
}

void server_events_end(struct server_events *events)
{
    struct server_stream *stream;
    SERVER_LOCK(&events->lock);
    events->is_ending = true;
    LIST_FOREACH(stream, &events->streams, next)
    {
        if (stream->source.read) continue;
        stream->has_ended = true;
        stream_resume(stream);
    }
}
