/* Surfaces of any kind: lists, describes, changes and removes them. The route names the kind
 * (request.h). */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>

#include "proto/http/page.h"
#include "server/exchange/reply.h"
#include "server/query/api.h"
#include "server/query/request.h"
#include "server/query/surface_resource.h"
#include "server/store/kind.h"

/* --- list ------------------------------------------------------------------------------------- */

/* Replies with a page of at most `limit` surfaces and about PROTO_PAGE_BYTES. */
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

/* Replies with a page of surfaces. Returns false if the page is too long for an HTTP thread. */
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

/* Runs on the registry's writer thread. */
static bool remove_surface(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    struct server_key key;
    if (!server_request_key(exchange, &key)) return true;
    enum server_outcome outcome =
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

/* --- change ----------------------------------------------------------------------------------- */

struct caption {
    bool is_given;
    char text[SERVER_CAPTION];
};

/* Runs on the registry's writer thread. */
static bool update_surface(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    const struct caption *caption = exchange->state;
    struct server_key key;
    struct server_listed listed;
    if (!server_request_key(exchange, &key)) return true;
    enum server_outcome outcome = SERVER_STORE_DONE;
    if (caption->is_given)
        outcome = server_registry_caption(exchange->host->api->registry, &key, caption->text,
                                          &precondition);
    if (outcome) {
        server_request_fail(exchange, outcome);
    } else if (server_request_record(exchange, &listed)) {
        server_surface_resource_reply(exchange, 200, &listed);
        server_listed_release(&listed);
    }
    return true;
}

static bool caption_decode(struct server_exchange *exchange, struct caption *caption)
{
    struct proto_problem problem;
    const char *text;
    json_t *document = server_request_document(exchange, &problem);
    bool is_good = document && proto_caption_decode(document, &text, &problem);
    if (is_good) {
        caption->is_given = text;
        snprintf(caption->text, sizeof caption->text, "%s", text ? text : "");
    }
    json_decref(document);
    if (document) server_request_end_parsing(exchange);
    return server_reply_check(exchange, is_good, &problem);
}

void server_handle_update_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_reply_accepts_json(exchange) || !server_request_is_plain(exchange) ||
        !server_request_record(exchange, &listed))
        return;
    server_listed_release(&listed);
    struct caption *caption = server_request_allocate(exchange, sizeof *caption, free);
    if (caption && caption_decode(exchange, caption))
        server_exchange_defer(exchange, update_surface, submit_to_writer);
}
