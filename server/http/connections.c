/* See connections.h.
 *
 * DESIGN. One mutex guards the list, which is in the order of opening. A deadline is atomic, and
 * its two low bits say what it is of: its connection's thread sets it, the cutting thread reads it
 * and may exchange it for another if it is the same still. A connection leaves the list before its
 * socket is closed, so that a socket that is shut down under the mutex is never another's. */
#include "server/http/connections.h"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "gd/control.h"
#include "server/base/log.h"
#include "server/base/thread.h"
#include "server/http/wire.h"

#define SECOND_NS UINT64_C(1000000000)
#define HEAD_NS   (30 * SECOND_NS) /* for a handshake and a request's headers */
/* for any answer, and beyond it as long as it takes at this rate */
#define ANSWER_NS      (30 * SECOND_NS)
#define BYTES_A_SECOND 16384
#define TAKING_NS      (30 * SECOND_NS) /* between two looks at what a client has taken */
#define TAKING_BYTES                                                                               \
    (TAKING_NS / SECOND_NS * BYTES_A_SECOND /                                                      \
     2) /* least that it takes meanwhile: acknowledgements come in lumps */
/* shorter answers are taken at once, or not in time */
#define LONG_BYTES 65536
#define IDLE_NS    (30 * SECOND_NS) /* between requests; not more than for an answer */
/* of the reserve: when fewer are free, any connection that waits may be cut */
#define SCARCE_PART  2
#define RESERVE_PART 8                /* of all connections: so many are kept free */
#define COMPLAINT_NS (60 * SECOND_NS) /* between two lines of the log about a shortage */

#define ADDRESSES 1024 /* groups of addresses: by a hash */

/* What a deadline is of, in its low bits. */
enum kind { KIND_OTHER, KIND_IDLE, KIND_HEAD, KIND_ANSWER };
#define KINDS UINT64_C(3)
#define NEVER (UINT64_MAX & ~KINDS)

struct entry {
    struct server_connection connection; /* first */
    struct server_connections *connections;
    struct entry *next, *previous;
    int descriptor;
    unsigned address;                           /* the group that its client's address is in */
    atomic_uint_least64_t deadline_ns, last_ns; /* last: of an answer whose deadline may be moved */
    bool is_leaving;                            /* it was shut down; under the lock */
    /* bytes that the client had acknowledged when it was last looked at; of the thread */
    uint64_t taken;
};

struct server_connections {
    pthread_mutex_t lock; /* of the list */
    struct entry *first, *last;
    struct server_thread *thread;
    atomic_uint_least64_t open, leaving, cut, faults;
    uint32_t most, reserve;            /* 0: no limit */
    uint64_t looked_ns, complained_ns; /* of the thread */
};

/* --- cutting ---------------------------------------------------------------------------------- */

static enum kind kind_of(uint64_t deadline_ns)
{
    return (enum kind)(deadline_ns & KINDS);
}

/* Under the lock. False: its thread has set another deadline meanwhile. */
static bool cut(struct entry *entry, uint64_t deadline_ns, bool is_incident)
{
    if (!atomic_compare_exchange_strong(&entry->deadline_ns, &deadline_ns, NEVER)) return false;
    if (is_incident) atomic_fetch_add(&entry->connections->cut, 1);
    if (!entry->is_leaving) atomic_fetch_add(&entry->connections->leaving, 1);
    entry->is_leaving = true;
    shutdown(entry->descriptor, SHUT_RDWR); /* its thread sees that, and closes it */
    return true;
}

enum taking { TAKING_NOTHING, TAKING_SOME, TAKEN_ALL };

/* What the client has done since it was last looked at. A socket that does not tell is left to the
 * library's timer (http.c). */
