/* API: the parts of the daemon that only handlers use. The parts that every request uses are in
 * struct server_host. server.c fills in both structs. All parts outlive the exchanges. */
#pragma once

#include "server/config/config.h"
#include "server/fields/cache.h"
#include "server/exchange/exchange.h"
#include "server/exchange/metrics.h"
#include "server/fields/discretizations.h"
#include "server/surfaces/landmarks.h"
#include "server/surfaces/loader.h"
#include "server/surfaces/previews.h"
#include "server/surfaces/registry.h"
#include "server/work/budgeted_call.h"

struct server_batch_runner;
struct server_job_table;

struct server_api {
    const struct server_config *config;
    struct server_access *access; /* NULL means that the daemon has no keys */
    struct server_registry *registry;
    struct server_workers *writer; /* one thread, for work that waits for the store's disk */
    struct server_workers *lister; /* one thread, for long lists */
    struct server_cache *cache;
    struct server_loader *loader;
    struct server_background *landmarks; /* NULL means disabled */
    struct server_background *previews;
    struct server_discretizations *discretizations;
    struct server_job_table *jobs;
    struct server_batch_runner *batches;
    /* Appends the metrics of the tenant, or of the whole daemon if `tenant` is NULL. */
    void (*write_metrics)(void *source, const char *tenant, struct proto_writer *writer);
    void *metrics_source;
};
