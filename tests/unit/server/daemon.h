/* A daemon without a network: requests pass through router, handlers, workers and the registry's
 * writer, one at a time, and the test gets the answers. */
#pragma once

#include "support.h"

#include <stdio.h>
#include <unistd.h>

#include "server/base/thread.h"
#include "server/exchange/events.h"
#include "server/jobs/job_table.h"
#include "server/surfaces/registry.h"
#include "server/exchange/reply.h"
#include "server/server.h"

static struct server daemon_server;
static sem_t daemon_finished;
/* true if an exchange has finished before the state of its handler was freed, which is an error of
 * the server */
static bool daemon_had_state;

static inline void daemon_finish(struct server_exchange *exchange)
{
    daemon_had_state |= exchange->state != NULL;
    server_reply_seal(exchange);
    sem_post(&daemon_finished);
}

static inline bool daemon_is_gone(struct server_exchange *exchange)
{
    (void)exchange;
    return false;
}

static const struct server_transport daemon_transport = {.finish = daemon_finish,
                                                         .is_gone = daemon_is_gone};

/* Starts the daemon with a store, and takes ownership of the store. */
static inline void daemon_start(struct server_store *store)
{
    struct server *server = &daemon_server;
    assert_non_null(store);
    memset(server, 0, sizeof *server);
    server->config = (struct server_config){.timeout_ms = 10000,
                                            .max_body = 1 << 20,
                                            .max_faces = 1000,
                                            .queue_length = 10,
                                            .job_ttl_s = 60,
                                            .max_jobs = 10};
    server_budget_init(&server->budget, 64 << 20);
    server->host.workspaces = server_workspaces_create(&server->budget, 1);
    server->host.workers = server_workers_create(1, 10);
    server->api.cache = server_cache_create(&server->budget, server->host.workers);
    server->api.registry = server_registry_create(store, &server->budget);
    server->api.writer = server_workers_create(1, UINT32_MAX);
    server->api.lister = server_workers_create(1, UINT32_MAX);
    server->api.loader =
        server_loader_create(&(struct server_loader_parts){.budget = &server->budget,
                                                           .workers = server->host.workers,
                                                           .cache = server->api.cache,
                                                           .registry = server->api.registry,
                                                           .max_faces = 1000});
    server->host.metrics = server_metrics_create(proto_routes, proto_route_count);
    server->host.events = server_events_create();
    server_connect(server);
    assert_true(server_start_jobs(server));
    sem_init(&daemon_finished, 0, 0);
}

/* Stops the daemon. Asserts that every byte of the budget was returned. */
static inline void daemon_stop(void)
{
    struct server *server = &daemon_server;
    server_workers_cancel(server->host.workers);
    while (atomic_load(&server->host.deferred)) usleep(1000);
    server_thread_stop(server->deadlines);
    server_job_table_destroy(server->api.jobs);
    server_events_destroy(server->host.events);
    server_surfaces_destroy(server);
    server_workers_destroy(server->host.workers);
    server_workers_destroy(server->host.waiters);
    server_workers_destroy(server->host.batch_readers);
    server_workspaces_destroy(server->host.workspaces);
    server_metrics_destroy(server->host.metrics);
    assert_int_equal(server->budget.total, 0);
    assert_false(daemon_had_state);
}

struct daemon_request {
    const char *tenant; /* NULL: none */
    const char *method, *target;
    /* "Name: value" lines in addition to Host, and to Content-Length if there is a body; may be
       NULL */
    const char *headers;
    const char *body; /* NULL: none */
};

static inline void daemon_add_headers(struct server_exchange *exchange, char *lines)
{
    for (char *line; (line = strsep(&lines, "\n"));) {
        char *colon = strchr(line, ':');
        if (!colon) continue;
        *colon = '\0';
        server_exchange_add_header(exchange, line, colon + 2);
    }
}

/* Begins a request. The caller keeps the headers. */
static inline struct server_exchange *daemon_begin(const char *method, const char *target,
                                                   char *headers)
{
    struct server_exchange *exchange =
        server_exchange_create(&daemon_server.host, &daemon_transport, target);
    exchange->method = method;
    server_exchange_add_header(exchange, "Host", "localhost");
    daemon_add_headers(exchange, headers);
    const char *fault = server_exchange_read_head(exchange, "HTTP/1.1");
    if (fault) exchange->fault = fault;
    server_router_begin(exchange);
    return exchange;
}

static inline void daemon_end(struct server_exchange *exchange, const char *body)
{
    if (!exchange->response.status && body) server_body_append(&exchange->body, body, strlen(body));
    server_router_end(exchange);
    if (exchange->response.status) {
        server_reply_seal(exchange);
    } else {
        server_exchange_submit(exchange);
        sem_wait(&daemon_finished);
    }
}

/* Sends a request. Returns the answered exchange, which the caller destroys. */
static inline struct server_exchange *daemon_ask(struct daemon_request request)
{
    char headers[512]; /* the headers are not used after this function returns */
    int size = snprintf(headers, sizeof headers, "%s", request.headers ? request.headers : "");
    if (request.body)
        snprintf(headers + size, sizeof headers - (size_t)size, "\nContent-Length: %zu",
                 strlen(request.body));
    struct server_exchange *exchange = daemon_begin(request.method, request.target, headers);
    if (request.tenant) exchange->tenant = request.tenant;
    daemon_end(exchange, request.body);
    return exchange;
}

static inline const char *daemon_header(const struct server_exchange *exchange, const char *name)
{
    for (uint32_t i = 0; i < exchange->response.header_count; i++)
        if (strcmp(exchange->response.headers[i].name, name) == 0)
            return exchange->response.headers[i].value;
    return NULL;
}

/* Sends a request and returns the answer as a text: "201 {…}". */
static inline const char *daemon_answer(struct daemon_request request)
{
    static char text[65536];
    struct server_exchange *exchange = daemon_ask(request);
    snprintf(text, sizeof text, "%u %.*s", exchange->response.status,
             exchange->response.body ? (int)exchange->response.size : 0,
             exchange->response.body ? (const char *)exchange->response.body : "");
    server_exchange_destroy(exchange);
    return text;
}

static inline unsigned daemon_status(struct daemon_request request)
{
    struct server_exchange *exchange = daemon_ask(request);
    unsigned status = exchange->response.status;
    server_exchange_destroy(exchange);
    return status;
}
