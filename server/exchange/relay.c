#include "server/exchange/relay.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "gd/control.h"
#include "proto/json/writer.h"
#include "server/exchange/events.h"
#include "server/base/gzip.h"
#include "server/base/thread.h"
#include "server/exchange/exchange.h"

/* upper bound of the bytes of a compressed block */
#define PACKED_MOST (SERVER_RELAY_BLOCK + SERVER_RELAY_BLOCK / 4)

#define LOOK_NS 100000000 /* period in which a blocked writer checks whether the daemon ends */

struct server_relay {
    struct server_host *host;
    atomic_uint references;
    pthread_mutex_t lock;
    pthread_cond_t room; /* signalled when a blocked writer has room */
    struct proto_writer waiting;
    size_t taken;                 /* bytes at the front of `waiting` that the client has read */
    bool is_parked;               /* true if the writer's job is parked at the relay */
    struct server_packer *packer; /* used by the writer; NULL means no compression */
    struct proto_writer packed;   /* used by the writer: compressed text */
    bool is_ended, is_whole;      /* set by the writer */
    atomic_bool is_over;
};

/* --- life ------------------------------------------------------------------------------------- */

struct server_relay *server_relay_create(struct server_host *host, struct server_share *share,
                                         bool is_packed)
{
    struct server_relay *relay = calloc(1, sizeof *relay);
    if (!relay) return NULL;
    relay->host = host;
    relay->references = 1;
    pthread_mutex_init(&relay->lock, NULL);
    pthread_cond_init(&relay->room, NULL);
    proto_writer_init(&relay->packed, SIZE_MAX);
    relay->packed.account = &share->account;
    proto_writer_init(&relay->waiting, host->budget->largest_answer + 2 * SERVER_RELAY_MOST);
    relay->waiting.account = &share->account;
    proto_writer_expect(&relay->waiting, SERVER_RELAY_MOST + PACKED_MOST);
    if (is_packed) relay->packer = server_packer_create();
    if (is_packed) proto_writer_expect(&relay->packed, PACKED_MOST);
    if (!relay->waiting.failure && !relay->packed.failure && (!is_packed || relay->packer))
        return relay;
    server_relay_release(relay);
    return NULL;
}

void server_relay_release(struct server_relay *relay)
{
    if (!relay || atomic_fetch_sub(&relay->references, 1) != 1) return;
    server_packer_destroy(relay->packer);
    proto_writer_free(&relay->waiting);
    proto_writer_free(&relay->packed);
    pthread_cond_destroy(&relay->room);
    pthread_mutex_destroy(&relay->lock);
    free(relay);
}

/* --- the reader's end, under the events' lock ------------------------------------------------- */

static size_t unread_bytes(const struct server_relay *relay)
{
    return relay->waiting.size - relay->taken;
}

/* Under the relay's lock: wakes the writer. */
static void writer_wake(struct server_relay *relay)
{
    if (relay->is_parked) server_workers_unpark(relay->host->workers, relay);
    relay->is_parked = false;
    pthread_cond_signal(&relay->room);
}

static ptrdiff_t relay_read(void *user, char *bytes, size_t size)
{
    struct server_relay *relay = user;
    pthread_mutex_lock(&relay->lock);
    size_t left = unread_bytes(relay);
    ptrdiff_t end = relay->is_whole ? SERVER_STREAM_END : SERVER_STREAM_CUT;
    bool is_ended = relay->is_ended && !left;
    if (size > left) size = left;
    if (size) memcpy(bytes, relay->waiting.data + relay->taken, size);
    relay->taken += size;
    if (unread_bytes(relay) <= SERVER_RELAY_MOST / 2) writer_wake(relay);
    pthread_mutex_unlock(&relay->lock);
    return is_ended ? end : (ptrdiff_t)size;
}

