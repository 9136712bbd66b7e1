/* See connections.h.
 *
 * DESIGN. One mutex guards the list. A deadline is atomic: its connection's thread sets it, the cutting thread looks at it. A
 * connection leaves the list before its socket is closed, so that what is cut under the mutex is never another's socket. */
#include "server/connections.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/socket.h>

#include "gd/control.h"
#include "server/thread.h"
#include "server/wire.h"

#define SECOND_NS      UINT64_C(1000000000)
#define HEAD_NS        (30 * SECOND_NS) /* for a handshake and a request's headers */
#define ANSWER_NS      (30 * SECOND_NS) /* for any answer, and beyond it as long as it takes at this rate */
#define BYTES_A_SECOND 16384
#define IDLE_NS        (30 * SECOND_NS) /* between requests; not more than for an answer */
#define NEVER          (UINT64_MAX - IDLE)
#define IDLE           UINT64_C(1) /* set in a deadline: the connection waits for a request; to cut it then is no incident */

struct entry {
    struct server_connection connection; /* first */
    struct server_connections *connections;
    struct entry *next, **at; /* the pointer that points here */
    int descriptor;
    atomic_uint_least64_t deadline_ns;
};

struct server_connections {
    pthread_mutex_t lock; /* of the list */
    struct entry *first;
    struct server_thread *thread;
    atomic_uint_least64_t open, cut, faults;
};

/* --- the thread --------------------------------------------------------------------------------------------------- */

void server_connections_cut(struct server_connections *connections, uint64_t now_ns)
{
    pthread_mutex_lock(&connections->lock);
    for (struct entry *entry = connections->first; entry; entry = entry->next) {
        uint64_t deadline_ns = atomic_load(&entry->deadline_ns);
        if (deadline_ns > now_ns) continue;
        atomic_store(&entry->deadline_ns, NEVER);
        if (!(deadline_ns & IDLE)) atomic_fetch_add(&connections->cut, 1);
        shutdown(entry->descriptor, SHUT_RDWR); /* its thread sees that, and closes it */
    }
    pthread_mutex_unlock(&connections->lock);
}

/* The client has ended its side, and all that it sent was read. */
static bool is_ended(const struct entry *entry)
{
    char byte;
    return recvfrom(entry->descriptor, &byte, 1, MSG_PEEK | MSG_DONTWAIT, NULL, NULL) == 0;
}

void server_connections_remind(struct server_connections *connections)
{
    pthread_mutex_lock(&connections->lock);
    for (struct entry *entry = connections->first; entry; entry = entry->next)
        if (is_ended(entry))
            shutdown(entry->descriptor, SHUT_RD); /* its thread looks again; an answer can still leave */
    pthread_mutex_unlock(&connections->lock);
}

static void look(void *user, struct server_thread *thread)
{
    struct server_connections *connections = user;
    while (server_thread_pause(thread, atomic_load(&connections->open) ? SECOND_NS : SERVER_THREAD_FOREVER)) {
        server_connections_cut(connections, gd_now_ns());
        server_connections_remind(connections);
    }
}

struct server_connections *server_connections_create(void)
{
    struct server_connections *connections = calloc(1, sizeof *connections);
    if (!connections) return NULL;
    pthread_mutex_init(&connections->lock, NULL);
    connections->thread = server_thread_start(look, connections);
    if (connections->thread) return connections;
    server_connections_destroy(connections);
    return NULL;
}

void server_connections_destroy(struct server_connections *connections)
{
    if (!connections) return;
    server_thread_stop(connections->thread);
    pthread_mutex_destroy(&connections->lock);
    free(connections);
}

/* --- one connection ----------------------------------------------------------------------------------------------- */

static uint64_t deadline_of(const struct server_connection *connection)
{
    return atomic_load_explicit(&((const struct entry *)connection)->deadline_ns, memory_order_relaxed);
}

static void set_deadline(struct server_connection *connection, uint64_t deadline_ns)
{
    atomic_store_explicit(&((struct entry *)connection)->deadline_ns, deadline_ns & ~IDLE, memory_order_relaxed);
}

static void set_idle(struct server_connection *connection, uint64_t deadline_ns)
{
    atomic_store_explicit(&((struct entry *)connection)->deadline_ns, deadline_ns | IDLE, memory_order_relaxed);
}

