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

#include "server/work/budget.h"
#include "server/config/config.h"
#include "server/query/api.h"
#include "server/exchange/metrics.h"
#include "server/surfaces/discretizations.h"
#include "server/surfaces/landmarks.h"
#include "server/surfaces/loader.h"
#include "server/surfaces/scrub.h"
#include "server/work/workers.h"
#include "server/work/budgeted_call.h"

struct server_access;
struct server_answer_streams;
struct server_batch_runner;
struct server_connections;
struct server_events;
struct server_http;
struct server_job_table;
struct server_thread;
struct server_tls;

/* The registry and all that is kept of surfaces. */
struct server_surfaces {
    struct server_cache *cache;
    struct server_registry *registry;
    struct server_workers *writer, *lister; /* one thread each, with queues that are never full */
    struct server_field_store *field_store; /* NULL: nothing is stored */
    struct server_landmarks *landmarks;     /* NULL: there are none */
    struct server_discretizations *discretizations;
    struct server_loader *loader;
    struct server_scrub *scrub; /* NULL: stored files are not verified */
};

struct server {
    struct server_host host; /* what requests use */
    struct server_api api;   /* what their handlers use besides */
    struct server_config config;
    struct server_access *access; /* NULL: there are no keys */
    struct server_tls *tls;       /* NULL: HTTP without it */
    struct server_budget budget;
    struct server_workspaces *workspaces;
    struct server_workers *workers;
    struct server_surfaces surfaces;
    struct server_metrics *metrics;
    struct server_events *events;
    struct server_answer_streams *streams;
    struct server_job_table *jobs;
    struct server_batch_runner *batches;
    struct server_thread *deadlines; /* ticks while there is something to watch */
    struct server_connections *connections;
    struct server_http *http;
};

/* Starts everything, and listens last on the socket (server_address_bind), which becomes the
 * server's own. NULL with a sentence in `error`. */
struct server *server_start(const struct server_config *config, int listening, char *error,
                            size_t error_size);

/* Fills in host and api with the parts that there are. */
void server_connect(struct server *server);

/* After server_connect: creates the table of jobs and starts the thread of deadlines. False without
 * memory or thread. */
bool server_start_jobs(struct server *server);

/* After the workers were cancelled. */
void server_surfaces_destroy(struct server_surfaces *surfaces);

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
