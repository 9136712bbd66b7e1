/* See wire.h. */
#include "server/http/wire.h"

#include <dlfcn.h>
#include <errno.h>
#include <gnutls/gnutls.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "server/http/connections.h"

#define DESCRIPTORS     131072 /* more than a daemon has open: see SERVER_CONFIG_CONNECTIONS */
#define DRAIN_BYTES     65536
#define ACCEPT_PAUSE_NS 10000000

/* By the socket's number. An entry is the thread's that serves the connection. */
static _Atomic(struct server_connection *) watched[DESCRIPTORS];

bool server_wire_attach(int descriptor, struct server_connection *connection)
{
    if (descriptor < 0 || descriptor >= DESCRIPTORS) return false;
    atomic_store_explicit(&watched[descriptor], connection, memory_order_relaxed);
    return true;
}

void server_wire_detach(int descriptor)
{
    atomic_store_explicit(&watched[descriptor], NULL, memory_order_relaxed);
}

static struct server_connection *find(int descriptor)
{
    if (descriptor < 0 || descriptor >= DESCRIPTORS) return NULL;
    return atomic_load_explicit(&watched[descriptor], memory_order_relaxed);
}

/* --- the filter ------------------------------------------------------------------------------- */

static size_t give_ending(struct server_connection *connection, char *bytes, size_t size)
{
    size_t given = strnlen(connection->ending, size);
    memcpy(bytes, connection->ending, given);
    connection->ending += given;
    return given;
}

/* Takes `size` bytes that came into a buffer of `capacity`; returns how many the library gets. 0:
 * an end that needs no ending. */
static size_t filter(struct server_connection *connection, char *bytes, size_t size,
                     size_t capacity)
{
    size_t right = server_grammar_follow(&connection->grammar, bytes, size);
    server_connection_received(connection);
    if (!connection->grammar.fault) return size;
    connection->ending = server_grammar_ending(&connection->grammar);
    return right + give_ending(connection, bytes + right, capacity - right);
}

/* What is still to be read of a faulty connection, if any; then the library waits in vain, or sees
 * the end. */
static size_t read_faulty(struct server_connection *connection, char *bytes, size_t capacity,
                          bool *is_end)
{
    size_t given = give_ending(connection, bytes, capacity);
    *is_end = !given && !*server_grammar_ending(&connection->grammar);
    return given;
}

/* A client whose bytes are left unread when its connection is closed may lose the answer to a
 * reset. */
static void drain(int descriptor)
{
    char bytes[4096];
    for (size_t total = 0; total < DRAIN_BYTES; total += sizeof bytes)
        if (recvfrom(descriptor, bytes, sizeof bytes, MSG_DONTWAIT, NULL, NULL) <= 0) return;
}

/* --- what the library calls ------------------------------------------------------------------- */

/* As recv(2). */
__attribute__((visibility("default"))) ssize_t recv(int descriptor, void *bytes, size_t capacity,
                                                    int flags)
{
    struct server_connection *connection = find(descriptor);
    bool is_end = false;
    if (!connection || connection->is_encrypted)
        return recvfrom(descriptor, bytes, capacity, flags, NULL, NULL);
    if (connection->ending) {
        size_t given = read_faulty(connection, bytes, capacity, &is_end);
        if (given || is_end) return (ssize_t)given;
        errno = EAGAIN;
        return -1;
    }
    ssize_t size = recvfrom(descriptor, bytes, capacity, flags, NULL, NULL);
    if (size <= 0) return size;
    size_t given = filter(connection, bytes, (size_t)size, capacity);
    if (connection->ending) drain(descriptor);
    if (connection->ending && !*server_grammar_ending(&connection->grammar))
        shutdown(descriptor, SHUT_RD); /* look again */
    return (ssize_t)given;
}

/* As accept4(2). The library's thread that has no connection tries again at once when there is no
 * descriptor left, for as long as that lasts (others wait for one of theirs to end): so a failure
 * for want of them takes a moment. */
__attribute__((visibility("default"))) int accept4(int descriptor, struct sockaddr *address,
                                                   socklen_t *size, int flags)
{
    const struct timespec moment = {.tv_nsec = ACCEPT_PAUSE_NS};
    int client = (int)syscall(SYS_accept4, descriptor, address, size, flags);
    if (client >= 0 || (errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM))
        return client;
    int error = errno;
    nanosleep(&moment, NULL);
    errno = error;
    return client;
}

static ssize_t (*library_record_recv)(gnutls_session_t, void *, size_t);

static void find_record_recv(void)
{
    void *found = dlsym(RTLD_NEXT, "gnutls_record_recv");
    memcpy(&library_record_recv, &found, sizeof found);
}

/* As GnuTLS documents it. */
__attribute__((visibility("default"))) ssize_t gnutls_record_recv(gnutls_session_t session,
                                                                  void *bytes, size_t capacity)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    struct server_connection *connection = find(gnutls_transport_get_int(session));
    bool is_end = false;
    pthread_once(&once, find_record_recv);
    if (connection && connection->ending) {
        size_t given = read_faulty(connection, bytes, capacity, &is_end);
        return given || is_end ? (ssize_t)given : GNUTLS_E_AGAIN;
    }
    ssize_t size = library_record_recv(session, bytes, capacity);
    return connection && size > 0 ? (ssize_t)filter(connection, bytes, (size_t)size, capacity)
                                  : size;
}
