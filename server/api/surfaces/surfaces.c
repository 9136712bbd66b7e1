/* Surfaces of any kind: list, describe, remove, upload. The route names the kind (request.h).
 *
 * A worker builds an uploaded surface from the bytes of the body; the registry's writer stores it
 * before the response. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/http/page.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/query/surface_resource.h"
#include "server/store/kind.h"

#define GENERATED_NAME 32 /* hexadecimal digits of the file's SHA-256 */

/* --- list ------------------------------------------------------------------------------------- */

/* The page ends at `limit` surfaces or at PROTO_PAGE_BYTES. */
static void reply_page(struct server_exchange *exchange, uint32_t limit,
                       struct server_listed *listed, uint32_t count)
{
    struct proto_writer writer;
    uint32_t written = 0;
    server_reply_writer(exchange, &writer);
    proto_page_begin(&writer, server_request_kind(exchange)->plural);
    while (written < count && written < limit && writer.size < PROTO_PAGE_BYTES)
        server_surface_resource_describe(&writer, &listed[written++]);
    proto_page_end(&writer, written < count ? listed[written - 1].record->name : NULL);
    server_reply_json(exchange, 200, &writer);
}

/* Replies with a page of surfaces. False: it is too long for an HTTP thread. */
static bool list_surfaces(struct server_exchange *exchange)
{
    uint32_t most = exchange->work ? PROTO_PAGE_MOST : SERVER_REQUEST_SHORT_LIST;
    struct proto_page page;
    struct server_listed listed[PROTO_PAGE_MOST + 1];
    if (!server_request_page_of_names(exchange, &page)) return true;
    const struct server_key after = {exchange->tenant, server_request_kind(exchange), page.after};
    uint32_t wanted = page.limit < most ? page.limit : most;
    uint32_t count = server_registry_list(exchange->host->api->registry, &after, page.prefix,
                                          wanted + 1, listed);
    bool is_whole = page.limit <= most || count <= most;
    if (is_whole) reply_page(exchange, page.limit, listed, count);
    for (uint32_t i = 0; i < count; i++) server_listed_release(&listed[i]);
    return is_whole;
}

void server_handle_list_surfaces(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange) && !list_surfaces(exchange))
        server_request_list(exchange, list_surfaces);
}

/* --- describe, remove ------------------------------------------------------------------------- */

void server_handle_get_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_reply_accepts_json(exchange) || !server_request_is_plain(exchange) ||
        !server_request_record(exchange, &listed))
        return;
    server_surface_resource_reply(exchange, 200, &listed);
    server_listed_release(&listed);
}

/* By the registry's writer. */
static bool remove_surface(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    if (!server_request_key(exchange, name, &key)) return true;
    enum server_store_outcome outcome =
        server_registry_remove(exchange->host->api->registry, &key, &precondition);
    if (outcome == SERVER_STORE_DONE)
        server_reply_empty(exchange, 204);
    else
        server_request_fail(exchange, outcome);
    return true;
}

static bool submit_to_writer(struct server_exchange *exchange)
{
    (void)server_workers_submit(exchange->host->api->writer, &exchange->job);
    return true;
}

void server_handle_delete_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_request_is_plain(exchange) || !server_request_record(exchange, &listed)) return;
    server_listed_release(&listed);
    server_exchange_defer(exchange, remove_surface, submit_to_writer);
}

/* --- upload; each step replies when it fails -------------------------------------------------- */

struct upload {
    char name[PROTO_MESH_NAME + 1]; /* empty: generated from the bytes */
    struct server_record *record;
    struct server_surface *surface; /* NULL: not built yet */
};

static void upload_free(void *state)
{
    struct upload *upload = state;
    server_surface_release(upload->surface);
    server_record_release(upload->record);
    free(upload);
}

