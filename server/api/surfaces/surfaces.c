/* Surfaces of any kind: list, describe, remove. The route tells the kind (request.h). */
#include "server/query/handlers.h"

#include "proto/page.h"
#include "server/query/surface_resource.h"
#include "server/query/request.h"
#include "server/store/kind.h"
#include "server/http/reply.h"
#include "server/query/api.h"

/* --- list ------------------------------------------------------------------------------------- */

/* Ends the page also when it has many bytes. */
static void write_page(struct proto_writer *writer, const char *plural,
                       struct server_listed *listed, uint32_t count, uint32_t limit)
{
    uint32_t written = 0;
    proto_page_begin(writer, plural);
    while (written < count && written < limit && writer->size < PROTO_PAGE_BYTES)
        server_surface_resource_describe(writer, &listed[written++]);
    proto_page_end(writer, written < count ? listed[written - 1].record->name : NULL);
}

/* The surfaces on a page, and one more if there is a next page; at most `most`. */
static uint32_t find_listed(struct server_exchange *exchange, const struct proto_page *page,
                            uint32_t most, struct server_listed *listed)
{
    const struct server_key after = {exchange->tenant, server_request_kind(exchange), page->after};
    return server_registry_list(exchange->host->api->registry, &after,
                                page->limit < most ? page->limit + 1 : most, listed);
}

static void reply_page(struct server_exchange *exchange, const struct proto_page *page,
                       struct server_listed *listed, uint32_t count)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    write_page(&writer, server_request_kind(exchange)->plural, listed, count, page->limit);
    for (uint32_t i = 0; i < count; i++) server_listed_release(&listed[i]);
    server_reply_json(exchange, 200, &writer);
}

static bool list(struct server_exchange *exchange)
{
    struct proto_page page;
    struct server_listed listed[PROTO_PAGE_MOST + 1];
    if (!server_request_page(exchange, &page)) return true;
    uint32_t count = find_listed(exchange, &page, PROTO_PAGE_MOST + 1, listed);
    reply_page(exchange, &page, listed, count);
    return true;
}

void server_handle_list_surfaces(struct server_exchange *exchange)
{
    struct proto_page page;
    struct server_listed listed[SERVER_REQUEST_SHORT_LIST + 1];
    if (!server_reply_accepts_json(exchange) || !server_request_page(exchange, &page)) return;
    uint32_t count = find_listed(exchange, &page, SERVER_REQUEST_SHORT_LIST + 1, listed);
    if (page.limit <= SERVER_REQUEST_SHORT_LIST || count <= SERVER_REQUEST_SHORT_LIST) {
        reply_page(exchange, &page, listed, count);
        return;
    }
    for (uint32_t i = 0; i < count; i++) server_listed_release(&listed[i]);
    server_request_list(exchange, list);
}

/* --- describe, remove ------------------------------------------------------------------------- */

void server_handle_get_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_reply_accepts_json(exchange) || !server_request_is_plain(exchange)) return;
    if (!server_request_record(exchange, &listed)) return;
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

static bool leave_to_writer(struct server_exchange *exchange)
{
    server_registry_submit(exchange->host->api->registry, &exchange->job);
    return true;
}

void server_handle_delete_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_request_is_plain(exchange) || !server_request_record(exchange, &listed)) return;
    server_listed_release(&listed);
    server_exchange_defer(exchange, remove_surface, leave_to_writer);
}
