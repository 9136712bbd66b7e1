/* Surfaces of any kind: list, describe, remove. The route tells the kind (request.h). */
#include "server/handlers/handlers.h"

#include "proto/page.h"
#include "server/handlers/description.h"
#include "server/handlers/request.h"
#include "server/kind.h"
#include "server/reply.h"
#include "server/server.h"

/* --- list --------------------------------------------------------------------------------------------------------- */

static void write_page(struct proto_writer *writer, const char *plural, struct server_listed *listed, uint32_t count,
                       uint32_t limit)
{
    uint32_t written = count < limit ? count : limit;
    proto_page_begin(writer, plural);
    for (uint32_t i = 0; i < written; i++) server_description_write(writer, &listed[i]);
    proto_page_end(writer, count > limit ? listed[limit - 1].record->name : NULL);
}

void server_handle_list_surfaces(struct server_exchange *exchange)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    struct proto_problem problem;
    struct proto_page page;
    struct proto_writer writer;
    struct server_listed listed[PROTO_PAGE_MOST + 1];
    if (!server_reply_accepts_json(exchange)) return;
    if (!proto_page_parse(&parameters, &page, &problem)) {
        server_reply_problem(exchange, &problem);
        return;
    }
    const struct server_key after = {exchange->tenant, server_request_kind(exchange), page.after};
    uint32_t count = server_registry_list(exchange->server->registry, &after, page.limit + 1,
                                          listed); /* one more tells whether there is a next page */
    proto_writer_init(&writer, SERVER_REPLY_MOST);
    write_page(&writer, after.kind->plural, listed, count, page.limit);
    for (uint32_t i = 0; i < count; i++) server_listed_release(&listed[i]);
    server_reply_json(exchange, 200, &writer);
}

/* --- describe, remove --------------------------------------------------------------------------------------------- */

void server_handle_get_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_reply_accepts_json(exchange) || !server_request_is_plain(exchange)) return;
    if (!server_request_record(exchange, &listed)) return;
    server_description_reply(exchange, 200, &listed);
    server_listed_release(&listed);
}

/* By the registry's writer. */
static bool remove_surface(struct server_exchange *exchange)
{
    const struct server_precondition precondition = server_precondition_read(exchange);
    char name[PROTO_MESH_NAME + 1];
    struct server_key key;
    if (!server_request_key(exchange, name, &key)) return true;
    enum server_store_outcome outcome = server_registry_remove(exchange->server->registry, &key, &precondition);
    if (outcome == SERVER_STORE_DONE)
        server_reply_empty(exchange, 204);
    else
        server_request_fail(exchange, outcome);
    return true;
}

static bool leave_to_writer(struct server_exchange *exchange)
{
    server_registry_submit(exchange->server->registry, &exchange->job);
    return true;
}

void server_handle_delete_surface(struct server_exchange *exchange)
{
    struct server_listed listed;
    if (!server_request_is_plain(exchange) || !server_request_record(exchange, &listed)) return;
    server_listed_release(&listed);
    server_exchange_defer(exchange, remove_surface, leave_to_writer);
}