static void insert(struct server_connections *connections, struct entry *entry)
{
    pthread_mutex_lock(&connections->lock);
    entry->next = connections->first;
    entry->at = &connections->first;
    if (entry->next) entry->next->at = &entry->next;
    connections->first = entry;
    pthread_mutex_unlock(&connections->lock);
    if (atomic_fetch_add(&connections->open, 1) == 0) server_thread_wake(connections->thread);
}

static void remove_entry(struct entry *entry)
{
    struct server_connections *connections = entry->connections;
    pthread_mutex_lock(&connections->lock);
    *entry->at = entry->next;
    if (entry->next) entry->next->at = entry->at;
    pthread_mutex_unlock(&connections->lock);
    atomic_fetch_sub(&connections->open, 1);
}

struct server_connection *server_connections_open(struct server_connections *connections, int descriptor,
                                                  bool is_encrypted)
{
    struct entry *entry = calloc(1, sizeof *entry);
    if (!entry) return NULL;
    entry->connection.is_encrypted = is_encrypted;
    entry->connections = connections;
    entry->descriptor = descriptor;
    set_deadline(&entry->connection, gd_now_ns() + HEAD_NS);
    if (!server_wire_attach(descriptor, &entry->connection)) {
        free(entry);
        return NULL;
    }
    insert(connections, entry);
    return &entry->connection;
}

void server_connections_close(struct server_connection *connection)
{
    struct entry *entry = (struct entry *)connection;
    server_wire_detach(entry->descriptor);
    remove_entry(entry);
    free(entry);
}

/* The time of a head runs from its first byte on; the first one's, from the connection's beginning. */
void server_connection_received(struct server_connection *connection)
{
    struct entry *entry = (struct entry *)connection;
    if (connection->grammar.fault) atomic_fetch_add(&entry->connections->faults, 1);
    bool was_idle = deadline_of(connection) & IDLE;
    if (was_idle && server_grammar_is_in_head(&connection->grammar)) set_deadline(connection, gd_now_ns() + HEAD_NS);
}

void server_connection_ask(struct server_connection *connection)
{
    atomic_store_explicit(&connection->is_asked, true, memory_order_relaxed);
}

void server_connection_begin(struct server_connection *connection)
{
    connection->is_busy = true;
    set_deadline(connection, NEVER);
}

void server_connection_answer(struct server_connection *connection, size_t size, bool is_stream, uint64_t now_ns)
{
    uint64_t time_ns = ANSWER_NS + (uint64_t)size / BYTES_A_SECOND * SECOND_NS;
    connection->is_brief = !is_stream && size < BYTES_A_SECOND;
    set_deadline(connection, is_stream ? NEVER : now_ns + time_ns);
}

void server_connection_end(struct server_connection *connection)
{
    connection->is_busy = false;
    atomic_store_explicit(&connection->is_asked, false, memory_order_release);
    if (server_grammar_is_in_head(&connection->grammar))
        set_deadline(connection, gd_now_ns() + HEAD_NS);
    else
        set_idle(connection, connection->is_brief ? deadline_of(connection) : gd_now_ns() + IDLE_NS);
}

bool server_connection_is_in_body(const struct server_connection *connection)
{
    const struct server_grammar *grammar = &connection->grammar;
    bool is_between = grammar->state == SERVER_GRAMMAR_START || server_grammar_is_in_head(grammar);
    return grammar->heads == connection->requests && !is_between;
}

uint32_t server_connections_under_way(struct server_connections *connections)
{
    uint32_t count = 0;
    pthread_mutex_lock(&connections->lock);
    for (struct entry *entry = connections->first; entry; entry = entry->next)
        count += atomic_load_explicit(&entry->connection.is_asked, memory_order_acquire);
    pthread_mutex_unlock(&connections->lock);
    return count;
}

struct server_connections_statistics server_connections_statistics(struct server_connections *connections)
{
    if (!connections) return (struct server_connections_statistics){0};
    return (struct server_connections_statistics){.open = atomic_load(&connections->open),
                                                  .cut = atomic_load(&connections->cut),
                                                  .faults = atomic_load(&connections->faults)};
}