static void relay_close(void *user)
{
    struct server_relay *relay = user;
    pthread_mutex_lock(&relay->lock);
    atomic_store(&relay->is_over, true);
    writer_wake(relay);
    pthread_mutex_unlock(&relay->lock);
    server_relay_release(relay);
}

struct server_stream *server_relay_open(struct server_relay *relay)
{
    const struct server_event_source source = {
        .read = relay_read, .release = relay_close, .user = relay};
    struct server_stream *stream = server_stream_open(relay->host->events, &source);
    if (stream) atomic_fetch_add(&relay->references, 1);
    return stream;
}

/* --- the writer's end ------------------------------------------------------------------------- */

/* Appends text under the lock. First moves the unread bytes to the front of the buffer. */
static void relay_append(struct server_relay *relay, const char *text, size_t size)
{
    struct proto_writer *waiting = &relay->waiting;
    if (relay->taken) {
        waiting->size -= relay->taken;
        memmove(waiting->data, waiting->data + relay->taken, waiting->size);
        relay->taken = 0;
    }
    proto_append(waiting, text, size);
    if (waiting->failure) atomic_store(&relay->is_over, true);
}

/* Compresses the text without the lock, so that the client's thread does not wait. */
static void text_write(struct server_relay *relay, const char *text, size_t size, bool is_last)
{
    struct proto_writer *packed = &relay->packed;
    if (server_relay_is_over(relay)) return;
    if (relay->packer) {
        packed->size = 0;
        server_packer_write(relay->packer, text, size, is_last, packed);
        if (packed->failure) atomic_store(&relay->is_over, true);
        text = packed->data;
        size = packed->size;
    }
    SERVER_LOCK(&relay->lock);
    if (!server_relay_is_over(relay)) relay_append(relay, text, size);
}

void server_relay_write(struct server_relay *relay, const char *text, size_t size)
{
    text_write(relay, text, size, false);
    server_events_wake(relay->host->events, relay);
}

bool server_relay_block(struct server_relay *relay)
{
    pthread_mutex_lock(&relay->lock);
    bool is_ahead = unread_bytes(relay) >= SERVER_RELAY_MOST;
    while (is_ahead && !server_relay_is_over(relay)) {
        if (server_workers_cancelled(relay->host->workers)) atomic_store(&relay->is_over, true);
        /* the wait has a time limit, because a cancel does not signal `room` */
        if (!server_relay_is_over(relay))
            server_condition_wait(&relay->room, &relay->lock, gd_now_ns() + LOOK_NS);
        is_ahead = unread_bytes(relay) > SERVER_RELAY_MOST / 2;
    }
    pthread_mutex_unlock(&relay->lock);
    return !server_relay_is_over(relay);
}

/* Before this function returns, the job may already run again and release the writer's
 * reference. */
bool server_relay_wait(struct server_relay *relay, struct server_job *job)
{
    atomic_fetch_add(&relay->references, 1);
    pthread_mutex_lock(&relay->lock);
    bool is_ahead = unread_bytes(relay) >= SERVER_RELAY_MOST && !atomic_load(&relay->is_over);
    if (is_ahead) {
        is_ahead = relay->is_parked = server_workers_park(relay->host->workers, job, relay, 0);
        /* the daemon is stopping, and the client does not read */
        if (!is_ahead) atomic_store(&relay->is_over, true);
    }
    pthread_mutex_unlock(&relay->lock);
    server_relay_release(relay);
    return is_ahead;
}

void server_relay_end(struct server_relay *relay, bool is_whole)
{
    if (relay->packer && is_whole) text_write(relay, "", 0, true);
    pthread_mutex_lock(&relay->lock);
    relay->is_whole = is_whole && !atomic_load(&relay->is_over);
    relay->is_ended = true;
    pthread_mutex_unlock(&relay->lock);
    server_events_wake(relay->host->events, relay);
}

bool server_relay_is_over(struct server_relay *relay)
{
    return atomic_load_explicit(&relay->is_over, memory_order_relaxed);
}
