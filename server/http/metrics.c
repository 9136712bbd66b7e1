/* See metrics.h. */
#include "server/http/metrics.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gd/control.h"
#include "gd/cpu.h"
#include "server/base/log.h"
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

void server_metrics_write_head(struct proto_writer *writer, const char *name, const char *kind,
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
    server_metrics_write_head(writer, "requests_total", "counter",
                              "Requests answered, by route and status.");
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

void server_metrics_write_value(struct proto_writer *writer, const char *name, const char *kind,
                                const char *help, double value)
{
    server_metrics_write_head(writer, name, kind, help);
    proto_append_format(writer, "geodesicd_%s %.17g\n", name, value);
}

static void write_problems(const struct server_metrics *metrics, struct proto_writer *writer)
{
    server_metrics_write_head(writer, "problems_total", "counter",
                              "Requests refused or failed, by the code of the problem.");
    for (int code = PROTO_PROBLEM_NONE + 1; code < PROBLEMS; code++)
        proto_append_format(writer, "geodesicd_problems_total{code=\"%s\"} %llu\n",
                            proto_problem_name(code),
                            (unsigned long long)atomic_load(&metrics->problems[code]));
}

static void write_process(const struct server_metrics *metrics, struct proto_writer *writer)
{
    server_metrics_write_head(writer, "build_info", "gauge",
                              "The program's version and the instructions that its kernels use.");
    proto_append_format(writer,
                        "geodesicd_build_info{version=\"" SERVER_VERSION "\",cpu=\"%s\"} 1\n",
                        gd_cpu_name());
    server_metrics_write_value(writer, "uptime_seconds", "gauge", "Time since the start.",
                               (double)(gd_now_ns() - metrics->started_ns) / 1e9);
    server_metrics_write_value(writer, "failed_checks_total", "counter",
                               "Answers withheld because a self-check failed or the work ran away.",
                               (double)atomic_load(&metrics->failed_checks));
    server_metrics_write_value(writer, "log_lines_dropped_total", "counter",
                               "Lines of the log that nobody read in time.",
                               (double)server_log_dropped());
}

void server_metrics_write(const struct server_metrics *metrics, struct proto_writer *writer)
{
    write_requests(metrics, writer);
    server_metrics_write_head(writer, "request_seconds", "histogram",
                              "Time from the request line to the answer.");
    for (size_t row = 0; row <= metrics->route_count; row++) write_histogram(metrics, row, writer);
    write_problems(metrics, writer);
    server_metrics_write_value(writer, "searches_total", "counter",
                               "Pairs that were searched, no field being there.",
                               (double)atomic_load(&metrics->searches));
    server_metrics_write_value(writer, "field_windows_total", "counter",
                               "Windows propagated for fields: the engine's work.",
                               (double)atomic_load(&metrics->windows));
    write_process(metrics, writer);
}
