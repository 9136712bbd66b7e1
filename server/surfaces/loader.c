/* See loader.h. */
#include "server/surfaces/loader.h"

#include <stdlib.h>

#include "server/surfaces/build.h"
#include "server/surfaces/field_store.h"
#include "server/store/kind.h"
#include "server/base/log.h"

static bool on_progress(void *user, double fraction)
{
    struct server *server = user;
    (void)fraction;
    return server_workers_go_on(server->workers);
}

/* A fault of the stored data, which is the operator's to mend, is logged, and told in general
 * terms. */
static enum server_loader_outcome complain(const struct server_record *record, const char *what,
                                           struct proto_problem *problem)
{
    struct server_log_line line;
    if (server_log_begin(&line, SERVER_LOG_ERROR, "surface_unavailable")) {
        server_log_text(&line, "key", record->key);
        server_log_text(&line, "sha256", record->sha256);
        server_log_text(&line, "message", what);
        server_log_end(&line);
    }
    proto_problem_set(
        problem, PROTO_PROBLEM_INTERNAL,
        "the stored file of this %s is unavailable (%s); upload the %s again to replace it",
        record->kind->noun, what, record->kind->noun);
    return SERVER_LOADER_DAMAGED;
}

/* One load under way: its parts, and what they take of SERVER_BUDGET_FLIGHT. */
struct loading {
    struct server *server;
    struct server_record *record;
    struct server_builder builder;
    void *parts[SERVER_PARTS];
    size_t held;
};

static enum server_loader_outcome take(struct loading *loading, struct proto_problem *problem)
{
    const struct server_record *record = loading->record;
    size_t bytes = (size_t)(record->size + record->attachment_size);
    if (server_build_take(&loading->builder, record, bytes, problem))
        return SERVER_LOADER_NO_MEMORY;
    loading->held = bytes;
    return SERVER_LOADER_LOADED;
}

static enum server_loader_outcome fetch(struct loading *loading, enum server_part part,
                                        struct proto_problem *problem)
{
    const struct server_record *record = loading->record;
    switch (server_registry_fetch(loading->server->registry, record, part, &loading->parts[part])) {
    case SERVER_STORE_DONE:
        return SERVER_LOADER_LOADED;
    case SERVER_STORE_ABSENT:
        return server_registry_is_current(loading->server->registry, record)
                   ? complain(record, "it is missing", problem)
                   : SERVER_LOADER_GONE;
    case SERVER_STORE_NO_MEMORY:
        server_build_refuse(&loading->builder, record, GD_BUDGET, NULL, problem);
        return SERVER_LOADER_NO_MEMORY;
    case SERVER_STORE_UNAVAILABLE:
        (void)proto_problem_set(problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                                "the %s is not in memory, and the database that has it does not "
                                "answer; try again in a moment",
                                record->kind->noun);
        problem->retry_after = 1;
        return SERVER_LOADER_UNAVAILABLE;
    case SERVER_STORE_DAMAGED:
        return complain(record, "it is damaged: its SHA-256 is another one", problem);
    default:
        return complain(record, "it can't be read", problem);
    }
}

static enum server_loader_outcome fetch_all(struct loading *loading, struct proto_problem *problem)
{
    enum server_loader_outcome outcome = SERVER_LOADER_LOADED;
    struct server_object object;
    for (int part = 0; !outcome && part < SERVER_PARTS; part++)
        if (server_record_object(loading->record, part, &object))
            outcome = fetch(loading, part, problem);
    return outcome;
}

/* The attachment becomes the surface's. */
static void attach(struct loading *loading, struct server_surface *surface)
{
    if (!loading->parts[SERVER_PART_ATTACHMENT]) return;
    server_surface_attach(surface, loading->parts[SERVER_PART_ATTACHMENT]);
    loading->parts[SERVER_PART_ATTACHMENT] = NULL;
    loading->held -= (size_t)loading->record->attachment_size;
}

static enum server_loader_outcome build(struct loading *loading, struct server_surface **out,
                                        struct proto_problem *problem)
{
    struct proto_problem refusal;
    enum gd_status status = server_build_surface(&loading->builder, loading->record,
                                                 loading->parts[SERVER_PART_FILE], out, &refusal);
    if (!status) {
        attach(loading, *out);
        return SERVER_LOADER_LOADED;
    }
    *problem = refusal;
    if (status == GD_BUDGET || status == GD_NO_MEMORY) return SERVER_LOADER_NO_MEMORY;
    if (status == GD_DEADLINE || status == GD_CANCELLED) return SERVER_LOADER_ENDED;
    return complain(loading->record, refusal.detail, problem);
}

static void end(struct loading *loading)
{
    for (int part = 0; part < SERVER_PARTS; part++) free(loading->parts[part]);
    server_budget_give(&loading->server->budget, SERVER_BUDGET_FLIGHT, loading->held);
}

enum server_loader_outcome server_loader_load(struct server *server, struct server_record *record,
                                              uint64_t deadline_ns, struct server_surface **out,
                                              struct proto_problem *problem)
{
    const struct gd_control control = {
        .deadline_ns = deadline_ns, .progress = on_progress, .user = server};
    struct loading loading = {.server = server,
                              .record = record,
                              .builder = {.budget = &server->budget,
                                          .cache = server->cache,
                                          .max_faces = (uint32_t)server->config.max_faces,
                                          .control = control}};
    struct server_surface *surface = NULL;
    enum server_loader_outcome outcome = take(&loading, problem);
    if (!outcome) outcome = fetch_all(&loading, problem);
    if (!outcome) outcome = build(&loading, &surface, problem);
    end(&loading);
    if (outcome) return outcome;
    if (server->config.persist_fields)
        server_field_store_restore(server->fields, surface, &control);
    server_registry_keep(server->registry, surface);
    *out = surface;
    return SERVER_LOADER_LOADED;
}
