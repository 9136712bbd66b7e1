/* Upload: the bytes of a file become a mesh under a name. Read and built by a worker, then stored by the registry's
 * writer: it is durable before the answer says that it is there. */
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
    struct server_surface *surface; /* NULL: not built as yet */
};

static void free_upload(void *state)
{
    struct upload *upload = state;
    server_surface_release(upload->surface);
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
    server_record_release(upload->record); /* of the last time, if the name was another mesh's before it was stored */
    server_sha256(body->bytes, body->size, sha256);
    if (!upload->name[0]) snprintf(upload->name, sizeof upload->name, "%.*s", GENERATED_NAME, sha256);
    upload->options.format = proto_mesh_upload_format(&upload->options, body->bytes, body->size,
                                                      server_exchange_header(exchange, "Content-Type"));
    upload->record = server_record_create(upload->name, sha256, body->size, &upload->options);
    if (!upload->record) server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return upload->record != NULL;
}

/* The name holds the same already: the upload goes on, to make sure of what is stored, and to bring the mesh into
 * memory if it is not there. */
static void take_over(struct upload *upload, const struct server_listed *before)
{
    server_record_release(upload->record);
    upload->record = server_record_retain(before->record);
    if (before->surface) upload->surface = server_surface_retain(before->surface);
}

/* Replies when the name holds something that the precondition excludes. */
static bool answer_from_registry(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    struct server_listed before = {0};
    bool exists = server_registry_find(exchange->server->registry, upload->name, &before), replied = false;
    if (!server_precondition_holds(&precondition, exists ? before.record->etag : NULL)) {
        server_request_fail(exchange, SERVER_STORE_PRECONDITION);
        replied = true;
    } else if (exists && server_record_equal(before.record, upload->record)) {
        take_over(upload, &before);
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

static void reply_outcome(struct server_exchange *exchange, struct server_surface *surface,
                          enum server_store_outcome outcome)
{
    const struct server_listed listed = {surface->record, surface};
    server_body_drop(&exchange->body, &exchange->server->budget);
    if (outcome == SERVER_STORE_CREATED)
        reply_description(exchange, 201, &listed);
    else if (outcome == SERVER_STORE_REPLACED)
        reply_description(exchange, 200, &listed);
    else
        server_request_fail(exchange, outcome);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static bool make_mesh(struct server_exchange *exchange);

/* By the writer. */
static bool store_mesh(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    const struct upload *upload = exchange->state;
    reply_outcome(
        exchange, upload->surface,
        server_registry_put(exchange->server->registry, upload->surface, exchange->body.bytes, &precondition));
    return true;
}

/* By the writer, of a mesh that is in memory already. If it no longer is the name's, the upload begins anew. */
static bool confirm_mesh(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    enum server_store_outcome outcome =
        server_registry_confirm(exchange->server->registry, upload->record, exchange->body.bytes);
    if (outcome != SERVER_STORE_ABSENT) {
        reply_outcome(exchange, upload->surface, outcome);
        return true;
    }
    server_surface_release(upload->surface);
    upload->surface = NULL;
    server_exchange_defer(exchange, make_mesh, NULL);
    server_workers_resume(exchange->server->workers, &exchange->job);
    return false;
}

/* Leaves the exchange to the writer, which has `work` done. */
static bool pass_on(struct server_exchange *exchange, bool (*work)(struct server_exchange *exchange))
{
    server_exchange_defer(exchange, work, NULL);
    server_registry_submit(exchange->server->registry, &exchange->job);
    return false;
}

/* By a worker. */
static bool make_mesh(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    if (!identify(exchange, upload) || answer_from_registry(exchange, upload)) return true;
    if (upload->surface) return pass_on(exchange, confirm_mesh);
    upload->surface = make_surface(exchange, upload);
    if (!upload->surface || !complete(exchange, upload->surface)) return true;
    return pass_on(exchange, store_mesh);
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
