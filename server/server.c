/* See server.h. */
#include "server/server.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "gd/cpu.h"
#include "server/access/access.h"
#include "server/base/disk.h"
#include "server/base/thread.h"
#include "server/jobs/batch_runner.h"
#include "server/exchange/answer_stream.h"
#include "server/http/connections.h"
#include "server/exchange/events.h"
#include "server/http/http.h"
#include "server/jobs/job_table.h"
#include "server/http/tls.h"
#include "server/router.h"

/* Arrays of so many bytes go back to the system when they are freed. glibc would raise the bound
 * with the arrays' size, and keep what meshes and fields leave behind: half of the budget again,
 * after some hundred uploads. */
#define LARGE_BYTES (256 << 10)

#define JOB_ANSWERS_PART 8 /* of the memory budget: the answers of jobs at most */
/* of the memory budget: what is set aside for the memory of released fields */
#define SPARE_PART 16
#define SPARE_MOST ((size_t)256 << 20)
/* for the answers to leave, once there is nothing left to compute */
#define LAST_ANSWERS_NS UINT64_C(2000000000)
#define PERSIST_NS      UINT64_C(10000000000) /* for writing fields */
#define TICK_NS         UINT64_C(10000000)    /* the longest delay of a deadline */
#define WATCH_NS        UINT64_C(1000000000)  /* between two ticks without deferred requests */

void server_surfaces_destroy(struct server_surfaces *surfaces)
{
    server_scrub_destroy(surfaces->scrub);
    server_loader_destroy(surfaces->loader);
    server_workers_destroy(surfaces->writer);
    server_workers_destroy(surfaces->lister);
    server_registry_destroy(surfaces->registry);
    server_discretizations_destroy(surfaces->discretizations);
    server_landmarks_destroy(surfaces->landmarks);
    server_field_store_close(surfaces->field_store);
    server_cache_destroy(surfaces->cache);
}

/* Frees what there is of a server whose HTTP side does not run. */
static void server_destroy(struct server *server)
{
    server_connections_destroy(server->connections);
    server_batch_runner_destroy(server->batches);
    server_thread_stop(server->deadlines);
    server_job_table_destroy(server->jobs);
    server_answer_streams_destroy(server->streams);
    server_events_destroy(server->events);
    server_surfaces_destroy(&server->surfaces);
    server_workers_destroy(server->workers);
    server_workspaces_destroy(server->workspaces);
    gd_spare_memory(0);
    server_metrics_destroy(server->metrics);
    server_tls_close(server->tls);
    server_access_destroy(server->access);
    free(server);
}

static bool select_cpu(const struct server_config *config, char *error, size_t error_size)
{
    const char *name = server_config_cpus[config->cpu];
    if (gd_cpu_select(name) == GD_OK) return true;
    snprintf(error, error_size,
             "this machine lacks the instructions that --cpu %s asks for; write auto or baseline",
             name);
    return false;
}

/* The memory of released fields counts whether it is there or not: so that it may come and go
 * without being asked for. */
static bool set_spare_aside(struct server *server)
{
    size_t part = server->budget.limit / SPARE_PART, bytes = part < SPARE_MOST ? part : SPARE_MOST;
    gd_spare_memory(bytes);
    return server_budget_take(&server->budget, SERVER_BUDGET_SPARE, bytes);
}

static bool open_access(struct server *server, char *error, size_t error_size)
{
    const struct server_config *config = &server->config;
    if (*config->keys) server->access = server_access_create(config->keys, error, error_size);
    if (*config->keys && !server->access) return false;
    if (*config->tls_cert)
        server->tls = server_tls_open(config->tls_cert, config->tls_key, error, error_size);
    return !*config->tls_cert || server->tls;
}

static void watch_deadlines(void *user)
{
    struct server *server = user;
    server_thread_wake(server->deadlines);
}

static void server_tick(struct server *server, uint64_t now_ns)
{
    server_workers_expire(server->workers, now_ns);
    server_workers_expire(server->surfaces.writer, now_ns);
    server_workers_expire(server->surfaces.lister, now_ns);
    if (server_workers_cancelled(server->workers)) server_workers_cancel(server->surfaces.writer);
    server_job_table_expire(server->jobs, now_ns);
    server_events_tick(server->events, now_ns);
}

/* Waits for the next tick. While requests are deferred a wake doesn't hasten it: their number goes
 * to and from zero all the time. False: the thread is to end. */
static bool deadlines_wait(struct server *server, struct server_thread *thread)
{
    if (atomic_load(&server->host.deferred)) return server_thread_sleep(thread, TICK_NS);
    bool is_idle =
        server_job_table_is_empty(server->jobs) && server_events_count(server->events) == 0;
    return server_thread_pause(thread, is_idle ? SERVER_THREAD_FOREVER : WATCH_NS);
}

static void deadlines_run(void *user, struct server_thread *thread)
{
    while (deadlines_wait(user, thread)) server_tick(user, gd_now_ns());
}

