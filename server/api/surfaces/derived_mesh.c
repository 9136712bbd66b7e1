/* See making.h. */
#include "server/api/surfaces/derived_mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"
#include "server/surfaces/build.h"
#include "server/api/surfaces/description.h"
#include "server/surfaces/kind.h"
#include "server/query/api.h"

#define MADE_OPTIONS "format=ply&triangulate=true" /* as the kind of meshes writes them */
#define COPY_BYTES   ((size_t)4 << 20)             /* between two looks at the control */

void server_making_begin(struct server_making *making, struct server_exchange *exchange)
{
    *making = (struct server_making){.exchange = exchange};
}

void server_making_end(struct server_making *making)
{
    if (!making->exchange) return;
    for (uint32_t i = 0; i < making->count; i++) {
        server_surface_release(making->made[i].surface);
        free(making->made[i].file);
    }
    server_budget_give(making->exchange->host->budget, SERVER_BUDGET_FLIGHT, making->held);
    *making = (struct server_making){0};
}

/* --- building --------------------------------------------------------------------------------- */

static void drop_attachment(struct server_budget *budget, const struct server_record *record,
                            void *attachment)
{
    if (!attachment) return;
    free(attachment);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, (size_t)record->attachment_size);
}

/* A record that was in the registry before is complete, and immutable. */
static bool complete(struct server_surface *surface)
{
    return surface->record->description || server_description_remember(surface);
}

struct server_surface *server_making_build(struct server_exchange *exchange,
                                           struct server_record *record, const void *bytes,
                                           void *attachment, struct proto_problem *problem)
{
    struct server_host *host = exchange->host;
    struct server_monitor monitor = {.exchange = exchange};
    const struct server_builder builder = {.budget = host->budget,
                                           .cache = host->api->cache,
                                           .max_faces = (uint32_t)host->api->config->max_faces,
                                           .control = server_exchange_control(&monitor)};
    struct server_surface *surface;
    if (server_build_surface(&builder, record, bytes, &surface, problem)) {
        drop_attachment(host->budget, record, attachment);
        return NULL;
    }
    if (attachment) server_surface_attach(surface, attachment);
    if (complete(surface)) return surface;
    server_surface_release(surface);
    proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return NULL;
}

/* --- one mesh --------------------------------------------------------------------------------- */

/* Counts bytes as the making's. */
static bool hold(struct server_making *making, size_t bytes, struct proto_problem *problem)
{
    struct server_budget *budget = making->exchange->host->budget;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, bytes))
        return server_budget_refuse(budget, "the mesh", bytes, problem);
    making->held += bytes;
    return true;
}

static bool check_name(const struct server_making *making, const char *name,
                       struct proto_problem *problem)
{
    if (making->count == SERVER_MADE_MOST)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "one request makes at most %d meshes; ask for fewer at a time",
                                 SERVER_MADE_MOST);
    if (!proto_mesh_name_check(name, strlen(name), problem)) return false;
    for (uint32_t i = 0; i < making->count; i++)
        if (strcmp(making->made[i].surface->record->name, name) == 0)
            return proto_problem_set(
                problem, PROTO_PROBLEM_INVALID_REQUEST,
                "two of the meshes would have the name '%s'; name each one differently", name);
    return true;
}

/* Upper bound of the file's bytes: doubles, and of each polygon its corners and their number. */
static size_t file_cost(const struct gd_polygons *polygons)
{
    return polygons->position_count * 3 * sizeof(double) +
           gd_polygons_corner_count(polygons) * sizeof(uint32_t) +
           polygons->polygon_count * sizeof(uint32_t) + 1024;
}

enum gd_status server_making_copy(void *to, const void *from, size_t size,
                                  const struct gd_control *control)
{
    enum gd_status status = GD_OK;
    for (size_t at = 0; !status && at < size; at += COPY_BYTES) {
        status = gd_control_check(control, 0);
        if (!status)
            memcpy((char *)to + at, (const char *)from + at,
                   size - at < COPY_BYTES ? size - at : COPY_BYTES);
    }
    return status;
}

/* A mesh that is being made. All borrowed. */
struct draft {
    const char *name, *file;
    size_t size;
    const struct server_attachment *attachment; /* NULL: none */
    const struct gd_control *control;
};

