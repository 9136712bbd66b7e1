/* Events: answers that come as things happen, each to a client that watches: server-sent events, or
 * an answer's own text (relay.h).
 *
 *     stream = server_stream_open(events, &source);      a handler, into exchange->response.stream
 *     server_stream_attach(stream, reader);              the transport, when it begins to send
 *     read = server_stream_read(stream, bytes, size);    ... whenever it can write
 *     server_events_wake(events, source.user);           the source has news
 *     server_stream_close(stream);                       with the exchange
 *
 * DESIGN. A source is read when its client can take more, so slow clients miss the events in
 * between, and no queue grows. A reader that has nothing to read is paused until there is news, a
 * heartbeat is due, or its client has hung up. One mutex guards the list of streams; pause, resume
 * and sources are called under it, so the locks of sources rank below. */
#ifndef SERVER_EXCHANGE_EVENTS_H
#define SERVER_EXCHANGE_EVENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "proto/json/writer.h"

struct server_events;
struct server_stream;

#define SERVER_STREAM_END (-1)
#define SERVER_STREAM_CUT (-2)

/* Thread-safe. */
struct server_event_source {
    /* A number that changes whenever there is something new to tell. Cheap. */
    uint64_t (*version)(void *user);
    /* Writes what there is to tell; false: it is the last. */
    bool (*tell)(void *user, struct proto_writer *writer);
    /* Instead of both, for an answer's text, for which a drain waits: as server_stream_read. A
     * client that hangs up meanwhile gets SERVER_STREAM_CUT. */
    ptrdiff_t (*read)(void *user, char *bytes, size_t size);
    void (*release)(void *user);
    void *user;
};

/* How a stream makes its transport read, or not. */
struct server_stream_reader {
    void (*pause)(void *user);   /* called within a read: nothing is to be read until resume */
    void (*resume)(void *user);  /* by any thread */
    bool (*is_gone)(void *user); /* a paused reader's client has hung up; a system call */
    void *user;
};

/* NULL without memory. */
struct server_events *server_events_create(void);

/* All streams are closed. NULL is harmless. */
void server_events_destroy(struct server_events *events);

/* Resumes readers for progress, heartbeats, and clients that have hung up. To be called every 10
 * milliseconds or so while there is progress, every second while there are streams. NULL is
 * harmless. */
void server_events_tick(struct server_events *events, uint64_t now_ns);

/* Tells the streams of a source at once that there is news. */
void server_events_wake(struct server_events *events, const void *user);

/* Ends all streams of events, and coming ones after their first message. */
void server_events_end(struct server_events *events);

/* Streams that are open. Thread-safe. NULL: 0. */
uint32_t server_events_count(const struct server_events *events);

/* A stream of the source, which is released when the stream is closed. NULL without memory: then
 * it is not. */
struct server_stream *server_stream_open(struct server_events *events,
                                         const struct server_event_source *source);

/* Once, before the first read. */
void server_stream_attach(struct server_stream *stream, struct server_stream_reader reader);

/* Fills in at most `size` bytes and returns how many. 0: none, the reader is paused;
 * SERVER_STREAM_END, SERVER_STREAM_CUT. */
ptrdiff_t server_stream_read(struct server_stream *stream, char *bytes, size_t size);

/* The transport reads no more, and its reader is not called any more. NULL is harmless. */
void server_stream_close(struct server_stream *stream);

#endif
