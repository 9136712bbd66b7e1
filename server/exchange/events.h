/* Events: streams of answers that are sent in pieces over time, each to one client. A stream is a
 * sequence of server-sent events, or the text of an answer (relay.h). For example:
 *
 *     stream = server_stream_open(events, &source);      a handler sets response.stream
 *     server_stream_attach(stream, reader);              the transport begins to send
 *     read = server_stream_read(stream, bytes, size);    the transport can write
 *     server_events_wake(events, source.user);           the source has changed
 *     server_stream_close(stream);                       the exchange ends
 *
 * DESIGN. A source is read only when its client can receive more. So slow clients miss intermediate
 * events, and no queue grows. A reader without data is paused until the source changes, a heartbeat
 * is due, or its client has hung up. One mutex guards the list of streams. The mutex is held while
 * `pause`, `resume` and sources are called, so a source's lock is acquired after the mutex. */
#pragma once

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
    /* Returns a number that changes whenever the source changes. The call must be cheap. */
    uint64_t (*version)(void *user);
    /* Writes the next message; returns false if this message is the last. */
    bool (*write)(void *user, struct proto_writer *writer);
    /* If the stream is the text of an answer, this function is used instead of `version` and
     * `write`. Its arguments and result are those of server_stream_read. A drain waits for the end
     * of such streams. After the client has hung up, the stream returns SERVER_STREAM_CUT. */
    ptrdiff_t (*read)(void *user, char *bytes, size_t size);
    void (*release)(void *user);
    void *user;
};

/* Pauses and resumes the reading of a transport. */
struct server_stream_reader {
    /* called during a read: the transport must not read again until `resume` */
    void (*pause)(void *user);
    void (*resume)(void *user); /* called by any thread */
    /* returns true if a paused reader's client has hung up; makes a system call */
    bool (*is_gone)(void *user);
    void *user;
};

/* Returns NULL if out of memory. */
struct server_events *server_events_create(void);

/* Call this function when all streams are closed. NULL is allowed. */
void server_events_destroy(struct server_events *events);

/* Resumes readers if progress or a heartbeat is due, or the client has hung up. Call this function
 * every 10 ms while requests are deferred, otherwise every second while there are streams. NULL is
 * allowed. */
void server_events_tick(struct server_events *events, uint64_t now_ns);

/* Resumes the readers of a source's streams at once. */
void server_events_wake(struct server_events *events, const void *user);

/* Ends all streams of events. Later streams end after their first message. */
void server_events_end(struct server_events *events);

/* Returns the number of open streams. Thread-safe. NULL means 0. */
uint32_t server_events_count(const struct server_events *events);

/* Opens a stream. Closing the stream releases the source. Returns NULL, without releasing the
 * source, if out of memory. */
struct server_stream *server_stream_open(struct server_events *events,
                                         const struct server_event_source *source);

/* Sets the reader of a stream. Call this function once, before the first read. */
void server_stream_attach(struct server_stream *stream, struct server_stream_reader reader);

/* Writes at most `size` bytes and returns their number. Returns 0 if there are no bytes and the
 * reader is paused. Other results: SERVER_STREAM_END, SERVER_STREAM_CUT. */
ptrdiff_t server_stream_read(struct server_stream *stream, char *bytes, size_t size);

/* Closes the stream; its reader is not called any more. NULL is allowed. */
void server_stream_close(struct server_stream *stream);
