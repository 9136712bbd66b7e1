#include "server/exchange/metrics.h"

#include <stdalign.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/control.h"
#include "gd/cpu.h"
#include "server/base/log.h"
#include "server/base/version.h"

#define SHARDS     16
#define CACHE_LINE 64

/* Upper bounds, in seconds, of the buckets of the latency histogram. One more bucket counts longer
 * times. */
static const double bounds[] = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                0.1,    0.25,    0.5,    1,     2.5,    5,     10,   30};
static const unsigned statuses[] = {200, 201, 202, 204, 304, 400, 401, 403, 404, 405, 406, 409,
                                    410, 411, 412, 413, 415, 422, 429, 500, 503, 504, 507};

/* The counters of one route in one shard. */
enum {
    STATUSES = sizeof statuses / sizeof *statuses + 1, /* the last one counts all other statuses */
    FIRST_BUCKET = STATUSES,
    BUCKETS = sizeof bounds / sizeof *bounds + 1,
    NANOSECONDS = FIRST_BUCKET + BUCKETS,
    COUNTERS,
    /* number of codes; INSUFFICIENT_STORAGE is the last */
    PROBLEMS = PROTO_PROBLEM_INSUFFICIENT_STORAGE + 1
};

struct cell {
    alignas(CACHE_LINE) atomic_uint_least64_t counters[COUNTERS];
};

struct server_metrics {
    const struct proto_route *routes;
    size_t rows; /* rows of a shard: one for each route, and one for requests without a route */
    struct cell *cells; /* SHARDS times rows */
    atomic_uint_least64_t failed_checks, searches, windows;
    atomic_uint_least64_t problems[PROBLEMS]; /* indexed by code */
    uint64_t started_ns;
};

struct server_metrics *server_metrics_create(const struct proto_route *routes, size_t route_count)
{
    struct server_metrics *metrics = calloc(1, sizeof *metrics);
    const size_t bytes = SHARDS * (route_count + 1) * sizeof *metrics->cells;
    if (metrics) metrics->cells = aligned_alloc(CACHE_LINE, bytes);
    if (!metrics || !metrics->cells) {
        free(metrics);
        return NULL;
    }
    memset(metrics->cells, 0, bytes);
    metrics->routes = routes;
    metrics->rows = route_count + 1;
    metrics->started_ns = gd_now_ns();
    return metrics;
}

void server_metrics_destroy(struct server_metrics *metrics)
{
    if (metrics) free(metrics->cells);
    free(metrics);
}

/* --- counting --------------------------------------------------------------------------------- */

/* Returns the shard of the calling thread. A thread gets its shard at its first count. */
static unsigned own_shard(void)
{
    static atomic_uint next;
    static _Thread_local unsigned shard = SHARDS;
    if (shard == SHARDS) shard = atomic_fetch_add(&next, 1) % SHARDS;
    return shard;
}

static void counter_add(atomic_uint_least64_t *counter, uint64_t value)
{
    atomic_fetch_add_explicit(counter, value, memory_order_relaxed);
}

void server_metrics_count(struct server_metrics *metrics, const struct proto_route *route,
                          unsigned status, enum proto_problem_code problem, uint64_t nanoseconds)
{
    size_t row = route ? (size_t)(route - metrics->routes) : metrics->rows - 1, code = 0,
           bucket = 0;
    atomic_uint_least64_t *counters = metrics->cells[own_shard() * metrics->rows + row].counters;
    while (code < STATUSES - 1 && statuses[code] != status) code++;
    while (bucket < BUCKETS - 1 && (double)nanoseconds > bounds[bucket] * 1e9) bucket++;
    counter_add(&counters[code], 1);
    counter_add(&counters[FIRST_BUCKET + bucket], 1);
    counter_add(&counters[NANOSECONDS], nanoseconds);
    if (problem != PROTO_PROBLEM_NONE) counter_add(&metrics->problems[problem], 1);
}

bool server_metrics_count_status(struct server_metrics *metrics, enum gd_status status)
{
    bool has_failed = status == GD_INTERNAL || status == GD_RUNAWAY;
    if (has_failed) counter_add(&metrics->failed_checks, 1);
    return has_failed;
}

void server_metrics_count_windows(struct server_metrics *metrics, uint64_t windows)
{
    counter_add(&metrics->windows, windows);
}

void server_metrics_count_search(struct server_metrics *metrics)
{
    counter_add(&metrics->searches, 1);
}

/* --- writing ---------------------------------------------------------------------------------- */

static uint64_t counter_sum(const struct server_metrics *metrics, size_t row, size_t counter)
{
    uint64_t total = 0;
    for (size_t i = 0; i < SHARDS; i++)
        total += atomic_load_explicit(&metrics->cells[i * metrics->rows + row].counters[counter],
                                      memory_order_relaxed);
    return total;
}

void server_metrics_write_head(struct proto_writer *writer, const char *name, const char *kind,
                               const char *help)
{
    proto_append_format(writer, "# HELP geodesicd_%s %s\n# TYPE geodesicd_%s %s\n", name, help,
                        name, kind);
}

