#include "server/server.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/un.h>
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
#include "server/work/thread_priority.h"

/* Arrays of at least this many bytes return to the system when they are freed. By default glibc
 * raises this bound with the size of freed arrays, and so keeps the memory of freed meshes and
 * fields. After some hundred uploads, this memory is half as large as the budget. */
#define LARGE_BYTES (256 << 10)

#define JOB_ANSWERS_PART 8 /* share of the memory budget for the answers of jobs: 1/8 */
/* 1/16 of the memory budget is set aside for the memory of released fields */
#define SPARE_PART 16
#define SPARE_MOST ((size_t)256 << 20)
/* time to send the remaining answers after all answers are computed */
#define LAST_ANSWERS_NS UINT64_C(2000000000)
#define PERSIST_NS      UINT64_C(10000000000) /* time for writing fields */
#define LOOK_NS         UINT64_C(2000000)     /* between two checks during a stop */
#define TICK_NS         UINT64_C(10000000)    /* the longest delay of a deadline */
#define WATCH_NS        UINT64_C(1000000000)  /* between two ticks without deferred requests */
#define TRIM_NS         UINT64_C(10000000000) /* between two calls of malloc_trim */

void server_surfaces_destroy(struct server *server)
{
    struct server_api *api = &server->api;
    server_scrub_destroy(server->scrub);
    server_background_stop(api->landmarks);
    server_background_stop(api->previews);
    server_loader_destroy(api->loader);
    server_workers_destroy(api->writer);
    server_workers_destroy(api->lister);
    server_registry_destroy(api->registry);
    server_discretizations_destroy(api->discretizations);
    server_background_destroy(api->landmarks);
    server_background_destroy(api->previews);
    server_field_store_close(server->field_store);
    server_cache_destroy(api->cache);
}

/* Frees a server, even a partly started one. HTTP must not run. */
static void server_destroy(struct server *server)
{
    server_connections_destroy(server->connections);
    server_batch_runner_destroy(server->api.batches);
    server_thread_stop(server->deadlines);
    server_thread_stop(server->trimmer);
    server_job_table_destroy(server->api.jobs);
    server_answer_streams_destroy(server->host.streams);
    server_events_destroy(server->host.events);
    server_surfaces_destroy(server);
    server_workers_destroy(server->host.workers);
    server_workers_destroy(server->host.waiters);
    server_workers_destroy(server->host.batch_readers);
    server_thread_stop(server->host.spare);
    server_workspaces_destroy(server->host.workspaces);
    gd_spare_memory(0);
    server_metrics_destroy(server->host.metrics);
    server_tls_close(server->tls);
    server_access_destroy(server->api.access);
    free(server);
}

static bool select_cpu(const struct server_config *config, char error[SERVER_ERROR])
{
    const char *name = server_config_cpus[config->cpu];
    return gd_cpu_select(name) == GD_OK ||
           server_refuse(
               error,
               "this machine lacks the instructions that --cpu %s needs; write auto or baseline",
               name);
}

static bool open_access(struct server *server, char error[SERVER_ERROR])
{
    const struct server_config *config = &server->config;
    if (*config->keys)
        server->api.access = server_access_create(config->keys, &server->budget, error);
    if (*config->keys && !server->api.access) return false;
    if (*config->tls_cert) server->tls = server_tls_open(config->tls_cert, config->tls_key, error);
    return !*config->tls_cert || server->tls;
}

static void watch_deadlines(void *user)
{
    struct server *server = user;
    server_thread_wake(server->deadlines);
}

static void server_tick(struct server *server, uint64_t now_ns)
{
    server_workers_expire(server->host.workers, now_ns);
    server_workers_expire(server->api.writer, now_ns);
    server_workers_expire(server->api.lister, now_ns);
    server_workers_expire(server->host.waiters, now_ns);
    server_workers_expire(server->host.batch_readers, now_ns);
    if (server_workers_cancelled(server->host.workers)) {
        server_workers_cancel(server->api.writer);
        server_workers_cancel(server->host.waiters);
        server_workers_cancel(server->host.batch_readers);
    }
    server_job_table_expire(server->api.jobs, now_ns);
    server_events_tick(server->host.events, now_ns);
}

