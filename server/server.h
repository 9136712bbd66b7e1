/* Server: creates and connects the daemon's objects, starts and stops them.
 *
 * Shutdown:
 * - Drain delay: for drain_delay_ms, /readyz answers 503 and answers close their connections.
 *   Everything else continues.
 * - Draining: no new connections are accepted. At the drain deadline the workers are cancelled.
 * - When every deferred exchange has finished, HTTP stops.
 * - The use counts of surfaces and the cached fields are stored, within ten seconds.
 * - The server's objects are destroyed. */
#pragma once

#include <stdbool.h>

#include "server/query/api.h"
#include "server/surfaces/scrub.h"

struct server_connections;
struct server_http;
struct server_thread;
struct server_tls;

struct server {
    struct server_host host; /* the objects that every request needs; owned */
    struct server_api api;   /* the other objects that handlers need; owned */
    struct server_config config;
    struct server_tls *tls; /* NULL means HTTP without TLS */
    struct server_budget budget;
    struct server_field_store *field_store; /* NULL means nothing is stored */
    struct server_scrub *scrub;             /* NULL means stored files are not verified */
    struct server_thread *deadlines;        /* ticks while there are deadlines */
    struct server_thread *trimmer;          /* trims the heap */
    struct server_connections *connections;
    struct server_http *http;
};

/* Starts everything. The last step is to listen on the socket (server_address_bind), which then
 * belongs to the server. On failure, returns NULL with a sentence in `error`. */
struct server *server_start(const struct server_config *config, int listening,
                            char error[SERVER_ERROR]);

/* Sets settings, callbacks and references to the server in `host` and `api`. Creates nothing. */
void server_connect(struct server *server);

/* After server_connect: creates the table of jobs and starts the threads. Returns false if there is
 * no memory or no thread. */
bool server_start_jobs(struct server *server);

/* Destroys registry, caches of surfaces and their threads, after the workers were cancelled. */
void server_surfaces_destroy(struct server *server);

/* Reads keys and certificates again. If this fails, the old ones stay in use. Only one thread at a
 * time may call this function. */
void server_reload(struct server *server);

/* Drains, stops and frees the server. Takes at most drain_delay_ms, drain_ms and a few
 * seconds, unless a thread does not return; main.c limits that. */
void server_stop(struct server *server);

/* --- steps of a request, called by HTTP (router.c) -------------------------------------------- */

/* Called after the headers: sets the id, checks framing, Host and Origin, finds the route, checks
 * the key and prepares the body. If it replies with response.close, the body is not read. */
void server_router_begin(struct server_exchange *exchange);

/* Called after the body: calls the handler, or starts a job if the client prefers that. Returns
 * with a reply, or with `work` set: then the caller submits the exchange. */
void server_router_end(struct server_exchange *exchange);

/* Sets the deadline and calls the handler. Returns like server_router_end. */
void server_router_dispatch(struct server_exchange *exchange);

/* --- metrics (gauges.c) ----------------------------------------------------------------------- */

/* Appends the metrics of a tenant, its keys and its jobs as text for Prometheus. If `tenant` is
 * NULL, appends those of the whole daemon. `user` is the struct server. Thread-safe. */
void server_gauges_write(void *user, const char *tenant, struct proto_writer *writer);
