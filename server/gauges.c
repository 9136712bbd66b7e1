/* See gauges.h. */
#include "server/gauges.h"

#include <stdatomic.h>

#include "server/access/access.h"
#include "server/http/connections.h"
#include "server/http/events.h"
#include "server/jobs/batches.h"
#include "server/jobs/jobs.h"
#include "server/server.h"
#include "server/surfaces/scrub.h"

static void write_connections(struct server *server, struct proto_writer *writer)
{
    struct server_connections_statistics found = server_connections_statistics(server->connections);
    server_metrics_write_value(writer, "connections", "gauge", "Connections that are open.",
                               (double)found.open);
    server_metrics_write_value(
        writer, "connections_cut_total", "counter",
        "Connections cut because headers were sent, or an answer was taken, too slowly.",
        (double)found.cut);
    server_metrics_write_value(writer, "malformed_requests_total", "counter",
                               "Requests that broke the grammar of HTTP.", (double)found.faults);
}

static void write_workers(struct server *server, struct proto_writer *writer)
{
    struct server_workers_load load = server_workers_load(server->workers);
    server_metrics_write_value(writer, "workers", "gauge", "Worker threads.", load.threads);
    server_metrics_write_value(writer, "workers_busy", "gauge",
                               "Worker threads at work on requests, spare ones included.",
                               load.running);
    server_metrics_write_value(writer, "workers_background", "gauge",
                               "Worker threads at work on landmarks.", load.background);
    server_metrics_write_value(writer, "queue_depth", "gauge", "Requests that wait for a worker.",
                               load.queued);
    server_metrics_write_value(writer, "requests_deferred", "gauge",
                               "Requests that are with the workers or wait for them.",
                               atomic_load(&server->host.deferred));
}

static void write_cache(struct server *server, struct proto_writer *writer)
{
    struct server_cache_statistics cache = server_cache_statistics(server->cache);
    server_metrics_write_value(writer, "cache_hits_total", "counter",
                               "Look-ups that found a field of the source.", (double)cache.hits);
    server_metrics_write_value(writer, "cache_misses_total", "counter", "Look-ups that found none.",
                               (double)cache.misses);
    server_metrics_write_value(writer, "cache_builds_total", "counter", "Fields that were begun.",
                               (double)cache.builds);
    server_metrics_write_value(writer, "cache_resumed_total", "counter",
                               "Of these, fields that had one of less reach to be resumed from.",
                               (double)cache.resumed);
    server_metrics_write_value(writer, "cache_waits_total", "counter",
                               "Requests that waited for a field that another was building.",
                               (double)cache.waits);
    server_metrics_write_value(writer, "cache_evictions_total", "counter",
                               "Fields evicted for room.", (double)cache.evictions);
    server_metrics_write_value(writer, "cache_fields", "gauge", "Fields in the cache.",
                               (double)cache.fields);
}

static void write_landmarks(struct server *server, struct proto_writer *writer)
{
    struct server_landmarks_statistics landmarks = server_landmarks_statistics(server->landmarks);
    server_metrics_write_value(writer, "landmarks_built_total", "counter",
                               "Meshes that landmarks were computed for.", (double)landmarks.built);
    server_metrics_write_value(writer, "landmarks_loaded_total", "counter",
                               "Meshes whose landmarks were read from the store.",
                               (double)landmarks.loaded);
    server_metrics_write_value(writer, "landmarks_dropped_total", "counter",
                               "Meshes whose landmarks were let go of for room.",
                               (double)landmarks.dropped);
}

static void write_store(struct server *server, struct proto_writer *writer)
{
    struct server_registry_statistics registry = server_registry_statistics(server->registry);
    server_metrics_write_value(writer, "meshes", "gauge", "Meshes that are stored.",
                               (double)registry.surfaces);
    server_metrics_write_value(writer, "meshes_loaded", "gauge", "Meshes that are in memory.",
                               (double)registry.loaded);
    server_metrics_write_value(writer, "mesh_loads_total", "counter",
                               "Meshes loaded from the store.", (double)registry.loads);
    server_metrics_write_value(writer, "mesh_unloads_total", "counter", "Meshes unloaded for room.",
                               (double)registry.unloads);
    server_metrics_write_value(writer, "store_writable", "gauge",
                               "1, or 0 after a write that could not be made durable.",
                               server_registry_health(server->registry) == NULL);
    server_metrics_write_value(writer, "store_damaged_files", "gauge",
                               "Stored files that were found damaged: their meshes are refused.",
                               (double)registry.damaged);
}