/* Waits for the next tick. While requests are deferred, a wake does not shorten the wait, because
 * wakes are frequent: there is one each time that the number of deferred requests rises from zero.
 * Returns false if the thread must end. */
static bool deadlines_wait(struct server *server, struct server_thread *thread)
{
    if (atomic_load(&server->host.deferred)) return server_thread_sleep(thread, TICK_NS);
    bool is_idle = server_job_table_is_empty(server->api.jobs) &&
                   server_events_count(server->host.events) == 0;
    return server_thread_pause(thread, is_idle ? SERVER_THREAD_FOREVER : WATCH_NS);
}

static void deadlines_run(void *user, struct server_thread *thread)
{
    while (deadlines_wait(user, thread)) server_tick(user, gd_now_ns());
}

/* Returns free memory between other blocks to the system. Otherwise, after an hour of uploads and
 * deletes, the allocator keeps memory that the budget does not count, up to a fifth of a small
 * budget. */
static void heap_trim_run(void *user, struct server_thread *thread)
{
    (void)user;
    while (server_thread_pause(thread, TRIM_NS)) malloc_trim(0);
}

/* Prepares memory for the next fields, at idle priority. Otherwise a build would spend a large part
 * of its time on clearing new memory, especially in virtual machines. */
static void spare_run(void *user, struct server_thread *thread)
{
    (void)user;
    server_thread_set_idle();
    while (server_thread_pause(thread, SERVER_THREAD_FOREVER))
        while (gd_spare_prepare()) continue;
}

bool server_start_jobs(struct server *server)
{
    const struct server_job_limits limits = {
        .jobs = (uint32_t)server->config.max_jobs,
        .answer_bytes = server->budget.limit / JOB_ANSWERS_PART,
        .ttl_s = server->config.job_ttl_s,
        .are_tenanted = server->api.access != NULL,
    };
    server->api.jobs = server_job_table_create(&server->host, &limits);
    server->host.waiters = server_workers_create(1, UINT32_MAX);
    server->host.batch_readers = server_workers_create(1, UINT32_MAX);
    if (server->api.jobs && server->host.waiters && server->host.batch_readers)
        server->deadlines = server_thread_start(deadlines_run, server);
    server->trimmer = server_thread_start(heap_trim_run, NULL);
    server->host.spare = server_thread_start(spare_run, NULL);
    return server->deadlines && server->trimmer && server->host.spare;
}

void server_connect(struct server *server)
{
    const struct server_config *config = &server->config;
    struct server_host *host = &server->host;
    host->budget = &server->budget;
    host->timeout_ms = config->timeout_ms;
    host->slow_ms = config->slow_ms;
    host->queue_length = config->queue_length;
    host->has_cors_origins = config->cors_origins.count > 0;
    const struct server_config_list *ancestors = &config->frame_ancestors;
    snprintf(host->frame_ancestors, sizeof host->frame_ancestors, "%s%s%s", ancestors->name[0],
             ancestors->count > 1 ? " " : "", ancestors->count > 1 ? ancestors->name[1] : "");
    host->dispatch = server_router_dispatch;
    host->watch = watch_deadlines;
    host->watcher = server;
    host->api = &server->api;
    server->api.config = config;
    server->api.write_metrics = server_gauges_write;
    server->api.metrics_source = server;
}

static struct server_store *open_store(const struct server_config *config, char error[SERVER_ERROR])
{
    if (config->store == SERVER_STORE_KIND_MEMORY) return server_store_memory_create();
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        return server_store_postgres_open(config->store_url, error);
    return server_store_local_open(config->data_dir, error);
}

/* Opens the field store. With a database the data folder is optional: its data can be
 * recomputed. */