bool server_start_jobs(struct server *server)
{
    const struct server_job_limits limits = {
        .jobs = (uint32_t)server->config.max_jobs,
        .answer_bytes = server->budget.limit / JOB_ANSWERS_PART,
        .ttl_s = server->config.job_ttl_s,
        .are_tenanted = server->access != NULL,
    };
    server->jobs = server_job_table_create(&server->host, &limits);
    server->api.jobs = server->jobs;
    if (server->jobs) server->deadlines = server_thread_start(deadlines_run, server);
    return server->deadlines;
}

void server_connect(struct server *server)
{
    const struct server_config *config = &server->config;
    server->host = (struct server_host){
        .budget = &server->budget,
        .workers = server->workers,
        .workspaces = server->workspaces,
        .events = server->events,
        .streams = server->streams,
        .metrics = server->metrics,
        .timeout_ms = config->timeout_ms,
        .slow_ms = config->slow_ms,
        .queue_length = config->queue_length,
        .has_cors_origins = config->cors_origins.count > 0,
        .dispatch = server_router_dispatch,
        .watch = watch_deadlines,
        .watcher = server,
        .api = &server->api,
    };
    server->api = (struct server_api){
        .config = config,
        .access = server->access,
        .registry = server->surfaces.registry,
        .writer = server->surfaces.writer,
        .lister = server->surfaces.lister,
        .cache = server->surfaces.cache,
        .landmarks = server->surfaces.landmarks,
        .discretizations = server->surfaces.discretizations,
        .write_metrics = server_gauges_write,
        .metrics_source = server,
        .loader = server->surfaces.loader,
    };
}

static struct server_store *open_store(const struct server_config *config, char *error,
                                       size_t error_size)
{
    if (config->store == SERVER_STORE_KIND_MEMORY) return server_store_memory_create();
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        return server_store_postgres_open(config->store_url, error, error_size);
    return server_store_local_open(config->data_dir, error, error_size);
}

/* Beside a database the folder, if one is given, is for what can be computed again. */
static bool open_field_store(struct server *server, char *error, size_t error_size)
{
    const struct server_config *config = &server->config;
    if (!*config->data_dir || config->store == SERVER_STORE_KIND_MEMORY) return true;
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        (void)server_disk_make_folder(config->data_dir);
    struct server_field_store *store = server_field_store_open(config->data_dir, &server->budget);
    if (store)
        server_field_store_follow(store, server->surfaces.registry);
    else
        snprintf(error, error_size, "there is no room or memory for the folder of fields in %s",
                 config->data_dir);
    server->surfaces.field_store = store;
    return store != NULL;
}

static bool create_surfaces(struct server *server, char *error, size_t error_size)
{
    const struct server_config *config = &server->config;
    struct server_surfaces *surfaces = &server->surfaces;
    surfaces->cache = server_cache_create(&server->budget, server->workers);
    surfaces->writer = server_workers_create(1, UINT32_MAX);
    surfaces->lister = server_workers_create(1, UINT32_MAX);
    surfaces->discretizations =
        server_discretizations_create(server->workspaces, (uint32_t)config->max_faces);
    if (!surfaces->cache || !surfaces->writer || !surfaces->lister || !surfaces->discretizations)
        return false;
    struct server_store *store = open_store(config, error, error_size);
    if (store) surfaces->registry = server_registry_create(store, &server->budget);
    if (!surfaces->registry || !open_field_store(server, error, error_size)) return false;
    const struct server_landmarks_parts landmarks = {.workers = server->workers,
                                                     .workspaces = server->workspaces,
                                                     .metrics = server->metrics,
                                                     .registry = surfaces->registry,
                                                     .field_store = surfaces->field_store,
                                                     .count = (uint32_t)config->landmarks};
    if (config->landmarks && !(surfaces->landmarks = server_landmarks_create(&landmarks)))
        return false;
    surfaces->loader = server_loader_create(&(struct server_loader_parts){
        .budget = &server->budget,
        .workers = server->workers,
        .cache = surfaces->cache,
        .registry = surfaces->registry,
        .field_store = config->persist_fields ? surfaces->field_store : NULL,
        .max_faces = (uint32_t)config->max_faces});
    if (!surfaces->loader || !server_loader_preload(surfaces->loader)) return false;
    if (!config->scrub_s || !store->verify) return true;
    surfaces->scrub = server_scrub_create(surfaces->registry, server->workers, config->scrub_s,
                                          config->scrub_rate);
    return surfaces->scrub != NULL;
}

static bool create_parts(struct server *server, char *error, size_t error_size)
{
    const struct server_config *config = &server->config;
    server_budget_init(&server->budget, config->memory_budget);
    if (config->max_answer < server->budget.largest_answer)
        server->budget.largest_answer = config->max_answer;
    if (!set_spare_aside(server)) return false;
    server->workspaces = server_workspaces_create(&server->budget, (uint32_t)config->workers);
    server->workers =
        server_workers_create((uint32_t)config->workers, (uint32_t)config->queue_length);
    if (server->workers && !server_workers_add_spare(server->workers)) return false;
    if (server->workers && server->access) server_workers_share(server->workers);
    server->metrics = server_metrics_create(proto_routes, proto_route_count);
    if (!server->workers || !server->workspaces || !server->metrics) return false;
    if (!create_surfaces(server, error, error_size)) return false;
    server->events = server_events_create();
    server->streams = server_answer_streams_create();
    server_connect(server);
    if (!server->events || !server->streams || !server_start_jobs(server)) return false;
    server->batches = server_batch_runner_create(&server->host, config, error, error_size);
    server->api.batches = server->batches;
    server->connections = server_connections_create(&server->budget);
    return server->batches && server->connections;
}

