#include "server/surfaces/loader.h"

#include <pthread.h>
#include <stdlib.h>
#include <sys/queue.h>

#include "server/base/log.h"
#include "server/base/thread.h"

#define NOTE_NS     UINT64_C(60000000000)
#define LOAD_FACTOR 3 /* limit on the memory of a load, in multiples of the surface's size */

struct server_loader {
    struct server_loader_parts parts;
    pthread_mutex_t lock;
    /* current loads: at most one for each worker, and one of the thread */
    LIST_HEAD(, load) loads;
    struct server_thread *thread; /* NULL means that the thread was not started */
};

struct load {
    LIST_ENTRY(load) next;
    struct server_loader *loader;
    struct server_builder builder; /* its member `bytes` is unset until the file is fetched */
    void *parts[SERVER_PARTS];
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT that the parts hold */
};

static bool load_progress(void *user, double fraction)
{
    const struct load *load = user;
    (void)fraction;
    return server_workers_go_on(load->loader->parts.workers);
}

/* Logs damage of the stored data for the operator, and sets a general problem for the client. */
static enum server_loader_outcome load_report_damage(const struct load *load, const char *what)
{
    const struct server_record *record = load->builder.record;
    struct server_log_line line;
    if (server_log_begin(&line, SERVER_LOG_ERROR, "surface_unavailable")) {
        server_log_text(&line, "key", record->key);
        server_log_text(&line, "sha256", record->sha256);
        server_log_text(&line, "message", what);
        server_log_end(&line);
    }
    proto_problem_set(
        load->builder.problem, PROTO_PROBLEM_INTERNAL,
        "the stored file of this %s is unavailable (%s); upload the %s again to replace it",
        record->kind->noun, what, record->kind->noun);
    return SERVER_LOADER_FAILED;
}

static enum server_loader_outcome load_fetch_part(struct load *load, enum server_part part)
{
    struct server_registry *registry = load->loader->parts.registry;
    struct server_store *store = server_registry_store(registry);
    switch (store->fetch(store, &load->builder.record->objects[part], &load->parts[part])) {
    case SERVER_STORE_DONE:
        return SERVER_LOADER_LOADED;
    case SERVER_STORE_ABSENT:
        return server_registry_is_current(registry, load->builder.record)
                   ? load_report_damage(load, "it is missing")
                   : SERVER_LOADER_GONE;
    case SERVER_STORE_NO_MEMORY:
        server_build_refuse(&load->builder, GD_BUDGET, NULL);
        return SERVER_LOADER_FAILED;
    case SERVER_STORE_UNAVAILABLE:
        (void)proto_problem_set(load->builder.problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                                "the %s is not in memory, and the database that has it does not "
                                "answer; try again in a moment",
                                load->builder.record->kind->noun);
        load->builder.problem->retry_after = 1;
        return SERVER_LOADER_FAILED;
    case SERVER_STORE_DAMAGED:
        return load_report_damage(load, "it is damaged: its SHA-256 differs");
    default:
        return load_report_damage(load, "it can't be read");
    }
}

static enum server_loader_outcome load_fetch(struct load *load)
{
    const struct server_record *record = load->builder.record;
    enum server_loader_outcome outcome = SERVER_LOADER_LOADED;
    size_t bytes = (size_t)(record->size + record->attachment_size);
    if (server_build_take(&load->builder, bytes)) return SERVER_LOADER_FAILED;
    load->held = bytes;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (record->objects[part].id[0]) outcome = load_fetch_part(load, part);
    return outcome;
}

/* Builds the surface, which takes over the attachment. */
static enum server_loader_outcome load_build(struct load *load, struct server_surface **out)
{
    struct proto_problem *problem = load->builder.problem;
    void **attachment = &load->parts[SERVER_PART_ATTACHMENT];
    load->builder.file = &load->parts[SERVER_PART_FILE];
    load->builder.bytes = *load->builder.file;
    enum gd_status status = server_build_surface(&load->builder, out);
    if (status == GD_BUDGET || status == GD_NO_MEMORY || status == GD_DEADLINE ||
        status == GD_CANCELLED)
        return SERVER_LOADER_FAILED;
    if (status) {
        const struct proto_problem refusal = *problem;
        return load_report_damage(load, refusal.detail);
    }
    if (!*attachment) return SERVER_LOADER_LOADED;
    server_surface_attach(*out, *attachment);
    *attachment = NULL;
    load->held -= (size_t)load->builder.record->attachment_size;
    return SERVER_LOADER_LOADED;
}

/* Under the lock: parks a job, which may be NULL, if the record is being loaded. Returns false if
 * it is not being loaded, or if the workers were cancelled. */
