/* Server: the daemon's parts, wired together, and its way from start to stop.
 *
 * Shutdown: standing aside (for drain_delay_ms readyz says 503 and answers close their connections,
 * all else goes on) -> draining (no new connections) -> at the drain deadline workers are cancelled
 * -> every deferred exchange and the background have finished -> HTTP stops -> uses and fields are
 * persisted, within ten seconds -> the parts are destroyed. */
#ifndef SERVER_SERVER_H
#define SERVER_SERVER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/query/api.h"
#include "server/surfaces/scrub.h"

struct server_connections;
struct server_http;
struct server_thread;
struct server_tls;

struct server {
    struct server_host host; /* what requests use: owned, as are the next one's parts */
    struct server_api api;   /* what their handlers use besides */
    struct server_config config;
    struct server_tls *tls; /* NULL: HTTP without it */
    struct server_budget budget;
    struct server_field_store *field_store; /* NULL: nothing is stored */
    struct server_scrub *scrub;             /* NULL: stored files are not verified */
    struct server_thread *deadlines;        /* ticks while there is something to watch */
    struct server_thread *trimmer;          /* of the heap */
    struct server_connections *connections;
    struct server_http *http;
};

/* Starts everything, and listens last on the socket (server_address_bind), which becomes the
 * server's own. NULL with a sentence in `error`. */
struct server *server_start(const struct server_config *config, int listening, char *error,
                            size_t error_size);

/* Fills in what host and api have besides parts. */
void server_connect(struct server *server);

/* After server_connect: creates the table of jobs and starts the threads of deadlines and of the
 * heap. False without memory or thread. */
bool server_start_jobs(struct server *server);

/* Destroys the registry and all that is kept of surfaces, after the workers were cancelled. */
void server_surfaces_destroy(struct server *server);

/* Reads keys and certificates again; what can't be read stays as it was, and the log says so. By
 * one thread at a time. */
void server_reload(struct server *server);

/* Drains, stops, frees. Returns within drain_delay_ms, drain_ms and the few seconds that the last
 * answers need to leave. */
void server_stop(struct server *server);

/* gauges.c: appends the numbers of a tenant, its keys and jobs, as text for Prometheus. `tenant`
 * NULL: the numbers of the whole daemon. `user` is the struct server. Thread-safe. */
void server_gauges_write(void *user, const char *tenant, struct proto_writer *writer);

#endif
