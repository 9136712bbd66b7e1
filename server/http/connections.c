/* See connections.h.
 *
 * DESIGN. One mutex guards the list, which is in the order of opening. A deadline is atomic; its
 * low bits are the phase of the connection. The connection's HTTP thread sets the deadline. The
 * thread of this file reads the deadline, and replaces it by compare-and-swap. A connection is
 * removed from the list before the library closes its socket. So a descriptor that is shut down
 * under the mutex does not belong to another connection. */
#include "server/http/connections.h"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>

#include "gd/control.h"
#include "server/base/log.h"
#include "server/base/thread.h"
#include "server/work/budget.h"

#define SECOND_NS UINT64_C(1000000000)
/* time limit of any phase, and time between two checks of a reading client */
#define PATIENCE_NS (30 * SECOND_NS)
#define BODY_RATE   4096 /* bytes a second */
#define ANSWER_RATE 16384
#define LONG_ANSWER 65536 /* bytes; the kernel's buffer takes shorter answers at once */
/* Least bytes between two checks: half of the rate, because acknowledgements come in bursts. */
#define ACKNOWLEDGED (PATIENCE_NS / SECOND_NS * ANSWER_RATE / 2)

#define RESERVE_PART 8         /* 1/8 of the allowed connections */
#define SCARCE_PART  2         /* shortage: less than 1/2 of the reserve is free */
#define YOUNG_NS     SECOND_NS /* age of a head that has just begun */
/* time limit of clients that don't read, while memory for answers is short */
#define HASTE_NS     (10 * SECOND_NS)
#define COMPLAINT_NS (60 * SECOND_NS) /* time between two log lines about a shortage */
/* number of groups of addresses; a hash assigns addresses to groups */
#define ADDRESSES 1024

/* The phase of a connection, stored in the low bits of its deadline. */
enum phase { PHASE_OTHER, PHASE_IDLE, PHASE_HEAD, PHASE_ANSWER };
#define PHASES UINT64_C(3)
#define NEVER  (UINT64_MAX & ~PHASES)

struct server_connection {
    struct server_connections *connections;
    TAILQ_ENTRY(server_connection) next;
    int descriptor;
    unsigned address; /* the group of the client's address */
    atomic_uint_least64_t deadline_ns;
    /* during an answer: the latest time to which progress can extend the deadline */
    atomic_uint_least64_t last_ns;
    atomic_bool is_active; /* see server_connections_active */
    bool is_short;         /* true if the answer's deadline also covers the idle time after it */
    bool is_leaving;       /* true if the connection was shut down; guarded by the mutex */
    uint64_t body_started_ns, body_bytes;
    uint64_t acknowledged; /* bytes that the client had acknowledged at the thread's last check */
    /* bytes that the client had acknowledged at the last check that found progress */
    uint64_t moved;
    atomic_uint_least64_t moved_ns;
};

struct candidate {
    struct server_connection *connection;
    uint64_t deadline_ns;
    unsigned rank; /* connections of rank 0 are shut down first */
};

struct server_connections {
    pthread_mutex_t mutex;
    TAILQ_HEAD(, server_connection) all;
    struct server_thread *thread;
    const struct server_budget *budget;
    uint64_t refused_answers, checked_ns; /* values at the thread's last check */
    atomic_uint_least64_t open, leaving, cut, refusals, complained_ns;
    uint32_t most, reserve;
};

static enum phase phase_of(uint64_t deadline_ns)
{
    return (enum phase)(deadline_ns & PHASES);
}

static uint64_t deadline_earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* --- deadlines -------------------------------------------------------------------------------- */

/* Under the mutex: shuts down a connection. Returns false if the connection's thread has set
 * another deadline. */