static void write_batches(struct server *server, struct proto_writer *writer)
{
    struct server_batches_statistics batches = server_batches_statistics(server->batches);
    server_metrics_write_value(writer, "batch_items_running", "gauge",
                               "Items of batches that this daemon works on.", batches.running);
    server_metrics_write_value(writer, "batch_items_answered_total", "counter",
                               "Items of batches that it has answered.", (double)batches.answered);
    server_metrics_write_value(writer, "batch_items_returned_total", "counter",
                               "Items of batches that it gave back for later.",
                               (double)batches.returned);
}

static void write_scrub(struct server *server, struct proto_writer *writer)
{
    if (!server->scrub) return;
    struct server_scrub_statistics scrub = server_scrub_statistics(server->scrub);
    server_metrics_write_value(writer, "scrub_bytes_total", "counter",
                               "Bytes of stored files that were looked through.",
                               (double)scrub.bytes);
    server_metrics_write_value(writer, "scrub_files_total", "counter",
                               "Stored files that were looked through.", (double)scrub.files);
    server_metrics_write_value(writer, "scrub_rounds_total", "counter",
                               "Times that all stored files were looked through.",
                               (double)scrub.rounds);
    server_metrics_write_value(writer, "scrub_progress", "gauge",
                               "Part of the round under way that is done; 1 between rounds.",
                               scrub.progress);
    server_metrics_write_value(
        writer, "scrub_faults", "gauge",
        "Files that the last whole round found damaged, missing or unreadable.",
        (double)scrub.faults);
    server_metrics_write_value(writer, "scrub_end_timestamp_seconds", "gauge",
                               "When the last whole round ended; 0: none has.",
                               (double)scrub.ended);
}

static void write_job_states(const struct server_jobs_statistics *jobs, struct proto_writer *writer)
{
    server_metrics_write_head(writer, "jobs", "gauge",
                              "Jobs by state, those that have ended until they are dropped.");
    for (int i = 0; i < PROTO_JOB_STATE_COUNT; i++)
        proto_append_format(writer, "geodesicd_jobs{state=\"%s\"} %llu\n", proto_job_state_name(i),
                            (unsigned long long)jobs->now[i]);
}

static void write_jobs(struct server *server, struct proto_writer *writer)
{
    struct server_jobs_statistics jobs = server_jobs_statistics(server->jobs, NULL);
    write_job_states(&jobs, writer);
    server_metrics_write_head(writer, "jobs_ended_total", "counter",
                              "Jobs that have ended, by how they did.");
    for (int i = 0; i < PROTO_JOB_STATE_COUNT; i++)
        if (proto_job_has_ended(i))
            proto_append_format(writer, "geodesicd_jobs_ended_total{state=\"%s\"} %llu\n",
                                proto_job_state_name(i), (unsigned long long)jobs.ended[i]);
    server_metrics_write_value(writer, "event_streams", "gauge", "Clients that watch jobs.",
                               server_events_count(server->events));
}

static void write_memory(struct server *server, struct proto_writer *writer)
{
    static const char *const names[SERVER_BUDGET_CLASSES] = {
        "meshes",     "fields",    "flight",          "answers", "records",
        "workspaces", "landmarks", "discretizations", "jobs",    "spare"};
    server_metrics_write_value(writer, "memory_budget_bytes", "gauge", "The memory budget.",
                               (double)server->budget.limit);
    server_metrics_write_head(writer, "memory_bytes", "gauge",
                              "Bytes of the budget in use, by what holds them.");
    for (int i = 0; i < SERVER_BUDGET_CLASSES; i++)
        proto_append_format(writer, "geodesicd_memory_bytes{class=\"%s\"} %zu\n", names[i],
                            atomic_load(&server->budget.used[i]));
}

void server_gauges_write(void *user, const char *tenant, struct proto_writer *writer)
{
    struct server *server = user;
    server_access_write(server->access, tenant, writer);
    if (tenant) {
        struct server_jobs_statistics jobs = server_jobs_statistics(server->jobs, tenant);
        write_job_states(&jobs, writer);
        return;
    }
    server_metrics_write(server->metrics, writer);
    write_connections(server, writer);
    write_workers(server, writer);
    write_cache(server, writer);
    write_landmarks(server, writer);
    write_store(server, writer);
    write_batches(server, writer);
    write_scrub(server, writer);
    write_jobs(server, writer);
    write_memory(server, writer);
}