static enum taking look_at_client(struct entry *entry)
{
    struct tcp_info facts = {0};
    socklen_t size = sizeof facts;
    bool is_told =
        getsockopt(entry->descriptor, IPPROTO_TCP, TCP_INFO, &facts, &size) == 0 &&
        size >= offsetof(struct tcp_info, tcpi_notsent_bytes) + sizeof facts.tcpi_notsent_bytes;
    uint64_t before = entry->taken;
    if (!is_told) return TAKEN_ALL;
    entry->taken = facts.tcpi_bytes_acked;
    if (!facts.tcpi_unacked && !facts.tcpi_notsent_bytes) return TAKEN_ALL;
    return entry->taken - before >= TAKING_BYTES ? TAKING_SOME : TAKING_NOTHING;
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* The time that is left to one whose deadline has passed; 0: none. */
static uint64_t prolong(struct entry *entry, enum kind kind, uint64_t now_ns)
{
    uint64_t last_ns = atomic_load_explicit(&entry->last_ns, memory_order_relaxed);
    if (kind == KIND_ANSWER && last_ns > now_ns && look_at_client(entry) != TAKING_NOTHING)
        return earlier(now_ns + TAKING_NS, last_ns);
    /* of an answer, still */
    return kind == KIND_IDLE && look_at_client(entry) == TAKING_SOME ? now_ns + IDLE_NS : 0;
}

void server_connections_cut(struct server_connections *connections, uint64_t now_ns)
{
    pthread_mutex_lock(&connections->lock);
    for (struct entry *entry = connections->first; entry; entry = entry->next) {
        uint64_t deadline_ns = atomic_load(&entry->deadline_ns);
        enum kind kind = kind_of(deadline_ns);
        if (deadline_ns > now_ns) continue;
        uint64_t later_ns = prolong(entry, kind, now_ns);
        if (later_ns)
            atomic_compare_exchange_strong(&entry->deadline_ns, &deadline_ns,
                                           (later_ns & ~KINDS) | kind);
        else
            (void)cut(entry, deadline_ns, kind != KIND_IDLE);
    }
    pthread_mutex_unlock(&connections->lock);
}

/* --- a shortage ------------------------------------------------------------------------------- */

#define AGES        128
#define AGE_NS      (SECOND_NS / 4)
#define OLD_AGES    (4 + 1) /* of a head that has not come within a second */
#define GROUPS      3       /* old heads; idle connections; heads that have just begun */
#define ALL_OF_TIER (GROUPS * AGES)
#define NOBODY      (2 * ALL_OF_TIER) /* the rank of one that stays */

/* Of a shortage: how many connections of each group of addresses wait for their clients. */
struct shortage {
    uint64_t now_ns;
    uint32_t waiting[ADDRESSES], most; /* most: of one group */
    bool is_bad;                       /* nearly nothing is free */
};

static bool is_waiting(uint64_t deadline_ns)
{
    return kind_of(deadline_ns) == KIND_HEAD || kind_of(deadline_ns) == KIND_IDLE;
}

/* Under the lock. */
static void count_waiting(const struct server_connections *connections, struct shortage *shortage)
{
    for (const struct entry *entry = connections->first; entry; entry = entry->next) {
        uint32_t *count = &shortage->waiting[entry->address];
        *count += is_waiting(atomic_load(&entry->deadline_ns));
        if (*count > shortage->most) shortage->most = *count;
    }
}

/* 0 is the first to go. Of each tier: heads that are overdue, the oldest first, then connections
 * that are idle, then the other heads. The second tier are addresses that have less than half as
 * many as the one that has most. These, and heads that have just begun, go only when it is bad. */
static unsigned rank_of(const struct shortage *shortage, const struct entry *entry,
                        uint64_t deadline_ns)
{
    if (!is_waiting(deadline_ns)) return NOBODY;
    uint64_t left = deadline_ns > shortage->now_ns ? (deadline_ns - shortage->now_ns) / AGE_NS : 0;
    bool is_idle = kind_of(deadline_ns) == KIND_IDLE,
         is_young = !is_idle && left > HEAD_NS / AGE_NS - OLD_AGES;
    bool is_of_few = 2 * shortage->waiting[entry->address] < shortage->most;
    if (!shortage->is_bad && (is_young || is_of_few)) return NOBODY;
    return is_of_few * ALL_OF_TIER + (is_young ? 2 : is_idle) * AGES +
           (unsigned)earlier(left, AGES - 1);
}

/* Under the lock: the rank of the last one to go, and how many of that rank go, when so many are
 * to. */
static unsigned find_last_rank(const struct server_connections *connections,
                               const struct shortage *shortage, uint32_t *wanted)
{
    uint32_t counts[NOBODY + 1] = {0};
    unsigned rank = 0;
    for (const struct entry *entry = connections->first; entry; entry = entry->next)
        counts[rank_of(shortage, entry, atomic_load(&entry->deadline_ns))]++;
    while (rank < NOBODY && counts[rank] < *wanted) *wanted -= counts[rank++];
    return rank;
}

/* Under the lock. */
static uint32_t cut_oldest(struct server_connections *connections, uint64_t now_ns, uint32_t wanted,
                           bool is_bad)
{
    struct shortage shortage = {.now_ns = now_ns, .is_bad = is_bad};
    uint32_t count = 0;
    count_waiting(connections, &shortage);
    unsigned last = find_last_rank(connections, &shortage, &wanted);
    for (struct entry *entry = connections->first; entry; entry = entry->next) {
        uint64_t deadline_ns = atomic_load(&entry->deadline_ns);
        unsigned rank = rank_of(&shortage, entry, deadline_ns);
        if (rank > last || rank == NOBODY || (rank == last && !wanted)) continue;
        if (rank == last) wanted--;
        count += cut(entry, deadline_ns, kind_of(deadline_ns) == KIND_HEAD);
    }
    return count;
}

static void complain(struct server_connections *connections, uint32_t count, uint64_t now_ns)
{
    if (!count || now_ns - connections->complained_ns < COMPLAINT_NS) return;
    connections->complained_ns = now_ns;
    server_log_message(SERVER_LOG_WARN, "connections_short",
                       "fewer than %u of %u connections are free: those that keep the daemon "
                       "waiting are closed, the "
                       "oldest unfinished heads first (connections_cut_total)",
                       connections->reserve, connections->most);
}

/* How many more are open, and stay so, than leave `free` places. */
static uint32_t excess(struct server_connections *connections, uint32_t free)
{
    uint64_t leaving = atomic_load(&connections->leaving), open = atomic_load(&connections->open);
    uint64_t kept = leaving + connections->most - free;
    return connections->most && open > kept ? (uint32_t)(open - kept) : 0;
}

/* Half of the places more than are missing, so that none is looked for at each connection that
 * comes. */
void server_connections_relieve(struct server_connections *connections, uint64_t now_ns)
{
    uint32_t reserve = connections->reserve, least = reserve / SCARCE_PART,
             wanted = excess(connections, reserve);
    if (!wanted) return;
    pthread_mutex_lock(&connections->lock);
    uint32_t count = cut_oldest(connections, now_ns, wanted + reserve / 2, false);
    wanted = excess(connections, least);
    if (wanted) count += cut_oldest(connections, now_ns, wanted + least, true);
    pthread_mutex_unlock(&connections->lock);
    complain(connections, count, now_ns);
}

/* --- the thread ------------------------------------------------------------------------------- */

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
        if (is_ended(entry)) /* its thread looks again; an answer can still leave */
            shutdown(entry->descriptor, SHUT_RD);
    pthread_mutex_unlock(&connections->lock);
}

