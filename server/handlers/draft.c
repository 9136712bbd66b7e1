/* See draft.h. */
#include "server/handlers/draft.h"

#include "server/reply.h"
#include "server/server.h"

void server_draft_begin(struct server_draft *draft, const struct server_query *query)
{
    draft->budget = &query->exchange->server->budget;
    proto_writer_init(&draft->writer, SERVER_REPLY_MOST);
}

void server_draft_end(struct server_draft *draft)
{
    if (!draft->budget) return;
    server_budget_give(draft->budget, SERVER_BUDGET_FLIGHT, draft->held);
    proto_writer_free(&draft->writer);
    *draft = (struct server_draft){0};
}

enum gd_status server_draft_hold(struct server_draft *draft)
{
    size_t bytes = 2 * draft->writer.capacity;
    if (bytes <= draft->held) return GD_OK;
    if (!server_budget_take(draft->budget, SERVER_BUDGET_FLIGHT, bytes - draft->held)) return GD_BUDGET;
    draft->held = bytes;
    return GD_OK;
}

void server_draft_encode(const struct server_draft *draft, struct proto_writer *writer)
{
    proto_write_raw(writer, draft->writer.data, draft->writer.size);
}
