#include "server/query/surface_resource.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/io.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/store/kind.h"

#define FILE_OPTIONS "format=ply&triangulate=true" /* in the canonical form of the kind `mesh` */

/* Adds the description to a new record. Records in the registry already have a description, and are
 * immutable. */
static bool record_describe(struct server_surface *surface)
{
    struct server_record *record = surface->record;
    struct proto_writer writer;
    size_t size = 0;
    if (record->description) return true;
    proto_writer_init(&writer, SERVER_DESCRIPTION_MOST);
    record->kind->describe(&writer, surface);
    proto_append(&writer, "", 1); /* the NUL */
    record->description = proto_writer_take(&writer, &size);
    record->memory = surface->bytes;
    proto_writer_free(&writer);
    return record->description != NULL;
}

struct server_surface *server_surface_resource_build(struct server_monitor *part,
                                                     struct server_record *record,
                                                     const struct server_surface_source *source,
                                                     struct proto_problem *problem)
{
    struct server_host *host = part->exchange->host;
    const struct server_builder builder = {.budget = host->budget,
                                           .cache = host->api->cache,
                                           .max_faces = (uint32_t)host->api->config->max_faces,
                                           .control = server_exchange_control(part),
                                           .workers = host->workers,
                                           .record = record,
                                           .bytes = source->bytes,
                                           .mesh = source->mesh,
                                           .problem = problem};
    struct server_surface *surface;
    if (server_build_surface(&builder, &surface)) {
        if (source->attachment)
            server_budget_give(host->budget, SERVER_BUDGET_FLIGHT, (size_t)record->attachment_size);
        free(source->attachment);
        return NULL;
    }
    if (source->attachment) server_surface_attach(surface, source->attachment);
    if (record_describe(surface)) return surface;
    server_surface_release(surface);
    proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return NULL;
}

void server_surface_resource_describe(struct proto_writer *writer,
                                      const struct server_listed *listed)
{
    const char *remembered = listed->record->description;
    char caption[SERVER_CAPTION];
    if (listed->surface)
        listed->record->kind->describe(writer, listed->surface);
    else
        proto_write_raw(writer, remembered, strlen(remembered));
    server_record_caption(listed->record, caption);
    proto_caption_encode(writer, caption);
}

void server_surface_resource_reply(struct server_exchange *exchange, unsigned status,
                                   const struct server_listed *listed)
{
    struct proto_writer writer;
    char caption[SERVER_CAPTION], form[SERVER_ETAG_CAPTION];
    server_reply_writer(exchange, &writer);
    server_surface_resource_describe(&writer, listed);
    server_record_caption(listed->record, caption);
    server_reply_tag(exchange, listed->record->etag, server_etag_caption(form, caption));
    server_reply_json(exchange, status, &writer);
}

void server_surface_resource_reply_stored(struct server_exchange *exchange,
                                          struct server_surface *surface,
                                          enum server_outcome outcome)
{
    const struct server_record *record = surface->record;
    const struct server_listed listed = {surface->record, surface};
    if (!server_request_check_stored(exchange, outcome)) return;
    server_reply_header(exchange, "Location", "/v1/%s/%s", record->kind->plural, record->name);
    server_surface_resource_reply(exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &listed);
}

/* --- derived meshes --------------------------------------------------------------------------- */

void server_derived_meshes_free(struct server_derived_meshes *meshes)
{
    if (!meshes->exchange) return;
    for (uint32_t i = 0; i < meshes->count; i++) {
        server_surface_release(meshes->list[i].surface);
        free(meshes->list[i].file);
    }
    server_budget_give(meshes->exchange->host->budget, SERVER_BUDGET_FLIGHT, meshes->held);
    *meshes = (struct server_derived_meshes){0};
}

static bool name_check(const struct server_derived_meshes *meshes, const char *name,
                       struct proto_problem *problem)
{
    if (meshes->count == SERVER_DERIVED_MESHES_MOST)
        return proto_problem_set(problem, PROTO_PROBLEM_INVALID_REQUEST,
                                 "one request makes at most %d meshes; ask for fewer at a time",
                                 SERVER_DERIVED_MESHES_MOST);
    if (!proto_mesh_name_check(name, strlen(name), problem)) return false;
    for (uint32_t i = 0; i < meshes->count; i++)
        if (strcmp(meshes->list[i].surface->record->name, name) == 0)
            return proto_problem_set(
                problem, PROTO_PROBLEM_INVALID_REQUEST,
                "two of the meshes would have the name '%s'; name each one differently", name);
    return true;
}

/* Returns an upper bound of the bytes of the file: doubles, and for each polygon its corners and
 * their number. */
static size_t file_cost(const struct gd_polygons *polygons)
{
    return polygons->position_count * 3 * sizeof(double) +
           gd_polygons_corner_count(polygons) * sizeof(uint32_t) +
           polygons->polygon_count * sizeof(uint32_t) + 1024;
}

bool server_attachment_create(struct server_attachment *attachment, size_t size,
                              struct server_budget *budget, struct proto_problem *problem)
{
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, size))
        return server_budget_refuse(budget, "the mesh", size, problem);
    *attachment = (struct server_attachment){calloc(1, size), size};
    if (attachment->bytes) return true;
    server_attachment_free(attachment, budget);
    return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
}