static bool connection_shut(struct server_connection *connection, uint64_t deadline_ns)
{
    struct server_connections *connections = connection->connections;
    enum phase phase = phase_of(deadline_ns);
    if (!atomic_compare_exchange_strong(&connection->deadline_ns, &deadline_ns, NEVER))
        return false;
    if (phase != PHASE_IDLE) atomic_fetch_add(&connections->cut, 1);
    if (!connection->is_leaving) atomic_fetch_add(&connections->leaving, 1);
    connection->is_leaving = true;
    shutdown(connection->descriptor,
             SHUT_RDWR); /* wakes the HTTP thread, which closes the connection */
    return true;
}

/* Gets the state of the TCP connection. Returns false for a unix socket. */
static bool connection_inquire(const struct server_connection *connection, struct tcp_info *out)
{
    socklen_t size = sizeof *out;
    return getsockopt(connection->descriptor, IPPROTO_TCP, TCP_INFO, out, &size) == 0 &&
           size >= offsetof(struct tcp_info, tcpi_notsent_bytes) + sizeof out->tcpi_notsent_bytes;
}

static bool is_read(const struct tcp_info *info)
{
    return !info->tcpi_unacked && !info->tcpi_notsent_bytes;
}

enum reading { READING_NOTHING, READING, READ_ALL };

/* Returns which of three cases holds: the client has acknowledged all bytes; at least ACKNOWLEDGED
 * bytes since the last call; or fewer. The library's writes do not show this, because the kernel
 * buffers megabytes. Unix sockets rely on the library's timer. */
static enum reading connection_look(struct server_connection *connection)
{
    struct tcp_info info;
    uint64_t before = connection->acknowledged;
    if (!connection_inquire(connection, &info)) return READ_ALL;
    connection->acknowledged = info.tcpi_bytes_acked;
    if (is_read(&info)) return READ_ALL;
    return connection->acknowledged - before >= ACKNOWLEDGED ? READING : READING_NOTHING;
}

/* Returns the next deadline of a connection whose deadline has passed; 0 means none. */
static uint64_t connection_extend(struct server_connection *connection, enum phase phase,
                                  uint64_t now_ns)
{
    uint64_t last_ns = atomic_load_explicit(&connection->last_ns, memory_order_relaxed);
    if (phase == PHASE_ANSWER && last_ns > now_ns && connection_look(connection) != READING_NOTHING)
        return deadline_earlier(now_ns + PATIENCE_NS, last_ns);
    /* the kernel may not have sent the end of the last answer yet */
    return phase == PHASE_IDLE && connection_look(connection) == READING ? now_ns + PATIENCE_NS : 0;
}

