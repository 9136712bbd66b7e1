/* See metrics.h. */
#include "server/metrics.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/control.h"
#include "gd/cpu.h"
#include "server/access/access.h"
#include "server/jobs/batches.h"
#include "server/http/connections.h"
#include "server/http/events.h"
#include "server/jobs/jobs.h"
#include "server/base/log.h"
#include "server/surfaces/scrub.h"
#include "server/server.h"
#include "server/base/version.h"

#define SHARDS     16
#define CACHE_LINE 64

/* X(upper bound in seconds) of the latency histogram; one more bucket is for the rest. */
static const double bounds[] = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                0.1,    0.25,    0.5,    1,     2.5,    5,     10,   30};
#define BUCKETS (sizeof bounds / sizeof *bounds + 1)

static const unsigned statuses[] = {200, 201, 202, 204, 304, 400, 401, 403, 404, 405, 406, 409,
                                    410, 411, 412, 413, 415, 422, 429, 500, 503, 504, 507};
#define STATUSES (sizeof statuses / sizeof *statuses + 1) /* the last one is for any other */

/* The last code, and so the number of codes. */
#define PROBLEMS (PROTO_PROBLEM_INSUFFICIENT_STORAGE + 1)

/* What is counted for one route by one shard. */
struct cell {
    atomic_uint_least64_t by_status[STATUSES];
    atomic_uint_least64_t by_latency[BUCKETS];
    atomic_uint_least64_t nanoseconds;
};

struct server_metrics {
    const struct proto_route *routes;
    size_t route_count; /* cells are one more: the last is for requests that found no route */
    struct cell *shards[SHARDS];
    atomic_uint_least64_t failed_checks, searches, windows;
    atomic_uint_least64_t problems[PROBLEMS]; /* by code */
    uint64_t started_ns;
};