enum { LABELS = 160 };

static void row_labels(const struct server_metrics *metrics, size_t row, char out[LABELS])
{
    static const char *const methods[] = {[PROTO_METHOD_GET] = "GET",
                                          [PROTO_METHOD_PUT] = "PUT",
                                          [PROTO_METHOD_POST] = "POST",
                                          [PROTO_METHOD_PATCH] = "PATCH",
                                          [PROTO_METHOD_DELETE] = "DELETE"};
    bool found = row < metrics->rows - 1;
    snprintf(out, LABELS, "method=\"%s\",route=\"%s\"",
             found ? methods[metrics->routes[row].method] : "",
             found ? metrics->routes[row].path : "");
}

static void write_requests(const struct server_metrics *metrics, size_t row,
                           struct proto_writer *writer)
{
    char labels[LABELS];
    row_labels(metrics, row, labels);
    for (size_t status = 0; status < STATUSES; status++) {
        uint64_t count = counter_sum(metrics, row, status);
        if (count)
            proto_append_format(writer, "geodesicd_requests_total{%s,status=\"%u\"} %llu\n", labels,
                                status < STATUSES - 1 ? statuses[status] : 0,
                                (unsigned long long)count);
    }
}

static void write_histogram(const struct server_metrics *metrics, size_t row,
                            struct proto_writer *writer)
{
    unsigned long long total = 0, count = 0;
    char labels[LABELS], bound[32];
    row_labels(metrics, row, labels);
    for (size_t bucket = 0; bucket < BUCKETS; bucket++)
        total += counter_sum(metrics, row, FIRST_BUCKET + bucket);
    if (!total) return;
    for (size_t bucket = 0; bucket < BUCKETS; bucket++) {
        bool is_last = bucket == BUCKETS - 1;
        count = is_last ? total : count + counter_sum(metrics, row, FIRST_BUCKET + bucket);
        snprintf(bound, sizeof bound, "%g", is_last ? 0 : bounds[bucket]);
        proto_append_format(writer, "geodesicd_request_seconds_bucket{%s,le=\"%s\"} %llu\n", labels,
                            is_last ? "+Inf" : bound, count);
    }
    proto_append_format(writer,
                        "geodesicd_request_seconds_sum{%s} %.9f\n"
                        "geodesicd_request_seconds_count{%s} %llu\n",
                        labels, (double)counter_sum(metrics, row, NANOSECONDS) / 1e9, labels,
                        total);
}

void server_metrics_write_values(struct proto_writer *writer, const struct server_metric *values,
                                 size_t count)
{
    for (const struct server_metric *value = values; value < values + count; value++) {
        const char *end = strrchr(value->name, '_');
        bool is_counter = end && strcmp(end, "_total") == 0;
        server_metrics_write_head(writer, value->name, is_counter ? "counter" : "gauge",
                                  value->help);
        proto_append_format(writer, "geodesicd_%s %.17g\n", value->name, value->value);
    }
}

void server_metrics_write(const struct server_metrics *metrics, struct proto_writer *writer)
{
    const struct server_metric values[] = {
        {"searches_total", "Searches for a pair of points without a cached field.",
         (double)atomic_load(&metrics->searches)},
        {"field_windows_total", "Windows propagated for fields: the engine's work.",
         (double)atomic_load(&metrics->windows)},
        {"uptime_seconds", "Time since the start.",
         (double)(gd_now_ns() - metrics->started_ns) / 1e9},
        {"failed_checks_total",
         "Answers withheld because a self-check failed or the work exceeded every bound.",
         (double)atomic_load(&metrics->failed_checks)},
        {"log_lines_dropped_total",
         "Lines of the log that were dropped: standard error was read too slowly.",
         (double)server_log_dropped()},
    };
    server_metrics_write_head(writer, "requests_total", "counter",
                              "Requests answered, by route and status.");
    for (size_t row = 0; row < metrics->rows; row++) write_requests(metrics, row, writer);
    server_metrics_write_head(writer, "request_seconds", "histogram",
                              "Time from the request line to the answer.");
    for (size_t row = 0; row < metrics->rows; row++) write_histogram(metrics, row, writer);
    server_metrics_write_head(writer, "problems_total", "counter",
                              "Requests refused or failed, by the code of the problem.");
    for (int code = PROTO_PROBLEM_NONE + 1; code < PROBLEMS; code++)
        proto_append_format(writer, "geodesicd_problems_total{code=\"%s\"} %llu\n",
                            proto_problem_name(code),
                            (unsigned long long)atomic_load(&metrics->problems[code]));
    server_metrics_write_head(writer, "build_info", "gauge",
                              "The program's version and the CPU instructions that it uses.");
    proto_append_format(writer,
                        "geodesicd_build_info{version=\"" SERVER_VERSION "\",cpu=\"%s\"} 1\n",
                        gd_cpu_name());
    server_metrics_write_values(writer, values, sizeof values / sizeof *values);
}