/* Makes the record. An upload that starts over (upload_confirm) has an older one. */
static bool upload_identify(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_body *body = &exchange->body;
    const struct server_kind *kind = server_request_kind(exchange);
    const struct server_file file = {body->bytes, body->size,
                                     server_exchange_header(exchange, "Content-Type")};
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    char sha256[SERVER_SHA256_HEX], options[SERVER_OPTIONS];
    if (!kind->read_options(&parameters, &file, options, &problem)) {
        server_reply_problem(exchange, &problem);
        return false;
    }
    server_sha256(body->bytes, body->size, sha256);
    if (!upload->name[0])
        snprintf(upload->name, sizeof upload->name, "%.*s", GENERATED_NAME, sha256);
    server_record_release(upload->record);
    upload->record =
        server_record_create(&(struct server_origin){.key = {exchange->tenant, kind, upload->name},
                                                     .sha256 = sha256,
                                                     .size = body->size,
                                                     .options = options});
    if (!upload->record) server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
    return upload->record != NULL;
}

/* Checks the precondition. If the name holds the same surface already, the upload takes over its
 * record: it goes on, to confirm the stored file and to load the surface. */
static bool upload_compare(struct server_exchange *exchange, struct upload *upload)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    const struct server_key key = server_record_key(upload->record);
    struct server_listed before = {0};
    bool exists = server_registry_find(exchange->host->api->registry, &key, &before);
    bool holds = server_precondition_holds(&precondition, exists ? before.record->etag : NULL);
    if (!holds) {
        server_request_fail(exchange, SERVER_STORE_PRECONDITION);
    } else if (exists && server_record_equal(before.record, upload->record)) {
        server_record_release(upload->record);
        upload->record = server_record_retain(before.record);
        if (before.surface) upload->surface = server_surface_retain(before.surface);
    }
    server_listed_release(&before);
    return holds;
}

static bool upload_reply(struct server_exchange *exchange, enum server_store_outcome outcome)
{
    const struct upload *upload = exchange->state;
    server_body_drop(&exchange->body);
    server_surface_resource_reply_stored(exchange, upload->surface, outcome);
    return true;
}

/* By the registry's writer. */
static bool upload_store(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    const struct upload *upload = exchange->state;
    return upload_reply(exchange,
                        server_registry_put(exchange->host->api->registry, upload->surface,
                                            exchange->body.bytes, &precondition));
}

static bool upload_build(struct server_exchange *exchange);

/* By the registry's writer, for a surface that was in memory. If the name holds another one by now,
 * the upload starts over. */
static bool upload_confirm(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    enum server_store_outcome outcome = server_registry_put(
        exchange->host->api->registry, upload->surface, exchange->body.bytes, NULL);
    if (outcome != SERVER_STORE_ABSENT) return upload_reply(exchange, outcome);
    server_surface_release(upload->surface);
    upload->surface = NULL;
    server_exchange_defer(exchange, upload_build, NULL);
    server_workers_resume(exchange->host->workers, &exchange->job);
    return false;
}

/* By a worker. */
static bool upload_build(struct server_exchange *exchange)
{
    struct upload *upload = exchange->state;
    struct proto_problem problem;
    if (!upload_identify(exchange, upload) || !upload_compare(exchange, upload)) return true;
    if (upload->surface) return server_request_write(exchange, upload_confirm);
    upload->surface = server_surface_resource_build(exchange, upload->record, exchange->body.bytes,
                                                    NULL, &problem);
    if (upload->surface) return server_request_write(exchange, upload_store);
    server_reply_problem(exchange, &problem);
    return true;
}

static void upload_start(struct server_exchange *exchange, const char *name)
{
    if (!server_reply_accepts_json(exchange)) return;
    struct upload *upload = calloc(1, sizeof *upload);
    if (!upload) {
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
        return;
    }
    strcpy(upload->name, name);
    server_exchange_keep(exchange, upload, upload_free);
    server_exchange_defer(exchange, upload_build, NULL);
}

void server_handle_create_surface(struct server_exchange *exchange)
{
    upload_start(exchange, "");
}

void server_handle_put_surface(struct server_exchange *exchange)
{
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    if (server_request_key(exchange, name, &key)) upload_start(exchange, name);
}