/* The record of the file: the one that the name has already, if it is the same. */
static enum gd_status identify(const struct server_exchange *exchange, const struct draft *draft,
                               struct server_record **out)
{
    const struct server_attachment *attachment = draft->attachment;
    char sha256[SERVER_SHA256_HEX], attachment_sha256[SERVER_SHA256_HEX];
    struct server_origin origin = {.key = {exchange->tenant, &server_kind_mesh, draft->name},
                                   .sha256 = sha256,
                                   .size = draft->size,
                                   .options = MADE_OPTIONS};
    enum gd_status status = server_sha256_within(draft->file, draft->size, draft->control, sha256);
    if (!status && attachment) {
        status = server_sha256_within(attachment->bytes, attachment->size, draft->control,
                                      attachment_sha256);
        origin.attachment_sha256 = attachment_sha256;
        origin.attachment_size = attachment->size;
    }
    if (status) return status;
    struct server_record *record = server_record_create(&origin);
    struct server_listed before;
    if (record && server_registry_find(exchange->host->api->registry, &origin.key, &before)) {
        if (server_record_equal(before.record, record)) {
            server_record_release(record);
            record = server_record_retain(before.record);
        }
        server_listed_release(&before);
    }
    *out = record;
    return record ? GD_OK : GD_NO_MEMORY;
}

/* A copy that is counted as SERVER_BUDGET_FLIGHT; NULL with the problem. */
static void *copy_attachment(struct server_budget *budget, const struct draft *draft,
                             struct proto_problem *problem)
{
    const struct server_attachment *attachment = draft->attachment;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, attachment->size)) {
        server_budget_refuse(budget, "the mesh", attachment->size, problem);
        return NULL;
    }
    void *copy = malloc(attachment->size);
    enum gd_status status =
        copy ? server_making_copy(copy, attachment->bytes, attachment->size, draft->control)
             : GD_NO_MEMORY;
    if (!status) return copy;
    free(copy);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, attachment->size);
    proto_problem_from_status(problem, status, NULL);
    return NULL;
}

/* The surface of a file that is written. */
static struct server_surface *make(struct server_exchange *exchange, const struct draft *draft,
                                   struct proto_problem *problem)
{
    struct server_surface *surface = NULL;
    struct server_record *record = NULL;
    void *copy = NULL;
    enum gd_status status = identify(exchange, draft, &record);
    if (status)
        proto_problem_from_status(problem, status, NULL);
    else if (!draft->attachment || (copy = copy_attachment(exchange->host->budget, draft, problem)))
        surface = server_making_build(exchange, record, draft->file, copy, problem);
    server_record_release(record);
    return surface;
}

bool server_making_add(struct server_making *making, const char *name,
                       const struct gd_polygons *polygons,
                       const struct server_attachment *attachment, struct proto_problem *problem)
{
    struct server_monitor monitor = {.exchange = making->exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    struct draft draft = {.name = name, .attachment = attachment, .control = &control};
    char *file;
    if (!check_name(making, name, problem) || !hold(making, file_cost(polygons), problem))
        return false;
    enum gd_status status =
        gd_write_polygons_within(polygons, GD_FORMAT_PLY, &control, &file, &draft.size);
    if (status) return proto_problem_from_status(problem, status, NULL);
    draft.file = file;
    struct server_surface *surface = make(making->exchange, &draft, problem);
    if (!surface) {
        free(file);
        return false;
    }
    making->made[making->count++] = (struct server_made){.surface = surface, .file = file};
    return true;
}

/* --- storing ---------------------------------------------------------------------------------- */

/* Removes those that were created, unless somebody has put others in their place meanwhile. */
static void undo(const struct server_making *making, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct server_record *record = making->made[i].surface->record;
        const struct server_key key = server_record_key(record);
        char tag[SERVER_ETAG + 2];
        if (!making->made[i].is_new) continue;
        snprintf(tag, sizeof tag, "\"%s\"", record->etag);
        const struct server_precondition same = {.if_match = {tag}};
        (void)server_registry_remove(making->exchange->host->api->registry, &key, &same);
    }
}

enum server_store_outcome server_making_store(struct server_making *making)
{
    static const struct server_precondition none;
    bool is_new = true;
    for (uint32_t i = 0; i < making->count; i++) {
        struct server_made *made = &making->made[i];
        enum server_store_outcome outcome = server_registry_put(
            making->exchange->host->api->registry, made->surface, made->file, &none);
        if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
            undo(making, i);
            return outcome;
        }
        made->is_new = outcome == SERVER_STORE_CREATED;
        is_new &= made->is_new;
    }
    return is_new ? SERVER_STORE_CREATED : SERVER_STORE_REPLACED;
}
