/* Gauges: the state of the daemon's parts, as text for Prometheus (version 0.0.4). */
#include <stdatomic.h>

#include "server/access/access.h"
#include "server/http/connections.h"
#include "server/exchange/answer_stream.h"
#include "server/exchange/events.h"
#include "server/jobs/batch_runner.h"
#include "server/jobs/job_table.h"
#include "server/server.h"

static void write_requests(struct server *server, struct proto_writer *writer)
{
    struct server_connections_statistics connections =
        server_connections_statistics(server->connections);
    struct server_workers_load load = server_workers_load(server->host.workers);
    struct server_batch_statistics batches = server_batch_runner_statistics(server->api.batches);
    const struct server_answer_streams_load streams =
        server_answer_streams_load(server->host.streams);
    const struct server_metric values[] = {
        {"connections", "Connections that are open.", (double)connections.open},
        {"connections_cut_total",
         "Connections cut because a head, a body or an answer took too long.",
         (double)connections.cut},
        {"malformed_requests_total", "Requests refused because they are malformed.",
         (double)connections.refusals},
        {"workers", "Worker threads.", load.threads},
        {"workers_busy", "Worker threads at work on requests, spare ones included.", load.running},
        {"queue_depth", "Requests that wait for a worker.", load.queued},
        {"requests_deferred", "Requests that workers run, or that wait for workers.",
         atomic_load(&server->host.deferred)},
        {"batch_items_running", "Items of batches that this daemon works on.", batches.running},
        {"batch_items_answered_total", "Items of batches that this daemon has answered.",
         (double)batches.answered},
        {"batch_items_returned_total", "Items of batches that this daemon returned to the queue.",
         (double)batches.returned},
        {"answer_streams", "Large answers that are encoded while their clients read them.",
         streams.count},
        {"answer_streams_held_bytes",
         "Bytes of the budget that the states of answer streams hold, without buffers.",
         (double)streams.held},
        {"event_streams", "Clients that watch jobs.", server_events_count(server->host.events)},
    };
    server_metrics_write_values(writer, values, sizeof values / sizeof *values);
}

static void write_surfaces(struct server *server, struct proto_writer *writer)
{
    struct server_cache_statistics cache = server_cache_statistics(server->api.cache);
    struct server_landmarks_statistics landmarks =
        server_landmarks_statistics(server->api.landmarks);
    struct server_registry_statistics registry = server_registry_statistics(server->api.registry);
    const struct server_metric values[] = {
        {"workers_background", "Threads at work on landmarks and previews.",
         server_background_is_busy(server->api.landmarks) +
             server_background_is_busy(server->api.previews)},
        {"cache_hits_total", "Look-ups that found a field of the source.", (double)cache.hits},
        {"cache_misses_total", "Look-ups that found no field.", (double)cache.misses},
        {"cache_builds_total", "Builds of fields that were begun.", (double)cache.builds},
        {"cache_waits_total", "Requests that waited for a field that another request was building.",
         (double)cache.waits},
        {"cache_evictions_total", "Fields evicted to free memory.", (double)cache.evictions},
        {"cache_fields", "Fields in the cache.", (double)cache.fields},
        {"landmarks_built_total", "Meshes for which landmarks were computed.",
         (double)landmarks.built},
        {"landmarks_loaded_total", "Meshes whose landmarks were read from the store.",
         (double)landmarks.loaded},
        {"landmarks_dropped_total", "Meshes whose landmarks were evicted to free memory.",
         (double)landmarks.dropped},
        {"meshes", "Meshes that are stored.", (double)registry.surfaces},
        {"meshes_loaded", "Meshes that are in memory.", (double)registry.loaded},
        {"mesh_loads_total", "Meshes loaded from the store.", (double)registry.loads},
        {"mesh_unloads_total", "Meshes unloaded to free memory.", (double)registry.unloads},
        {"store_writable", "1, or 0 after a write that could not be made durable.",
         server_registry_health(server->api.registry) == NULL},
        {"store_damaged_files", "Stored files that were found damaged: their meshes are refused.",
         (double)registry.damaged},
        {"memory_budget_bytes", "The memory budget.", (double)server->budget.limit},
    };
    server_metrics_write_values(writer, values, sizeof values / sizeof *values);
}

static void write_scrub(struct server *server, struct proto_writer *writer)
{
    if (!server->scrub) return;
    struct server_scrub_statistics scrub = server_scrub_statistics(server->scrub);
    const struct server_metric values[] = {
        {"scrub_bytes_total", "Bytes of stored files that were verified.", (double)scrub.bytes},
        {"scrub_files_total", "Stored files that were verified.", (double)scrub.files},
        {"scrub_rounds_total", "Whole rounds through the stored files.", (double)scrub.rounds},
        {"scrub_progress", "Completed part of the current round; 1 between rounds.",
         scrub.progress},
        {"scrub_faults", "Files that the last whole round found damaged, missing or unreadable.",
         (double)scrub.faults},
        {"scrub_end_timestamp_seconds", "When the last whole round ended; 0: none has.",
         (double)scrub.ended},
    };
    server_metrics_write_values(writer, values, sizeof values / sizeof *values);
}

static void write_job_states(const struct server_job_statistics *jobs, struct proto_writer *writer)
{
    server_metrics_write_head(writer, "jobs", "gauge",
                              "Jobs by state; ended jobs count until they are dropped.");
    for (int i = 0; i < PROTO_JOB_STATE_COUNT; i++)
        proto_append_format(writer, "geodesicd_jobs{state=\"%s\"} %llu\n", proto_job_state_name(i),
                            (unsigned long long)jobs->now[i]);
}

static void write_jobs(struct server *server, struct proto_writer *writer)
{
    struct server_job_statistics jobs = server_job_table_statistics(server->api.jobs, NULL);
    write_job_states(&jobs, writer);
    server_metrics_write_head(writer, "jobs_ended_total", "counter",
                              "Jobs that have ended, by their last state.");
    for (int i = 0; i < PROTO_JOB_STATE_COUNT; i++)
        if (proto_job_has_ended(i))
            proto_append_format(writer, "geodesicd_jobs_ended_total{state=\"%s\"} %llu\n",
                                proto_job_state_name(i), (unsigned long long)jobs.ended[i]);
}

static void write_memory(struct server *server, struct proto_writer *writer)
{
    static const char *const names[SERVER_BUDGET_CLASSES] = {
        "meshes",    "fields",   "flight",          "answers", "records", "workspaces",
        "landmarks", "previews", "discretizations", "jobs",    "spare"};
    server_metrics_write_head(writer, "memory_bytes", "gauge",
                              "Bytes of the budget in use, by class.");
    for (int i = 0; i < SERVER_BUDGET_CLASSES; i++)
        proto_append_format(writer, "geodesicd_memory_bytes{class=\"%s\"} %zu\n", names[i],
                            atomic_load(&server->budget.used[i]));
}

void server_gauges_write(void *user, const char *tenant, struct proto_writer *writer)
{
    struct server *server = user;
    server_access_write(server->api.access, tenant, writer);
    if (tenant) {
        struct server_job_statistics jobs = server_job_table_statistics(server->api.jobs, tenant);
        write_job_states(&jobs, writer);
        return;
    }
    server_metrics_write(server->host.metrics, writer);
    write_requests(server, writer);
    write_surfaces(server, writer);
    write_scrub(server, writer);
    write_jobs(server, writer);
    write_memory(server, writer);
}
