/* Upload: the bytes of a file become a mesh under a name. Read and built by a worker, then stored: it is durable before
 * the answer says that it is there. */
#include "server/handlers/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/build.h"
#include "server/handlers/description.h"
#include "server/handlers/request.h"
#include "server/reply.h"
#include "server/server.h"

#define GENERATED_NAME 32 /* hexadecimal digits */

struct upload {
    char name[PROTO_MESH_NAME + 1]; /* empty: to be made from the bytes */
    struct proto_mesh_options options;
    struct server_record *record;
};

static void free_upload(void *state)
{
    struct upload *upload = state;
    server_record_release(upload->record);
    free(upload);
}

static void reply_description(struct server_exchange *exchange, unsigned status, const struct server_listed *listed)
{
    server_reply_header(exchange, "Location", "/v1/meshes/%s", listed->record->name);
    server_description_reply(exchange, status, listed);
}

/* --- steps, each replies when it fails ---------------------------------------------------------------------------- */

static bool identify(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_body *body = &exchange->body;
    char sha256[SERVER_SHA256_HEX];
    server_sha256(body->bytes, body->size, sha256);
    if (!upload->name[0]) snprintf(upload->name, sizeof upload->name, "%.*s", GENERATED_NAME, sha256);
    upload->options.format = proto_mesh_upload_format(&upload->options, body->bytes, body->size,
                                                      server_exchange_header(exchange, "Content-Type"));
    upload->record = server_record_create(upload->name, sha256, body->size, &upload->options);
    if (!upload->record) server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return upload->record != NULL;
}

/* The name holds the same already: the upload goes on only if the mesh is not in memory, to bring it there, and to make
 * sure of what is stored. True: replied. */
static bool answer_same(struct server_exchange *exchange, struct upload *upload, const struct server_listed *before)
{
    if (before->surface) {
        reply_description(exchange, 200, before);
        return true;
    }
    server_record_release(upload->record);
    upload->record = server_record_retain(before->record);
    return false;
}

/* Replies when the name holds the same mesh already, or something that the precondition excludes. */
static bool answer_from_registry(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_precondition precondition = server_request_precondition(exchange);
    struct server_listed before = {0};
    bool exists = server_registry_find(exchange->server->registry, upload->name, &before), replied = false;
    if (!server_precondition_holds(&precondition, exists ? before.record->etag : NULL)) {
        server_request_fail(exchange, SERVER_STORE_PRECONDITION);
        replied = true;
    } else if (exists && server_record_equal(before.record, upload->record)) {
        replied = answer_same(exchange, upload, &before);
    }
    server_listed_release(&before);
    return replied;
}

static struct server_surface *make_surface(struct server_exchange *exchange, const struct upload *upload)
{
    struct server *server = exchange->server;
    struct server_monitor monitor = {.exchange = exchange};
    const struct server_builder builder = {.budget = &server->budget,
                                           .cache = server->cache,
                                           .max_faces = (uint32_t)server->config.max_faces,
                                           .control = server_exchange_control(&monitor)};
    struct server_surface *surface = NULL;
    struct proto_problem problem;
    if (server_build_surface(&builder, upload->record, exchange->body.bytes, &surface, &problem))
        server_reply_problem(exchange, &problem);
    return surface;
}

/* A record that was in the registry before is complete, and immutable. */
static bool complete(struct server_exchange *exchange, struct server_surface *surface)
{
    if (surface->record->description || server_description_remember(surface)) return true;
    server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return false;
}

static void store_surface(struct server_exchange *exchange, struct server_surface *surface)
{
    const struct server_precondition precondition = server_request_precondition(exchange);
    const struct server_listed listed = {surface->record, surface};
    enum server_store_outcome outcome =
        server_registry_put(exchange->server->registry, surface, exchange->body.bytes, &precondition);
    if (outcome == SERVER_STORE_CREATED)
        reply_description(exchange, 201, &listed);
    else if (outcome == SERVER_STORE_REPLACED)
        reply_description(exchange, 200, &listed);
    else
        server_request_fail(exchange, outcome);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static bool make_mesh(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    if (!identify(exchange, upload) || answer_from_registry(exchange, upload)) return true;
    struct server_surface *surface = make_surface(exchange, upload);
    if (!surface) return true;
    if (complete(exchange, surface)) store_surface(exchange, surface);
    server_surface_release(surface);
    server_body_drop(&exchange->body, &exchange->server->budget);
    return true;
}

static void handle_upload(struct server_exchange *exchange, const char *name)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    if (!server_reply_accepts_json(exchange)) return;
    struct upload *upload = calloc(1, sizeof *upload);
    if (!upload) {
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
        return;
    }
    strcpy(upload->name, name);
    server_exchange_keep(exchange, upload, free_upload);
    if (proto_mesh_options_parse(&parameters, &upload->options, &problem))
        server_exchange_defer(exchange, make_mesh, NULL);
    else
        server_reply_problem(exchange, &problem);
}

void server_handle_create_mesh(struct server_exchange *exchange)
{
    handle_upload(exchange, "");
}

void server_handle_put_mesh(struct server_exchange *exchange)
{
    char name[PROTO_MESH_NAME + 1];
    if (server_request_name(exchange, name)) handle_upload(exchange, name);
}