static bool load_park(struct server_loader *loader, const struct server_record *record,
                      struct server_job *job)
{
    struct load *load = LIST_FIRST(&loader->loads);
    while (load && load->builder.record != record) load = LIST_NEXT(load, next);
    return load && (!job || server_workers_park(loader->parts.workers, job, load, 0));
}

bool server_loader_join(struct server_loader *loader, const struct server_record *record,
                        struct server_job *job)
{
    SERVER_LOCK(&loader->lock);
    return load_park(loader, record, job);
}

/* Ends a load. If it failed because memory is short, refuses the parked jobs. After success or any
 * other failure, resumes them, because what made this load fail may not affect them. */
static void load_end(struct load *load, enum server_loader_outcome outcome)
{
    struct server_loader *loader = load->loader;
    pthread_mutex_lock(&loader->lock);
    LIST_REMOVE(load, next);
    pthread_mutex_unlock(&loader->lock);
    if (outcome == SERVER_LOADER_FAILED &&
        load->builder.problem->code == PROTO_PROBLEM_INSUFFICIENT_MEMORY) {
        server_workers_refuse_parked(loader->parts.workers, load, SERVER_REFUSAL_MEMORY);
    } else {
        server_workers_unpark(loader->parts.workers, load);
    }
}

enum server_loader_outcome server_loader_load(struct server_loader *loader,
                                              struct server_record *record, struct server_job *job,
                                              struct server_surface **out,
                                              struct proto_problem *problem)
{
    const struct server_loader_parts *parts = &loader->parts;
    struct load load = {.loader = loader,
                        .builder = {.record = record,
                                    .problem = problem,
                                    .budget = parts->budget,
                                    .cache = parts->cache,
                                    .max_faces = parts->max_faces,
                                    .workers = parts->workers,
                                    .control = {.deadline_ns = job ? job->deadline_ns : 0,
                                                .progress = load_progress,
                                                .user = &load}}};
    pthread_mutex_lock(&loader->lock);
    bool is_parked = load_park(loader, record, job);
    if (!is_parked) LIST_INSERT_HEAD(&loader->loads, &load, next);
    pthread_mutex_unlock(&loader->lock);
    if (is_parked) return SERVER_LOADER_WAITING;
    enum server_loader_outcome outcome = load_fetch(&load);
    if (!outcome) outcome = load_build(&load, out);
    for (int part = 0; part < SERVER_PARTS; part++) free(load.parts[part]);
    server_budget_give(parts->budget, SERVER_BUDGET_FLIGHT, load.held);
    if (!outcome) {
        if (parts->field_store)
            server_field_store_restore(parts->field_store, *out, &load.builder.control);
        server_registry_keep(parts->registry, *out);
    }
    load_end(&load, outcome);
    return outcome;
}

/* Loads the most used surfaces first, until the next surface would need more than the free
 * memory. */
static void loader_preload_all(struct server_loader *loader)
{
    const struct server_loader_parts *parts = &loader->parts;
    size_t limit = parts->budget->limit;
    bool fits = true;
    while (fits && !server_workers_cancelled(parts->workers)) {
        struct server_record *record = server_registry_hottest(parts->registry);
        struct server_surface *surface;
        struct proto_problem problem;
        if (!record) return;
        size_t total = atomic_load(&parts->budget->total);
        fits = total < limit && record->memory * LOAD_FACTOR < limit - total;
        if (fits &&
            server_loader_load(loader, record, NULL, &surface, &problem) == SERVER_LOADER_LOADED)
            server_surface_release(surface);
        server_record_release(record);
    }
}

/* Preloads surfaces. Daemons that share a store load surfaces only on demand. */
static void loader_run(void *user, struct server_thread *thread)
{
    struct server_loader *loader = user;
    struct server_registry *registry = loader->parts.registry;
    if (!server_registry_is_shared(registry)) loader_preload_all(loader);
    while (server_thread_pause(thread, NOTE_NS)) server_registry_note_uses(registry);
}

bool server_loader_preload(struct server_loader *loader)
{
    loader->thread = server_thread_start(loader_run, loader);
    return loader->thread != NULL;
}

void server_loader_stop(struct server_loader *loader)
{
    server_thread_stop(loader->thread);
    loader->thread = NULL;
}

struct server_loader *server_loader_create(const struct server_loader_parts *parts)
{
    struct server_loader *loader = calloc(1, sizeof *loader);
    if (!loader) return NULL;
    loader->parts = *parts;
    pthread_mutex_init(&loader->lock, NULL);
    return loader;
}

void server_loader_destroy(struct server_loader *loader)
{
    if (!loader) return;
    server_loader_stop(loader);
    pthread_mutex_destroy(&loader->lock);
    free(loader);
}