static void look(void *user, struct server_thread *thread)
{
    struct server_connections *connections = user;
    while (server_thread_pause(thread, atomic_load(&connections->open) ? SECOND_NS
                                                                       : SERVER_THREAD_FOREVER)) {
        uint64_t now_ns = gd_now_ns();
        server_connections_relieve(connections, now_ns);
        if (now_ns - connections->looked_ns < SECOND_NS / 2) continue;
        connections->looked_ns = now_ns;
        server_connections_cut(connections, now_ns);
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

/* --- one connection --------------------------------------------------------------------------- */

void server_connections_limit(struct server_connections *connections, uint32_t most)
{
    connections->most = most;
    connections->reserve = (most + RESERVE_PART - 1) / RESERVE_PART;
}

static uint64_t deadline_of(const struct server_connection *connection)
{
    return atomic_load_explicit(&((const struct entry *)connection)->deadline_ns,
                                memory_order_relaxed);
}

static void set_deadline(struct server_connection *connection, enum kind kind, uint64_t deadline_ns)
{
    atomic_store_explicit(&((struct entry *)connection)->deadline_ns, (deadline_ns & ~KINDS) | kind,
                          memory_order_relaxed);
}

static void insert(struct server_connections *connections, struct entry *entry)
{
    pthread_mutex_lock(&connections->lock);
    entry->previous = connections->last;
    *(entry->previous ? &entry->previous->next : &connections->first) = entry;
    connections->last = entry;
    pthread_mutex_unlock(&connections->lock);
    if (atomic_fetch_add(&connections->open, 1) == 0 || excess(connections, connections->reserve))
        server_thread_wake(connections->thread);
}

static void remove_entry(struct entry *entry)
{
    struct server_connections *connections = entry->connections;
    pthread_mutex_lock(&connections->lock);
    *(entry->previous ? &entry->previous->next : &connections->first) = entry->next;
    *(entry->next ? &entry->next->previous : &connections->last) = entry->previous;
    if (entry->is_leaving) atomic_fetch_sub(&connections->leaving, 1);
    pthread_mutex_unlock(&connections->lock);
    atomic_fetch_sub(&connections->open, 1);
}

/* Addresses of one IPv6 network count as one. */
static unsigned group_of(const struct sockaddr *client)
{
    uint64_t number = 0;
    if (client && client->sa_family == AF_INET) {
        number = ((const struct sockaddr_in *)client)->sin_addr.s_addr;
    } else if (client && client->sa_family == AF_INET6) {
        const struct in6_addr *address = &((const struct sockaddr_in6 *)client)->sin6_addr;
        memcpy(&number, address->s6_addr + (IN6_IS_ADDR_V4MAPPED(address) ? 8 : 0), sizeof number);
    }
    /* Fibonacci hashing: 10 bits */
    return (unsigned)((number * UINT64_C(0x9e3779b97f4a7c15)) >> 54);
}

struct server_connection *server_connections_open(struct server_connections *connections,
                                                  int descriptor, const struct sockaddr *client,
                                                  bool is_encrypted)
{
    struct entry *entry = calloc(1, sizeof *entry);
    if (!entry) return NULL;
    entry->connection.is_encrypted = is_encrypted;
    entry->connections = connections;
    entry->descriptor = descriptor;
    entry->address = group_of(client);
    set_deadline(&entry->connection, KIND_HEAD, gd_now_ns() + HEAD_NS);
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

/* The time of a head runs from its first byte on; the first one's, from the connection's beginning.
 */
void server_connection_received(struct server_connection *connection)
{
    struct entry *entry = (struct entry *)connection;
    if (connection->grammar.fault) atomic_fetch_add(&entry->connections->faults, 1);
    bool was_idle = kind_of(deadline_of(connection)) == KIND_IDLE;
    if (was_idle && server_grammar_is_in_head(&connection->grammar))
        set_deadline(connection, KIND_HEAD, gd_now_ns() + HEAD_NS);
}

void server_connection_ask(struct server_connection *connection)
{
    atomic_store_explicit(&connection->is_asked, true, memory_order_relaxed);
}

void server_connection_begin(struct server_connection *connection)
{
    connection->is_busy = true;
    set_deadline(connection, KIND_OTHER, NEVER);
}

void server_connection_answer(struct server_connection *connection, size_t size, bool is_stream,
                              uint64_t now_ns)
{
    uint64_t last_ns =
        is_stream ? NEVER : now_ns + ANSWER_NS + (uint64_t)size / BYTES_A_SECOND * SECOND_NS;
    bool is_long = is_stream || size > LONG_BYTES;
    connection->is_brief = !is_stream && size < BYTES_A_SECOND;
    atomic_store_explicit(&((struct entry *)connection)->last_ns, last_ns, memory_order_relaxed);
    set_deadline(connection, KIND_ANSWER, is_long ? now_ns + TAKING_NS : last_ns);
}

void server_connection_end(struct server_connection *connection)
{
    connection->is_busy = false;
    atomic_store_explicit(&connection->is_asked, false, memory_order_release);
    if (server_grammar_is_in_head(&connection->grammar))
        set_deadline(connection, KIND_HEAD, gd_now_ns() + HEAD_NS);
    else
        set_deadline(connection, KIND_IDLE,
                     connection->is_brief ? deadline_of(connection) : gd_now_ns() + IDLE_NS);
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

struct server_connections_statistics
server_connections_statistics(struct server_connections *connections)
{
    if (!connections) return (struct server_connections_statistics){0};
    return (struct server_connections_statistics){.open = atomic_load(&connections->open),
                                                  .cut = atomic_load(&connections->cut),
                                                  .faults = atomic_load(&connections->faults)};
}