static bool open_field_store(struct server *server, char error[SERVER_ERROR])
{
    const struct server_config *config = &server->config;
    if (!*config->data_dir || config->store == SERVER_STORE_KIND_MEMORY) return true;
    if (config->store == SERVER_STORE_KIND_POSTGRES)
        (void)server_disk_make_folder(config->data_dir);
    server->field_store = server_field_store_open(config->data_dir, &server->budget);
    if (!server->field_store)
        return server_refuse(
            error, "can't make the folder of fields in '%s': check its rights and the free space",
            config->data_dir);
    server_field_store_follow(server->field_store, server->api.registry);
    return true;
}

static bool create_surfaces(struct server *server, char error[SERVER_ERROR])
{
    const struct server_config *config = &server->config;
    struct server_api *api = &server->api;
    api->cache = server_cache_create(&server->budget, server->host.workers);
    api->writer = server_workers_create(1, UINT32_MAX);
    api->lister = server_workers_create(1, UINT32_MAX);
    api->discretizations =
        server_discretizations_create(server->host.workspaces, (uint32_t)config->max_faces);
    if (!api->cache || !api->writer || !api->lister || !api->discretizations) return false;
    struct server_store *store = open_store(config, error);
    if (store) api->registry = server_registry_create(store, &server->budget);
    if (!api->registry || !open_field_store(server, error)) return false;
    const struct server_background_parts parts = {.workers = server->host.workers,
                                                  .workspaces = server->host.workspaces,
                                                  .registry = api->registry,
                                                  .field_store = server->field_store};
    if (config->landmarks)
        api->landmarks =
            server_landmarks_create(&parts, server->host.metrics, (uint32_t)config->landmarks);
    if (config->landmarks && !api->landmarks) return false;
    api->previews = server_previews_create(&parts);
    if (!api->previews) return false;
    api->loader = server_loader_create(&(struct server_loader_parts){
        .budget = &server->budget,
        .workers = server->host.workers,
        .cache = api->cache,
        .registry = api->registry,
        .field_store = config->persist_fields ? server->field_store : NULL,
        .max_faces = (uint32_t)config->max_faces});
    if (!api->loader || !server_loader_preload(api->loader)) return false;
    if (!config->scrub_s || !store->verify) return true;
    server->scrub = server_scrub_create(api->registry, server->host.workers, config->scrub_s,
                                        config->scrub_rate);
    return server->scrub != NULL;
}

static bool create_parts(struct server *server, char error[SERVER_ERROR])
{
    const struct server_config *config = &server->config;
    server_connect(server);
    /* The allocator may keep memory of released fields. This memory is taken from the budget once,
       here. So its reuse takes nothing more from the budget. */
    size_t part = server->budget.limit / SPARE_PART, spare = part < SPARE_MOST ? part : SPARE_MOST;
    gd_spare_memory(spare);
    if (!server_budget_take(&server->budget, SERVER_BUDGET_SPARE, spare)) return false;
    server->host.workspaces = server_workspaces_create(&server->budget, (uint32_t)config->workers);
    server->host.workers =
        server_workers_create((uint32_t)config->workers, (uint32_t)config->queue_length);
    if (server->host.workers && !server_workers_add_spare(server->host.workers)) return false;
    if (server->host.workers && server->api.access) server_workers_share(server->host.workers);
    server->host.metrics = server_metrics_create(proto_routes, proto_route_count);
    if (!server->host.workers || !server->host.workspaces || !server->host.metrics) return false;
    if (!create_surfaces(server, error)) return false;
    server->host.events = server_events_create();
    server->host.streams = server_answer_streams_create();
    if (!server->host.events || !server->host.streams || !server_start_jobs(server)) return false;
    server->api.batches = server_batch_runner_create(&server->host, config, error);
    server->connections = server_connections_create(&server->budget);
    return server->api.batches && server->connections;
}

static bool server_serve(struct server *server, int listening, char error[SERVER_ERROR])
{
    if (!server_address_listen(listening, &server->config.listen, error)) return false;
    const struct server_http_parts parts = {
        .config = &server->config,
        .host = &server->host,
        .connections = server->connections,
        .tls = server->tls,
        .begin = server_router_begin,
        .end = server_router_end,
    };
    server->http = server_http_start(&parts, listening, error);
    return server->http != NULL;
}

