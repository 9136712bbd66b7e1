/* Metrics: counters of requests and of the engine's work, and text for Prometheus.
 *
 * Counters are sharded: each thread counts in its own shard with relaxed atomics, so that HTTP
 * threads share no cache line. Readers sum the shards. Thread-safe. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "gd/status.h"
#include "proto/http/route.h"
#include "proto/json/writer.h"

struct server_metrics;

/* Creates metrics for the generated route table. Returns NULL if out of memory. */
struct server_metrics *server_metrics_create(const struct proto_route *routes, size_t route_count);
void server_metrics_destroy(struct server_metrics *metrics); /* NULL is allowed */

/* Counts an answered request, and its problem unless that is PROTO_PROBLEM_NONE. `route` is a row
 * of the table, or NULL if no row was found. */
void server_metrics_count(struct server_metrics *metrics, const struct proto_route *route,
                          unsigned status, enum proto_problem_code problem, uint64_t nanoseconds);

/* If the status is a failed self-check (GD_INTERNAL) or a runaway computation, counts it and
 * returns true. */
bool server_metrics_count_status(struct server_metrics *metrics, enum gd_status status);

/* The first function counts the windows of a built field (intervals of edges, the engine's unit of
 * work). The second one counts a search for a pair of points. */
void server_metrics_count_windows(struct server_metrics *metrics, uint64_t windows);
void server_metrics_count_search(struct server_metrics *metrics);

/* Appends the counters as text for Prometheus. */
void server_metrics_write(const struct server_metrics *metrics, struct proto_writer *writer);

/* Appends the lines HELP and TYPE of the metric `geodesicd_NAME`. */
void server_metrics_write_head(struct proto_writer *writer, const char *name, const char *kind,
                               const char *help);

/* A metric with one value: a counter if its name ends in _total, else a gauge. */
struct server_metric {
    const char *name, *help;
    double value;
};

/* Appends metrics, each with the lines HELP and TYPE. */
void server_metrics_write_values(struct proto_writer *writer, const struct server_metric *values,
                                 size_t count);