static bool server_serve(struct server *server, int listening, char *error, size_t error_size)
{
    if (!server_address_listen(listening, &server->config.listen, error, error_size)) return false;
    const struct server_http_parts parts = {
        .config = &server->config,
        .host = &server->host,
        .connections = server->connections,
        .tls = server->tls,
        .begin = server_router_begin,
        .end = server_router_end,
    };
    server->http = server_http_start(&parts, listening, error, error_size);
    return server->http != NULL;
}

struct server *server_start(const struct server_config *config, int listening, char *error,
                            size_t error_size)
{
    snprintf(error, error_size, "out of memory or threads");
    mallopt(M_MMAP_THRESHOLD, LARGE_BYTES);
    struct server *server = calloc(1, sizeof *server);
    if (!server) return NULL;
    server->config = *config;
    if (select_cpu(config, error, error_size) && open_access(server, error, error_size) &&
        create_parts(server, error, error_size) &&
        server_serve(server, listening, error, error_size))
        return server;
    if (server->workers) server_workers_cancel(server->workers);
    server_destroy(server);
    return NULL;
}

static void log_reload(const char *what, bool is_read, const char *error)
{
    if (is_read)
        server_log_message(SERVER_LOG_INFO, "reloaded", "%s", what);
    else
        server_log_message(SERVER_LOG_ERROR, "reload_failed", "%s stay as they were: %s", what,
                           error);
}

void server_reload(struct server *server)
{
    char error[512] = "out of memory";
    if (server->access)
        log_reload("keys", server_access_reload(server->access, error, sizeof error), error);
    if (server->tls)
        log_reload("certificates", server_tls_reload(server->tls, error, sizeof error), error);
}

/* --- the end ---------------------------------------------------------------------------------- */

static void pause_briefly(void)
{
    struct timespec pause = {.tv_nsec = 2000000};
    nanosleep(&pause, NULL);
}

/* Requests under way, and jobs, which no request waits for. */
static void wait_until_idle(struct server *server, uint64_t until_ns)
{
    while (
        (server_connections_active(server->connections) || atomic_load(&server->host.deferred)) &&
        gd_now_ns() < until_ns)
        pause_briefly();
}

/* Whoever asks /readyz turns elsewhere meanwhile; requests that come all the same are answered, and
 * their connections closed. */
static void stand_aside(struct server *server)
{
    uint64_t ms = server->config.drain_delay_ms;
    struct timespec rest = {(time_t)(ms / 1000), (long)(ms % 1000) * 1000000};
    atomic_store(&server->host.is_draining, true);
    if (ms)
        server_log_message(SERVER_LOG_INFO, "standing_aside", "for %llu ms",
                           (unsigned long long)ms);
    while (nanosleep(&rest, &rest) != 0) continue;
}

/* Ends the threads of loader and scrub, and stores what can be computed again. */
static void persist(struct server *server)
{
    struct server_surfaces *surfaces = &server->surfaces;
    server_scrub_destroy(surfaces->scrub);
    surfaces->scrub = NULL;
    server_loader_stop(surfaces->loader);
    server_registry_note_uses(surfaces->registry);
    if (server->config.persist_fields)
        server_field_store_save(surfaces->field_store, surfaces->registry,
                                gd_now_ns() + PERSIST_NS);
}

void server_stop(struct server *server)
{
    stand_aside(server);
    server_log_message(SERVER_LOG_INFO, "draining", "%u requests under way",
                       server_connections_active(server->connections));
    const struct sockaddr_storage *socket = &server->config.listen.socket;
    if (socket->ss_family == AF_UNIX) unlink(((const struct sockaddr_un *)socket)->sun_path);
    server_http_quiesce(server->http);
    server_job_table_drain(server->jobs);
    server_batch_runner_drain(server->batches);
    server_events_end(server->events);
    wait_until_idle(server, gd_now_ns() + server->config.drain_ms * 1000000);
    server_workers_cancel(server->workers);
    while (atomic_load(&server->host.deferred) || server_workers_load(server->workers).background)
        pause_briefly();
    wait_until_idle(server, gd_now_ns() + LAST_ANSWERS_NS);
    /* after a cancel streams end; the library does not stop with a connection that is suspended */
    while (server_answer_streams_load(server->streams).count) pause_briefly();
    server_http_stop(server->http);
    persist(server);
    server_destroy(server);
    server_log_message(SERVER_LOG_INFO, "stopped", "all requests are answered");
}