static void connection_check(struct server_connection *connection, uint64_t now_ns)
{
    uint64_t deadline_ns = atomic_load(&connection->deadline_ns);
    /* a result of 0 means that the library has read all bytes and the client has closed its side */
    char byte;
    if (recv(connection->descriptor, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0)
        shutdown(connection->descriptor, SHUT_RD); /* the answer can still be sent */
    if (deadline_ns > now_ns) return;
    enum phase phase = phase_of(deadline_ns);
    uint64_t later_ns = connection_extend(connection, phase, now_ns);
    if (later_ns)
        atomic_compare_exchange_strong(&connection->deadline_ns, &deadline_ns,
                                       (later_ns & ~PHASES) | phase);
    else
        (void)connection_shut(connection, deadline_ns);
}

void server_connections_check(struct server_connections *connections, uint64_t now_ns)
{
    SERVER_LOCK(&connections->mutex);
    struct server_connection *at;
    TAILQ_FOREACH(at, &connections->all, next) connection_check(at, now_ns);
}

/* --- the reserve ------------------------------------------------------------------------------ */

/* Returns the number of connections that must be shut down so that `free` new ones can be opened.
 * Connections that were already shut down do not count as open. */
static uint32_t connections_excess(struct server_connections *connections, uint32_t free)
{
    uint64_t open = atomic_load(&connections->open),
             kept = atomic_load(&connections->leaving) + connections->most - free;
    return connections->most && open > kept ? (uint32_t)(open - kept) : 0;
}

enum { RANK_OLD_HEAD, RANK_IDLE, RANK_YOUNG_HEAD, RANKS };

/* Under the mutex: lists the connections that wait for their clients. */
static size_t candidates_list(const struct server_connections *connections, uint64_t now_ns,
                              struct candidate *out)
{
    uint32_t waiting[ADDRESSES] = {0}, most = 0;
    size_t count = 0;
    struct server_connection *at;
    TAILQ_FOREACH(at, &connections->all, next)
    {
        if (count == connections->most) break;
        uint64_t deadline_ns = atomic_load(&at->deadline_ns);
        enum phase phase = phase_of(deadline_ns);
        if (phase != PHASE_HEAD && phase != PHASE_IDLE) continue;
        bool is_young = deadline_ns > now_ns + PATIENCE_NS - YOUNG_NS;
        unsigned rank = is_young ? RANK_YOUNG_HEAD : RANK_OLD_HEAD;
        out[count++] = (struct candidate){at, deadline_ns, phase == PHASE_IDLE ? RANK_IDLE : rank};
        if (++waiting[at->address] > most) most = waiting[at->address];
    }
    for (size_t i = 0; i < count; i++)
        if (2 * waiting[out[i].connection->address] < most) out[i].rank += RANKS;
    return count;
}

static int candidate_compare(const void *a, const void *b)
{
    const struct candidate *first = a, *second = b;
    if (first->rank != second->rank) return first->rank < second->rank ? -1 : 1;
    return (first->deadline_ns > second->deadline_ns) - (first->deadline_ns < second->deadline_ns);
}

static void connections_complain(struct server_connections *connections, uint64_t now_ns)
{
    if (now_ns - atomic_load(&connections->complained_ns) < COMPLAINT_NS) return;
    atomic_store(&connections->complained_ns, now_ns);
    server_log_message(
        SERVER_LOG_WARN, "connections_short",
        "fewer than %u of %u connections are free: connections that wait for their clients are "
        "closed, the oldest unfinished heads first; raise --max-connections",
        connections->reserve, connections->most);
}

/* Shuts down more connections than necessary, by half of the reserve. So the next new connection
 * does not need another sort. */
void server_connections_relieve(struct server_connections *connections, uint64_t now_ns)
{
    uint32_t reserve = connections->reserve, scarce = reserve / SCARCE_PART, done = 0;
    uint32_t wanted = connections_excess(connections, reserve),
             needed = connections_excess(connections, scarce), goal = wanted + reserve / 2;
    struct candidate *all = wanted ? malloc(connections->most * sizeof *all) : NULL;
    if (!all) return;
    pthread_mutex_lock(&connections->mutex);
    size_t count = candidates_list(connections, now_ns, all);
    qsort(all, count, sizeof *all, candidate_compare);
    bool is_ordinary = true;
    for (size_t i = 0; i < count && done < goal; i++) {
        if (is_ordinary && all[i].rank > RANK_IDLE) {
            is_ordinary = false;
            if (done >= needed) break;
            goal = needed + scarce;
        }
        done += connection_shut(all[i].connection, all[i].deadline_ns);
    }
    pthread_mutex_unlock(&connections->mutex);
    free(all);
    if (done) connections_complain(connections, now_ns);
}

/* --- the thread ------------------------------------------------------------------------------- */

/* Records how much the client has read. Returns true if the client has not read available data for
 * HASTE_NS. */
static bool connection_stalls(struct server_connection *connection, uint64_t now_ns)
{
    struct tcp_info info;
    if (!connection_inquire(connection, &info)) return false;
    if (info.tcpi_bytes_acked != connection->moved || is_read(&info)) {
        connection->moved = info.tcpi_bytes_acked;
        atomic_store(&connection->moved_ns, now_ns);
    }
    return now_ns - atomic_load(&connection->moved_ns) >= HASTE_NS;
}

/* While memory for answers is short, shuts down the client that has not read for the longest
 * time. */
static void connections_hasten(struct server_connections *connections, uint64_t now_ns)
{
    uint64_t refused = connections->budget ? atomic_load(&connections->budget->refused_answers) : 0;
    struct server_connection *at, *slowest = NULL;
    pthread_mutex_lock(&connections->mutex);
    TAILQ_FOREACH(at, &connections->all, next)
    {
        if (phase_of(atomic_load(&at->deadline_ns)) != PHASE_ANSWER) continue;
        if (!connection_stalls(at, now_ns)) continue;
        if (!slowest || atomic_load(&at->moved_ns) < atomic_load(&slowest->moved_ns)) slowest = at;
    }
    uint64_t deadline_ns = slowest ? atomic_load(&slowest->deadline_ns) : 0;
    if (refused != connections->refused_answers && phase_of(deadline_ns) == PHASE_ANSWER)
        (void)connection_shut(slowest, deadline_ns);
    pthread_mutex_unlock(&connections->mutex);
    connections->refused_answers = refused;
}

static void connections_watch(void *user, struct server_thread *thread)
{
    struct server_connections *connections = user;
    while (server_thread_pause(thread, atomic_load(&connections->open) ? SECOND_NS
                                                                       : SERVER_THREAD_FOREVER)) {
        uint64_t now_ns = gd_now_ns();
        server_connections_relieve(connections, now_ns);
        if (now_ns - connections->checked_ns < SECOND_NS / 2) continue;
        connections->checked_ns = now_ns;
        server_connections_check(connections, now_ns);
        connections_hasten(connections, now_ns);
    }
}

struct server_connections *server_connections_create(const struct server_budget *budget)
{
    struct server_connections *connections = calloc(1, sizeof *connections);
    if (!connections) return NULL;
    connections->budget = budget;
    TAILQ_INIT(&connections->all);
    pthread_mutex_init(&connections->mutex, NULL);
    connections->thread = server_thread_start(connections_watch, connections);
    if (connections->thread) return connections;
    server_connections_destroy(connections);
    return NULL;
}

void server_connections_destroy(struct server_connections *connections)
{
    if (!connections) return;
    server_thread_stop(connections->thread);
    pthread_mutex_destroy(&connections->mutex);
    free(connections);
}

void server_connections_limit(struct server_connections *connections, uint32_t most)
{
    connections->most = most;
    connections->reserve = (most + RESERVE_PART - 1) / RESERVE_PART;
}

uint32_t server_connections_active(struct server_connections *connections)
{
    uint32_t count = 0;
    struct server_connection *at;
    SERVER_LOCK(&connections->mutex);
    TAILQ_FOREACH(at, &connections->all, next)
    count += atomic_load_explicit(&at->is_active, memory_order_acquire);
    return count;
}

struct server_connections_statistics
server_connections_statistics(struct server_connections *connections)
{
    if (!connections) return (struct server_connections_statistics){0};
    return (struct server_connections_statistics){.open = atomic_load(&connections->open),
                                                  .cut = atomic_load(&connections->cut),
                                                  .refusals = atomic_load(&connections->refusals)};
}

/* --- one connection --------------------------------------------------------------------------- */

static void connection_set(struct server_connection *connection, enum phase phase,
                           uint64_t deadline_ns)
{
    atomic_store_explicit(&connection->deadline_ns, (deadline_ns & ~PHASES) | phase,
                          memory_order_relaxed);
}

/* Returns the group of an address; addresses of one IPv6 network (/64) share a group. */
static unsigned address_group(const struct sockaddr *client)
{
    uint64_t number = 0;
    if (client && client->sa_family == AF_INET) {
        number = ((const struct sockaddr_in *)client)->sin_addr.s_addr;
    } else if (client && client->sa_family == AF_INET6) {
        const struct in6_addr *address = &((const struct sockaddr_in6 *)client)->sin6_addr;
        memcpy(&number, address->s6_addr + (IN6_IS_ADDR_V4MAPPED(address) ? 8 : 0), sizeof number);
    }
    return (unsigned)((number * UINT64_C(0x9e3779b97f4a7c15)) >>
                      54); /* Fibonacci hashing: 10 bits */
}

struct server_connection *server_connection_open(struct server_connections *connections,
                                                 int descriptor, const struct sockaddr *client)
{
    struct server_connection *connection = calloc(1, sizeof *connection);
    if (!connection) return NULL;
    connection->connections = connections;
    connection->descriptor = descriptor;
    connection->address = address_group(client);
    connection_set(connection, PHASE_HEAD, gd_now_ns() + PATIENCE_NS);
    pthread_mutex_lock(&connections->mutex);
    TAILQ_INSERT_TAIL(&connections->all, connection, next);
    pthread_mutex_unlock(&connections->mutex);
    if (atomic_fetch_add(&connections->open, 1) == 0 ||
        connections_excess(connections, connections->reserve))
        server_thread_wake(connections->thread);
    return connection;
}

void server_connection_close(struct server_connection *connection)
{
    struct server_connections *connections = connection->connections;
    pthread_mutex_lock(&connections->mutex);
    TAILQ_REMOVE(&connections->all, connection, next);
    if (connection->is_leaving) atomic_fetch_sub(&connections->leaving, 1);
    pthread_mutex_unlock(&connections->mutex);
    atomic_fetch_sub(&connections->open, 1);
    free(connection);
}

void server_connection_ask(struct server_connection *connection, uint64_t now_ns)
{
    uint64_t deadline_ns = atomic_load_explicit(&connection->deadline_ns, memory_order_relaxed);
    if (phase_of(deadline_ns) == PHASE_IDLE)
        connection_set(connection, PHASE_HEAD, now_ns + PATIENCE_NS);
    atomic_store_explicit(&connection->is_active, true, memory_order_relaxed);
}

void server_connection_head(struct server_connection *connection, bool has_body, uint64_t now_ns)
{
    connection->body_started_ns = now_ns;
    connection->body_bytes = 0;
    connection_set(connection, PHASE_OTHER, has_body ? now_ns + PATIENCE_NS : NEVER);
}

void server_connection_body(struct server_connection *connection, size_t size, uint64_t now_ns)
{
    connection->body_bytes += size;
    uint64_t slowest_ns = connection->body_bytes / BODY_RATE * SECOND_NS;
    connection_set(connection, PHASE_OTHER,
                   deadline_earlier(now_ns, connection->body_started_ns + slowest_ns) +
                       PATIENCE_NS);
}

void server_connection_work(struct server_connection *connection)
{
    connection_set(connection, PHASE_OTHER, NEVER);
}

void server_connection_answer(struct server_connection *connection, size_t size, bool is_stream,
                              uint64_t now_ns)
{
    uint64_t last_ns =
        is_stream ? NEVER : now_ns + PATIENCE_NS + (uint64_t)size / ANSWER_RATE * SECOND_NS;
    bool is_looked_at = is_stream || size > LONG_ANSWER;
    connection->is_short = !is_stream && size < ANSWER_RATE;
    atomic_store_explicit(&connection->moved_ns, now_ns, memory_order_relaxed);
    atomic_store_explicit(&connection->last_ns, last_ns, memory_order_relaxed);
    connection_set(connection, PHASE_ANSWER, is_looked_at ? now_ns + PATIENCE_NS : last_ns);
}

void server_connection_end(struct server_connection *connection)
{
    uint64_t deadline_ns = atomic_load_explicit(&connection->deadline_ns, memory_order_relaxed);
    atomic_store_explicit(&connection->is_active, false, memory_order_release);
    connection_set(connection, PHASE_IDLE,
                   connection->is_short ? deadline_ns : gd_now_ns() + PATIENCE_NS);
}

void server_connection_refuse(struct server_connection *connection)
{
    atomic_fetch_add(&connection->connections->refusals, 1);
}