struct server_metrics *server_metrics_create(const struct proto_route *routes, size_t route_count)
{
    struct server_metrics *metrics = calloc(1, sizeof *metrics);
    if (!metrics) return NULL;
    metrics->routes = routes;
    metrics->route_count = route_count;
    metrics->started_ns = gd_now_ns();
    size_t bytes = (route_count + 1) * sizeof(struct cell);
    bytes = (bytes + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE;
    for (int i = 0; i < SHARDS; i++) {
        metrics->shards[i] = aligned_alloc(CACHE_LINE, bytes);
        if (!metrics->shards[i]) {
            server_metrics_destroy(metrics);
            return NULL;
        }
        memset(metrics->shards[i], 0, bytes);
    }
    return metrics;
}

void server_metrics_destroy(struct server_metrics *metrics)
{
    if (!metrics) return;
    for (int i = 0; i < SHARDS; i++) free(metrics->shards[i]);
    free(metrics);
}

/* --- counting --------------------------------------------------------------------------------- */

/* Each thread takes the next shard when it first counts. */
static unsigned own_shard(void)
{
    static atomic_uint next;
    static _Thread_local unsigned shard = SHARDS;
    if (shard == SHARDS) shard = atomic_fetch_add(&next, 1) % SHARDS;
    return shard;
}

static void add(atomic_uint_least64_t *counter, uint64_t value)
{
    atomic_fetch_add_explicit(counter, value, memory_order_relaxed);
}

static size_t status_index(unsigned status)
{
    size_t index = 0;
    while (index < STATUSES - 1 && statuses[index] != status) index++;
    return index;
}

static size_t bucket_index(uint64_t nanoseconds)
{
    size_t index = 0;
    while (index < BUCKETS - 1 && (double)nanoseconds > bounds[index] * 1e9) index++;
    return index;
}

void server_metrics_count(struct server_metrics *metrics, const struct proto_route *route,
                          unsigned status, uint64_t nanoseconds)
{
    size_t row = route ? (size_t)(route - metrics->routes) : metrics->route_count;
    struct cell *cell = &metrics->shards[own_shard()][row];
    add(&cell->by_status[status_index(status)], 1);
    add(&cell->by_latency[bucket_index(nanoseconds)], 1);
    add(&cell->nanoseconds, nanoseconds);
}

void server_metrics_count_problem(struct server_metrics *metrics, enum proto_problem_code code)
{
    if (code != PROTO_PROBLEM_NONE) add(&metrics->problems[code], 1);
}

bool server_metrics_count_status(struct server_metrics *metrics, enum gd_status status)
{
    bool has_failed = status == GD_INTERNAL || status == GD_RUNAWAY;
    if (has_failed) add(&metrics->failed_checks, 1);
    return has_failed;
}

void server_metrics_count_windows(struct server_metrics *metrics, uint64_t windows)
{
    add(&metrics->windows, windows);
}

void server_metrics_count_search(struct server_metrics *metrics)
{
    add(&metrics->searches, 1);
}

/* --- writing ---------------------------------------------------------------------------------- */

static uint64_t sum(const struct server_metrics *metrics, size_t row, size_t offset)
{
    uint64_t total = 0;
    for (int i = 0; i < SHARDS; i++) {
        const char *cell = (const char *)&metrics->shards[i][row];
        total +=
            atomic_load_explicit((atomic_uint_least64_t *)(cell + offset), memory_order_relaxed);
    }
    return total;
}

static uint64_t sum_status(const struct server_metrics *metrics, size_t row, size_t status)
{
    return sum(metrics, row,
               offsetof(struct cell, by_status) + status * sizeof(atomic_uint_least64_t));
}

static uint64_t sum_latency(const struct server_metrics *metrics, size_t row, size_t bucket)
{
    return sum(metrics, row,
               offsetof(struct cell, by_latency) + bucket * sizeof(atomic_uint_least64_t));
}

static const char *const method_names[] = {[PROTO_METHOD_GET] = "GET",
                                           [PROTO_METHOD_PUT] = "PUT",
                                           [PROTO_METHOD_POST] = "POST",
                                           [PROTO_METHOD_DELETE] = "DELETE"};

static void write_head(struct proto_writer *writer, const char *name, const char *kind,
                       const char *help)
{
    proto_append_format(writer, "# HELP geodesicd_%s %s\n# TYPE geodesicd_%s %s\n", name, help,
                        name, kind);
}

static void write_labels(const struct server_metrics *metrics, size_t row,
                         struct proto_writer *writer)
{
    bool found = row < metrics->route_count;
    proto_append_format(writer, "method=\"%s\",route=\"%s\"",
                        found ? method_names[metrics->routes[row].method] : "",
                        found ? metrics->routes[row].path : "");
}

static void write_requests(const struct server_metrics *metrics, struct proto_writer *writer)
{
    write_head(writer, "requests_total", "counter", "Requests answered, by route and status.");
    for (size_t row = 0; row <= metrics->route_count; row++) {
        for (size_t status = 0; status < STATUSES; status++) {
            uint64_t count = sum_status(metrics, row, status);
            if (!count) continue;
            proto_append_format(writer, "geodesicd_requests_total{");
            write_labels(metrics, row, writer);
            proto_append_format(writer, ",status=\"%u\"} %llu\n",
                                status < STATUSES - 1 ? statuses[status] : 0,
                                (unsigned long long)count);
        }
    }
}

static void write_bucket(const struct server_metrics *metrics, size_t row, const char *bound,
                         uint64_t count, struct proto_writer *writer)
{
    proto_append_format(writer, "geodesicd_request_seconds_bucket{");
    write_labels(metrics, row, writer);
    proto_append_format(writer, ",le=\"%s\"} %llu\n", bound, (unsigned long long)count);
}

static void write_histogram(const struct server_metrics *metrics, size_t row,
                            struct proto_writer *writer)
{
    uint64_t total = 0;
    for (size_t bucket = 0; bucket < BUCKETS; bucket++) total += sum_latency(metrics, row, bucket);
    if (!total) return;
    uint64_t count = 0;
    for (size_t bucket = 0; bucket < BUCKETS - 1; bucket++) {
        char bound[32];
        snprintf(bound, sizeof bound, "%g", bounds[bucket]);
        count += sum_latency(metrics, row, bucket);
        write_bucket(metrics, row, bound, count, writer);
    }
    write_bucket(metrics, row, "+Inf", total, writer);
    proto_append_format(writer, "geodesicd_request_seconds_sum{");
    write_labels(metrics, row, writer);
    proto_append_format(writer, "} %.9f\ngeodesicd_request_seconds_count{",
                        (double)sum(metrics, row, offsetof(struct cell, nanoseconds)) / 1e9);
    write_labels(metrics, row, writer);
    proto_append_format(writer, "} %llu\n", (unsigned long long)total);
}

static void write_one(struct proto_writer *writer, const char *name, const char *kind,
                      const char *help, double value)
{
    write_head(writer, name, kind, help);
    proto_append_format(writer, "geodesicd_%s %.17g\n", name, value);
}

static void write_problems(const struct server_metrics *metrics, struct proto_writer *writer)
{
    write_head(writer, "problems_total", "counter",
               "Requests refused or failed, by the code of the problem.");
    for (int code = PROTO_PROBLEM_NONE + 1; code < PROBLEMS; code++)
        proto_append_format(writer, "geodesicd_problems_total{code=\"%s\"} %llu\n",
                            proto_problem_name(code),
                            (unsigned long long)atomic_load(&metrics->problems[code]));
}

static void write_connections(struct server *server, struct proto_writer *writer)
{
    struct server_connections_statistics found = server_connections_statistics(server->connections);
    write_one(writer, "connections", "gauge", "Connections that are open.", (double)found.open);
    write_one(writer, "connections_cut_total", "counter",
              "Connections cut because headers were sent, or an answer was taken, too slowly.",
              (double)found.cut);
    write_one(writer, "malformed_requests_total", "counter",
              "Requests that broke the grammar of HTTP.", (double)found.faults);
}

static void write_workers(struct server *server, struct proto_writer *writer)
{
    struct server_workers_load load = server_workers_load(server->workers);
    write_one(writer, "workers", "gauge", "Worker threads.", load.threads);
    write_one(writer, "workers_busy", "gauge",
              "Worker threads at work on requests, spare ones included.", load.running);
    write_one(writer, "workers_background", "gauge", "Worker threads at work on landmarks.",
              load.background);
    write_one(writer, "queue_depth", "gauge", "Requests that wait for a worker.", load.queued);
    write_one(writer, "requests_deferred", "gauge",
              "Requests that are with the workers or wait for them.",
              atomic_load(&server->deferred));
}

static void write_cache(struct server *server, struct proto_writer *writer)
{
    struct server_cache_statistics cache = server_cache_statistics(server->cache);
    write_one(writer, "cache_hits_total", "counter", "Look-ups that found a field of the source.",
              (double)cache.hits);
    write_one(writer, "cache_misses_total", "counter", "Look-ups that found none.",
              (double)cache.misses);
    write_one(writer, "cache_builds_total", "counter", "Fields that were begun.",
              (double)cache.builds);
    write_one(writer, "cache_resumed_total", "counter",
              "Of these, fields that had one of less reach to be resumed from.",
              (double)cache.resumed);
    write_one(writer, "cache_waits_total", "counter",
              "Requests that waited for a field that another was building.", (double)cache.waits);
    write_one(writer, "cache_evictions_total", "counter", "Fields evicted for room.",
              (double)cache.evictions);
    write_one(writer, "cache_fields", "gauge", "Fields in the cache.", (double)cache.fields);
}

static void write_searches(const struct server_metrics *metrics, struct server *server,
                           struct proto_writer *writer)
{
    struct server_landmarks_statistics landmarks = server_landmarks_statistics(server->landmarks);
    write_one(writer, "searches_total", "counter",
              "Pairs that were searched, no field being there.",
              (double)atomic_load(&metrics->searches));
    write_one(writer, "field_windows_total", "counter",
              "Windows propagated for fields: the engine's work.",
              (double)atomic_load(&metrics->windows));
    write_one(writer, "landmarks_built_total", "counter",
              "Meshes that landmarks were computed for.", (double)landmarks.built);
    write_one(writer, "landmarks_loaded_total", "counter",
              "Meshes whose landmarks were read from the store.", (double)landmarks.loaded);
    write_one(writer, "landmarks_dropped_total", "counter",
              "Meshes whose landmarks were let go of for room.", (double)landmarks.dropped);
}

static void write_store(struct server *server, struct proto_writer *writer)
{
    struct server_registry_statistics registry = server_registry_statistics(server->registry);
    write_one(writer, "meshes", "gauge", "Meshes that are stored.", (double)registry.surfaces);
    write_one(writer, "meshes_loaded", "gauge", "Meshes that are in memory.",
              (double)registry.loaded);
    write_one(writer, "mesh_loads_total", "counter", "Meshes loaded from the store.",
              (double)registry.loads);
    write_one(writer, "mesh_unloads_total", "counter", "Meshes unloaded for room.",
              (double)registry.unloads);
    write_one(writer, "store_writable", "gauge",
              "1, or 0 after a write that could not be made durable.",
              server_registry_health(server->registry) == NULL);
    write_one(writer, "store_damaged_files", "gauge",
              "Stored files that were found damaged: their meshes are refused.",
              (double)registry.damaged);
}

static void write_batches(struct server *server, struct proto_writer *writer)
{
    struct server_batches_statistics batches = server_batches_statistics(server->batches);
    write_one(writer, "batch_items_running", "gauge", "Items of batches that this daemon works on.",
              batches.running);
    write_one(writer, "batch_items_answered_total", "counter",
              "Items of batches that it has answered.", (double)batches.answered);
    write_one(writer, "batch_items_returned_total", "counter",
              "Items of batches that it gave back for later.", (double)batches.returned);
}

static void write_scrub(struct server *server, struct proto_writer *writer)
{
    if (!server->scrub) return;
    struct server_scrub_statistics scrub = server_scrub_statistics(server->scrub);
    write_one(writer, "scrub_bytes_total", "counter",
              "Bytes of stored files that were looked through.", (double)scrub.bytes);
    write_one(writer, "scrub_files_total", "counter", "Stored files that were looked through.",
              (double)scrub.files);
    write_one(writer, "scrub_rounds_total", "counter",
              "Times that all stored files were looked through.", (double)scrub.rounds);
    write_one(writer, "scrub_progress", "gauge",
              "Part of the round under way that is done; 1 between rounds.", scrub.progress);
    write_one(writer, "scrub_faults", "gauge",
              "Files that the last whole round found damaged, missing or unreadable.",
              (double)scrub.faults);
    write_one(writer, "scrub_end_timestamp_seconds", "gauge",
              "When the last whole round ended; 0: none has.", (double)scrub.ended);
}

static void write_job_states(const struct server_jobs_statistics *jobs, struct proto_writer *writer)
{
    write_head(writer, "jobs", "gauge",
               "Jobs by state, those that have ended until they are dropped.");
    for (int i = 0; i < PROTO_JOB_STATE_COUNT; i++)
        proto_append_format(writer, "geodesicd_jobs{state=\"%s\"} %llu\n", proto_job_state_name(i),
                            (unsigned long long)jobs->now[i]);
}

static void write_jobs(struct server *server, struct proto_writer *writer)
{
    struct server_jobs_statistics jobs = server_jobs_statistics(server->jobs, NULL);
    write_job_states(&jobs, writer);
    write_head(writer, "jobs_ended_total", "counter", "Jobs that have ended, by how they did.");
    for (int i = 0; i < PROTO_JOB_STATE_COUNT; i++)
        if (proto_job_has_ended(i))
            proto_append_format(writer, "geodesicd_jobs_ended_total{state=\"%s\"} %llu\n",
                                proto_job_state_name(i), (unsigned long long)jobs.ended[i]);
    write_one(writer, "event_streams", "gauge", "Clients that watch jobs.",
              server_events_count(server->events));
}

static void write_memory(struct server *server, struct proto_writer *writer)
{
    static const char *const names[SERVER_BUDGET_CLASSES] = {
        "meshes",     "fields",    "flight",          "answers", "records",
        "workspaces", "landmarks", "discretizations", "jobs",    "spare"};
    write_one(writer, "memory_budget_bytes", "gauge", "The memory budget.",
              (double)server->budget.limit);
    write_head(writer, "memory_bytes", "gauge", "Bytes of the budget in use, by what holds them.");
    for (int i = 0; i < SERVER_BUDGET_CLASSES; i++)
        proto_append_format(writer, "geodesicd_memory_bytes{class=\"%s\"} %zu\n", names[i],
                            atomic_load(&server->budget.used[i]));
}

static void write_process(const struct server_metrics *metrics, struct proto_writer *writer)
{
    write_head(writer, "build_info", "gauge",
               "The program's version and the instructions that its kernels use.");
    proto_append_format(writer,
                        "geodesicd_build_info{version=\"" SERVER_VERSION "\",cpu=\"%s\"} 1\n",
                        gd_cpu_name());
    write_one(writer, "uptime_seconds", "gauge", "Time since the start.",
              (double)(gd_now_ns() - metrics->started_ns) / 1e9);
    write_one(writer, "failed_checks_total", "counter",
              "Answers withheld because a self-check failed or the work ran away.",
              (double)atomic_load(&metrics->failed_checks));
    write_one(writer, "log_lines_dropped_total", "counter",
              "Lines of the log that nobody read in time.", (double)server_log_dropped());
}

void server_metrics_write(const struct server_metrics *metrics, struct server *server,
                          struct proto_writer *writer)
{
    write_requests(metrics, writer);
    write_head(writer, "request_seconds", "histogram", "Time from the request line to the answer.");
    for (size_t row = 0; row <= metrics->route_count; row++) write_histogram(metrics, row, writer);
    write_problems(metrics, writer);
    write_connections(server, writer);
    server_access_write(server->access, NULL, writer);
    write_workers(server, writer);
    write_cache(server, writer);
    write_searches(metrics, server, writer);
    write_store(server, writer);
    write_batches(server, writer);
    write_scrub(server, writer);
    write_jobs(server, writer);
    write_memory(server, writer);
    write_process(metrics, writer);
}

void server_metrics_write_tenant(struct server *server, const char *tenant,
                                 struct proto_writer *writer)
{
    struct server_jobs_statistics jobs = server_jobs_statistics(server->jobs, tenant);
    server_access_write(server->access, tenant, writer);
    write_job_states(&jobs, writer);
}
