/* See loader.h. */
#include "server/loader.h"

#include <stdlib.h>

#include "server/build.h"
#include "server/field_store.h"
#include "server/log.h"

static bool on_progress(void *user, double fraction)
{
    struct server *server = user;
    (void)fraction;
    return !server_workers_cancelled(server->workers);
}

/* A fault of the stored data, which is the operator's to mend, is logged, and told in general terms. */
static enum server_loader_outcome complain(const struct server_record *record, const char *what,
                                           struct proto_problem *problem)
{
    struct server_log_line line;
    if (server_log_begin(&line, SERVER_LOG_ERROR, "mesh_unavailable")) {
        server_log_text(&line, "name", record->name);
        server_log_text(&line, "sha256", record->sha256);
        server_log_text(&line, "message", what);
        server_log_end(&line);
    }
    proto_problem_set(problem, PROTO_PROBLEM_INTERNAL,
                      "the stored file of this mesh is unavailable (%s); upload the mesh again to replace it", what);
    return SERVER_LOADER_DAMAGED;
}

/* Is the record its name's still? Asked after its bytes were missed: they go only after the registry has forgotten
 * the record (store.h), so if it is, they are missing indeed. */
static bool is_current(struct server *server, const struct server_record *record)
{
    struct server_listed listed;
    if (!server_registry_find(server->registry, record->name, &listed)) return false;
    bool is_same = listed.record == record;
    server_listed_release(&listed);
    return is_same;
}

static enum server_loader_outcome fetch(struct server *server, const struct server_record *record, void **bytes,
                                        struct proto_problem *problem)
{
    switch (server_registry_fetch(server->registry, record, bytes)) {
    case SERVER_STORE_DONE:
        return SERVER_LOADER_LOADED;
    case SERVER_STORE_ABSENT:
        return is_current(server, record) ? complain(record, "it is missing", problem) : SERVER_LOADER_GONE;
    case SERVER_STORE_NO_MEMORY:
        server_budget_refuse(&server->budget, "the mesh", (size_t)record->size, problem);
        return SERVER_LOADER_NO_MEMORY;
    case SERVER_STORE_DAMAGED:
        return complain(record, "it is damaged: its SHA-256 is another one", problem);
    default:
        return complain(record, "it can't be read", problem);
    }
}

static enum server_loader_outcome build(struct server *server, struct server_record *record, const void *bytes,
                                        const struct gd_control *control, struct server_surface **out,
                                        struct proto_problem *problem)
{
    const struct server_builder builder = {.budget = &server->budget,
                                           .cache = server->cache,
                                           .max_faces = (uint32_t)server->config.max_faces,
                                           .control = *control};
    struct proto_problem refusal;
    enum gd_status status = server_build_surface(&builder, record, bytes, out, &refusal);
    if (!status) return SERVER_LOADER_LOADED;
    *problem = refusal;
    if (status == GD_BUDGET || status == GD_NO_MEMORY) return SERVER_LOADER_NO_MEMORY;
    if (status == GD_DEADLINE || status == GD_CANCELLED) return SERVER_LOADER_ENDED;
    return complain(record, refusal.detail, problem);
}

enum server_loader_outcome server_loader_load(struct server *server, struct server_record *record, uint64_t deadline_ns,
                                              struct server_surface **out, struct proto_problem *problem)
{
    const struct gd_control control = {.deadline_ns = deadline_ns, .progress = on_progress, .user = server};
    size_t size = (size_t)record->size;
    void *bytes = NULL;
    if (!server_budget_take(&server->budget, SERVER_BUDGET_FLIGHT, size)) {
        server_budget_refuse(&server->budget, "the mesh", size, problem);
        return SERVER_LOADER_NO_MEMORY;
    }
    struct server_surface *surface = NULL;
    enum server_loader_outcome outcome = fetch(server, record, &bytes, problem);
    if (!outcome) outcome = build(server, record, bytes, &control, &surface, problem);
    free(bytes);
    server_budget_give(&server->budget, SERVER_BUDGET_FLIGHT, size);
    if (outcome) return outcome;
    if (server->config.persist_fields) server_field_store_restore(server->fields, surface, &control);
    server_registry_keep(server->registry, surface);
    *out = surface;
    return SERVER_LOADER_LOADED;
}
