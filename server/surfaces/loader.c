/* See loader.h. */
#include "server/surfaces/loader.h"

#include <stdlib.h>

#include "server/base/log.h"
#include "server/store/kind.h"

struct load {
    const struct server_loader *loader;
    struct server_record *record;
    struct server_builder builder;
    struct proto_problem *problem;
    void *parts[SERVER_PARTS];
    size_t held; /* by the parts, of SERVER_BUDGET_FLIGHT */
};

static bool on_progress(void *user, double fraction)
{
    const struct server_loader *loader = user;
    (void)fraction;
    return server_workers_go_on(loader->workers);
}

/* Logs a fault of the stored data for the operator, and tells the client in general terms. */
static enum server_loader_outcome report_damage(const struct load *load, const char *what)
{
    const struct server_record *record = load->record;
    struct server_log_line line;
    if (server_log_begin(&line, SERVER_LOG_ERROR, "surface_unavailable")) {
        server_log_text(&line, "key", record->key);
        server_log_text(&line, "sha256", record->sha256);
        server_log_text(&line, "message", what);
        server_log_end(&line);
    }
    proto_problem_set(
        load->problem, PROTO_PROBLEM_INTERNAL,
        "the stored file of this %s is unavailable (%s); upload the %s again to replace it",
        record->kind->noun, what, record->kind->noun);
    return SERVER_LOADER_DAMAGED;
}

static enum server_loader_outcome fetch_part(struct load *load, enum server_part part)
{
    struct server_registry *registry = load->loader->registry;
    struct server_store *store = server_registry_store(registry);
    switch (store->fetch(store, load->record, part, &load->parts[part])) {
    case SERVER_STORE_DONE:
        return SERVER_LOADER_LOADED;
    case SERVER_STORE_ABSENT:
        return server_registry_is_current(registry, load->record)
                   ? report_damage(load, "it is missing")
                   : SERVER_LOADER_GONE;
    case SERVER_STORE_NO_MEMORY:
        server_build_refuse(&load->builder, load->record, GD_BUDGET, NULL, load->problem);
        return SERVER_LOADER_NO_MEMORY;
    case SERVER_STORE_UNAVAILABLE:
        (void)proto_problem_set(load->problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                                "the %s is not in memory, and the database that has it does not "
                                "answer; try again in a moment",
                                load->record->kind->noun);
        load->problem->retry_after = 1;
        return SERVER_LOADER_UNAVAILABLE;
    case SERVER_STORE_DAMAGED:
        return report_damage(load, "it is damaged: its SHA-256 is another one");
    default:
        return report_damage(load, "it can't be read");
    }
}

static enum server_loader_outcome fetch_parts(struct load *load)
{
    const struct server_record *record = load->record;
    enum server_loader_outcome outcome = SERVER_LOADER_LOADED;
    struct server_object object;
    size_t bytes = (size_t)(record->size + record->attachment_size);
    if (server_build_take(&load->builder, record, bytes, load->problem))
        return SERVER_LOADER_NO_MEMORY;
    load->held = bytes;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (server_record_object(record, part, &object)) outcome = fetch_part(load, part);
    return outcome;
}

/* Builds the surface, which takes over the attachment. */
static enum server_loader_outcome build_surface(struct load *load, struct server_surface **out)
{
    struct proto_problem refusal;
    void **attachment = &load->parts[SERVER_PART_ATTACHMENT];
    switch (server_build_surface(&load->builder, load->record, load->parts[SERVER_PART_FILE], out,
                                 &refusal)) {
    case GD_OK:
        if (!*attachment) return SERVER_LOADER_LOADED;
        server_surface_attach(*out, *attachment);
        *attachment = NULL;
        load->held -= (size_t)load->record->attachment_size;
        return SERVER_LOADER_LOADED;
    case GD_BUDGET:
    case GD_NO_MEMORY:
        *load->problem = refusal;
        return SERVER_LOADER_NO_MEMORY;
    case GD_DEADLINE:
    case GD_CANCELLED:
        *load->problem = refusal;
        return SERVER_LOADER_ENDED;
    default:
        *load->problem = refusal;
        return report_damage(load, refusal.detail);
    }
}

enum server_loader_outcome server_loader_load(const struct server_loader *loader,
                                              struct server_record *record, uint64_t deadline_ns,
                                              struct server_surface **out,
                                              struct proto_problem *problem)
{
    const struct gd_control control = {
        .deadline_ns = deadline_ns, .progress = on_progress, .user = (void *)loader};
    struct load load = {.loader = loader,
                        .record = record,
                        .problem = problem,
                        .builder = {.budget = loader->budget,
                                    .cache = loader->cache,
                                    .max_faces = loader->max_faces,
                                    .control = control}};
    enum server_loader_outcome outcome = fetch_parts(&load);
    if (!outcome) outcome = build_surface(&load, out);
    for (int part = 0; part < SERVER_PARTS; part++) free(load.parts[part]);
    server_budget_give(loader->budget, SERVER_BUDGET_FLIGHT, load.held);
    if (outcome) return outcome;
    if (loader->field_store) server_field_store_restore(loader->field_store, *out, &control);
    server_registry_keep(loader->registry, *out);
    return SERVER_LOADER_LOADED;
}
