/* See surface_resource.h. */
#include "server/query/surface_resource.h"

#include <stdlib.h>
#include <string.h>

#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/surfaces/surface.h"
#include "server/store/kind.h"

/* Only a new record lacks a description; a record of the registry is immutable. */
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

struct server_surface *server_surface_resource_build(struct server_exchange *exchange,
                                                     struct server_record *record,
                                                     const void *bytes, void *attachment,
                                                     struct proto_problem *problem)
{
    struct server_host *host = exchange->host;
    struct server_monitor monitor = {.exchange = exchange};
    const struct server_builder builder = {.budget = host->budget,
                                           .cache = host->api->cache,
                                           .max_faces = (uint32_t)host->api->config->max_faces,
                                           .control = server_exchange_control(&monitor),
                                           .record = record,
                                           .bytes = bytes,
                                           .problem = problem};
    struct server_surface *surface;
    if (server_build_surface(&builder, &surface)) {
        if (attachment)
            server_budget_give(host->budget, SERVER_BUDGET_FLIGHT, (size_t)record->attachment_size);
        free(attachment);
        return NULL;
    }
    if (attachment) server_surface_attach(surface, attachment);
    if (record_describe(surface)) return surface;
    server_surface_release(surface);
    proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    return NULL;
}

void server_surface_resource_describe(struct proto_writer *writer,
                                      const struct server_listed *listed)
{
    const char *remembered = listed->record->description;
    if (listed->surface)
        listed->record->kind->describe(writer, listed->surface);
    else
        proto_write_raw(writer, remembered, strlen(remembered));
}

void server_surface_resource_reply(struct server_exchange *exchange, unsigned status,
                                   const struct server_listed *listed)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    server_surface_resource_describe(&writer, listed);
    server_reply_tag(exchange, listed->record->etag, NULL);
    server_reply_json(exchange, status, &writer);
}

void server_surface_resource_reply_stored(struct server_exchange *exchange,
                                          struct server_surface *surface,
                                          enum server_store_outcome outcome)
{
    const struct server_record *record = surface->record;
    const struct server_listed listed = {surface->record, surface};
    if (outcome != SERVER_STORE_CREATED && outcome != SERVER_STORE_REPLACED) {
        server_request_fail(exchange, outcome);
        return;
    }
    server_reply_header(exchange, "Location", "/v1/%s/%s", record->kind->plural, record->name);
    server_surface_resource_reply(exchange, outcome == SERVER_STORE_CREATED ? 201 : 200, &listed);
}