void server_attachment_free(const struct server_attachment *attachment,
                            struct server_budget *budget)
{
    free(attachment->bytes);
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, attachment->size);
}

/* A mesh before it is built. */
struct draft {
    const char *name;                           /* borrowed */
    const struct server_attachment *attachment; /* borrowed; NULL means that there is none */
    char *file;                                 /* NULL means that it is not written yet */
    size_t size;
};

/* Writes the file, whose bytes `meshes` holds. */
static bool draft_write(struct draft *draft, struct server_derived_meshes *meshes,
                        const struct gd_polygons *polygons, const struct gd_control *control,
                        struct proto_problem *problem)
{
    struct server_budget *budget = meshes->exchange->host->budget;
    size_t cost = file_cost(polygons);
    if (!name_check(meshes, draft->name, problem)) return false;
    if (!server_budget_take(budget, SERVER_BUDGET_FLIGHT, cost))
        return server_budget_refuse(budget, "the mesh", cost, problem);
    meshes->held += cost;
    enum gd_status status =
        gd_write_polygons_within(polygons, GD_FORMAT_PLY, control, &draft->file, &draft->size);
    return !status || proto_problem_from_status(problem, status, NULL);
}

/* Returns the record of the file: the registry's record if the name already has the same mesh,
 * otherwise a new one. */
static enum gd_status draft_record(const struct server_exchange *exchange,
                                   const struct draft *draft, const struct gd_control *control,
                                   struct server_record **out)
{
    const struct server_attachment *attachment = draft->attachment;
    char sha256[SERVER_SHA256_HEX], attachment_sha256[SERVER_SHA256_HEX];
    struct server_origin origin = {.key = {exchange->tenant, &server_kind_mesh, draft->name},
                                   .sha256 = sha256,
                                   .size = draft->size,
                                   .options = FILE_OPTIONS};
    enum gd_status status = server_sha256_within(draft->file, draft->size, control, sha256);
    if (!status && attachment) {
        status =
            server_sha256_within(attachment->bytes, attachment->size, control, attachment_sha256);
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

bool server_derived_meshes_add(struct server_derived_meshes *meshes, const char *name,
                               const struct server_derived_source *source,
                               struct proto_problem *problem)
{
    const struct server_attachment *attachment = source->attachment;
    struct server_monitor monitor = {.exchange = meshes->exchange};
    const struct gd_control control = server_exchange_control(&monitor);
    struct draft draft = {.name = name, .attachment = attachment};
    struct server_record *record = NULL;
    struct server_surface *surface = NULL;
    bool is_written = draft_write(&draft, meshes, source->polygons, &control, problem);
    enum gd_status status =
        is_written ? draft_record(meshes->exchange, &draft, &control, &record) : GD_OK;
    if (status) proto_problem_from_status(problem, status, NULL);
    if (record)
        surface = server_surface_resource_build(
            &monitor, record,
            &(struct server_surface_source){draft.file, source->mesh,
                                            attachment ? attachment->bytes : NULL},
            problem);
    else if (attachment)
        server_attachment_free(attachment, meshes->exchange->host->budget);
    server_record_release(record);
    if (surface)
        meshes->list[meshes->count++] = (struct server_derived_mesh){surface, draft.file, false};
    else
        free(draft.file);
    return surface != NULL;
}

/* Removes those of the first `count` meshes that were newly created, unless other meshes have
 * replaced them. */
static void meshes_undo(const struct server_derived_meshes *meshes, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct server_record *record = meshes->list[i].surface->record;
        const struct server_key key = server_record_key(record);
        char tag[SERVER_ETAG + 2];
        if (!meshes->list[i].is_new) continue;
        snprintf(tag, sizeof tag, "\"%s\"", record->etag);
        const struct server_precondition same = {.if_match = {tag}};
        (void)server_registry_remove(meshes->exchange->host->api->registry, &key, &same);
    }
}

enum server_outcome server_derived_meshes_store(struct server_derived_meshes *meshes)
{
    static const struct server_precondition none;
    bool is_new = true;
    for (uint32_t i = 0; i < meshes->count; i++) {
        struct server_derived_mesh *mesh = &meshes->list[i];
        enum server_outcome outcome = server_registry_put(meshes->exchange->host->api->registry,
                                                          mesh->surface, mesh->file, &none);
        if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
            meshes_undo(meshes, i);
            return outcome;
        }
        mesh->is_new = outcome == SERVER_STORE_CREATED;
        is_new &= mesh->is_new;
    }
    return is_new ? SERVER_STORE_CREATED : SERVER_STORE_REPLACED;
}

void server_derived_meshes_reply(const struct server_derived_meshes *meshes,
                                 enum server_outcome outcome)
{
    struct proto_writer writer;
    if (!server_request_check_stored(meshes->exchange, outcome)) return;
    server_reply_writer(meshes->exchange, &writer);
    proto_write_object_begin(&writer);
    proto_member_array(&writer, "meshes");
    for (uint32_t i = 0; i < meshes->count; i++) {
        struct server_surface *surface = meshes->list[i].surface;
        server_surface_resource_describe(&writer,
                                         &(struct server_listed){surface->record, surface});
    }
    proto_write_array_end(&writer);
    proto_write_object_end(&writer);
    server_reply_json(meshes->exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &writer);
}