struct server *server_start(const struct server_config *config, int listening,
                            char error[SERVER_ERROR])
{
    snprintf(error, SERVER_ERROR, "out of memory or threads");
    mallopt(M_MMAP_THRESHOLD, LARGE_BYTES);
    struct server *server = calloc(1, sizeof *server);
    if (!server) return NULL;
    server->config = *config;
    server_budget_init(&server->budget, config->memory_budget); /* before the shares of tenants */
    if (config->max_answer < server->budget.largest_answer)
        server->budget.largest_answer = config->max_answer;
    if (select_cpu(config, error) && open_access(server, error) && create_parts(server, error) &&
        server_serve(server, listening, error))
        return server;
    if (server->host.workers) server_workers_cancel(server->host.workers);
    server_destroy(server);
    return NULL;
}

static void log_reload(const char *what, bool is_read, const char *error)
{
    if (is_read)
        server_log_message(SERVER_LOG_INFO, "reloaded", "%s", what);
    else
        server_log_message(SERVER_LOG_ERROR, "reload_failed", "the old %s stay in use: %s", what,
                           error);
}

void server_reload(struct server *server)
{
    char error[SERVER_ERROR] = "out of memory";
    if (server->api.access)
        log_reload("keys", server_access_reload(server->api.access, error), error);
    if (server->tls) log_reload("certificates", server_tls_reload(server->tls, error), error);
}

/* --- the end ---------------------------------------------------------------------------------- */

static void wait_until_idle(struct server *server, uint64_t until_ns)
{
    while (
        (server_connections_active(server->connections) || atomic_load(&server->host.deferred)) &&
        gd_now_ns() < until_ns)
        server_pause(LOOK_NS);
}

/* Starts the drain delay: from now on /readyz fails, so that load balancers send requests
 * elsewhere. Requests that still arrive are answered, and their connections closed. */
static void drain_delay_wait(struct server *server)
{
    uint64_t ms = server->config.drain_delay_ms;
    atomic_store(&server->host.is_draining, true);
    if (ms)
        server_log_message(SERVER_LOG_INFO, "standing_aside", "for %llu ms",
                           (unsigned long long)ms);
    server_pause(ms * 1000000);
}

/* Ends the threads of loader, landmarks, previews and scrub. Stores uses and fields. */
static void state_persist(struct server *server)
{
    server_scrub_destroy(server->scrub);
    server->scrub = NULL;
    server_loader_stop(server->api.loader);
    server_background_stop(server->api.landmarks);
    server_background_stop(server->api.previews);
    server_registry_note_uses(server->api.registry);
    if (server->config.persist_fields)
        server_field_store_save(server->field_store, server->api.registry,
                                gd_now_ns() + PERSIST_NS);
}

void server_stop(struct server *server)
{
    drain_delay_wait(server);
    server_log_message(SERVER_LOG_INFO, "draining", "%u requests under way",
                       server_connections_active(server->connections));
    const struct sockaddr_storage *socket = &server->config.listen.socket;
    if (socket->ss_family == AF_UNIX) unlink(((const struct sockaddr_un *)socket)->sun_path);
    server_http_quiesce(server->http);
    server_job_table_drain(server->api.jobs);
    server_batch_runner_drain(server->api.batches);
    server_events_end(server->host.events);
    wait_until_idle(server, gd_now_ns() + server->config.drain_ms * 1000000);
    server_workers_cancel(server->host.workers);
    while (atomic_load(&server->host.deferred)) server_pause(LOOK_NS);
    wait_until_idle(server, gd_now_ns() + LAST_ANSWERS_NS);
    /* a cancel ends streams; the library can't stop while a connection is suspended */
    while (server_answer_streams_load(server->host.streams).count) server_pause(LOOK_NS);
    server_http_stop(server->http);
    state_persist(server);
    server_destroy(server);
    server_log_message(SERVER_LOG_INFO, "stopped", "all requests are answered");
}
