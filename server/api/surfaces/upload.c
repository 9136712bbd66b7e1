/* Upload: the bytes of a file become a surface under a name. Read and built by a worker, then
 * stored by the registry's writer: it is durable before the answer says that it is there. The route
 * tells the kind (request.h). */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/query/surface_resource.h"
#include "server/query/derived_mesh.h"
#include "server/query/request.h"
#include "server/store/kind.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define GENERATED_NAME 32 /* hexadecimal digits */

struct upload {
    char name[PROTO_MESH_NAME + 1]; /* empty: to be made from the bytes */
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

static void reply_description(struct server_exchange *exchange, unsigned status,
                              const struct server_listed *listed)
{
    const struct server_record *record = listed->record;
    server_reply_header(exchange, "Location", "/v1/%s/%s", record->kind->plural, record->name);
    server_surface_resource_reply(exchange, status, listed);
}

/* --- steps, each replies when it fails -------------------------------------------------------- */

static bool read_options(struct server_exchange *exchange, char text[SERVER_OPTIONS])
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    const struct server_file file = {exchange->body.bytes, exchange->body.size,
                                     server_exchange_header(exchange, "Content-Type")};
    struct proto_problem problem;
    if (server_request_kind(exchange)->read_options(&parameters, &file, text, &problem))
        return true;
    server_reply_problem(exchange, &problem);
    return false;
}

static bool identify(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_body *body = &exchange->body;
    char sha256[SERVER_SHA256_HEX], options[SERVER_OPTIONS];
    if (!read_options(exchange, options)) return false;
    server_sha256(body->bytes, body->size, sha256);
    if (!upload->name[0])
        snprintf(upload->name, sizeof upload->name, "%.*s", GENERATED_NAME, sha256);
    server_record_release(
        /* of the last time, if the name was another surface's before it was stored */
        upload->record);
    upload->record = server_record_create(&(struct server_origin){
        .key = {exchange->tenant, server_request_kind(exchange), upload->name},
        .sha256 = sha256,
        .size = body->size,
        .options = options});
    if (!upload->record) server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return upload->record != NULL;
}

/* The name holds the same already: the upload goes on, to make sure of what is stored, and to bring
 * the surface into memory if it is not there. */
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
    const struct server_key key = server_record_key(upload->record);
    struct server_listed before = {0};
    bool exists = server_registry_find(exchange->host->api->registry, &key, &before),
         replied = false;
    if (!server_precondition_holds(&precondition, exists ? before.record->etag : NULL)) {
        server_request_fail(exchange, SERVER_STORE_PRECONDITION);
        replied = true;
    } else if (exists && server_record_equal(before.record, upload->record)) {
        take_over(upload, &before);
    }
    server_listed_release(&before);
    return replied;
}

static void reply_outcome(struct server_exchange *exchange, struct server_surface *surface,
                          enum server_store_outcome outcome)
{
    const struct server_listed listed = {surface->record, surface};
    server_body_drop(&exchange->body, exchange->host->budget);
    if (outcome == SERVER_STORE_CREATED)
        reply_description(exchange, 201, &listed);
    else if (outcome == SERVER_STORE_REPLACED)
        reply_description(exchange, 200, &listed);
    else
        server_request_fail(exchange, outcome);
}

/* --- the whole -------------------------------------------------------------------------------- */

static bool make_surface(struct server_exchange *exchange);

/* By the writer. */
static bool store_surface(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    const struct upload *upload = exchange->state;
    reply_outcome(exchange, upload->surface,
                  server_registry_put(exchange->host->api->registry, upload->surface,
                                      exchange->body.bytes, &precondition));
    return true;
}

/* By the writer, of a surface that is in memory already. If it no longer is the name's, the upload
 * begins anew. */
static bool confirm_surface(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    enum server_store_outcome outcome = server_registry_put(
        exchange->host->api->registry, upload->surface, exchange->body.bytes, NULL);
    if (outcome != SERVER_STORE_ABSENT) {
        reply_outcome(exchange, upload->surface, outcome);
        return true;
    }
    server_surface_release(upload->surface);
    upload->surface = NULL;
    server_exchange_defer(exchange, make_surface, NULL);
    server_workers_resume(exchange->host->workers, &exchange->job);
    return false;
}

/* By a worker. */
static bool make_surface(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    struct proto_problem problem;
    if (!identify(exchange, upload) || answer_from_registry(exchange, upload)) return true;
    if (upload->surface) return server_request_write(exchange, confirm_surface);
    upload->surface = server_surface_resource_build(exchange, upload->record, exchange->body.bytes,
                                                    NULL, &problem);
    if (upload->surface) return server_request_write(exchange, store_surface);
    server_reply_problem(exchange, &problem);
    return true;
}

static void handle_upload(struct server_exchange *exchange, const char *name)
{
    if (!server_reply_accepts_json(exchange)) return;
    struct upload *upload = calloc(1, sizeof *upload);
    if (!upload) {
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
        return;
    }
    strcpy(upload->name, name);
    server_exchange_keep(exchange, upload, free_upload);
    server_exchange_defer(exchange, make_surface, NULL);
}

void server_handle_create_surface(struct server_exchange *exchange)
{
    handle_upload(exchange, "");
}

void server_handle_put_surface(struct server_exchange *exchange)
{
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    if (server_request_key(exchange, name, &key)) handle_upload(exchange, name);
}
