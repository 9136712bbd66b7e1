/* Draft: an answer that is written as it is found, by a worker, within the byte budget; the query's encode only copies it. */
#ifndef SERVER_HANDLERS_DRAFT_H
#define SERVER_HANDLERS_DRAFT_H

#include "server/budget.h"
#include "server/handlers/query.h"

struct server_draft { /* all zero: not begun */
    struct proto_writer writer;
    struct server_budget *budget;
    size_t held; /* bytes of SERVER_BUDGET_FLIGHT */
};

void server_draft_begin(struct server_draft *draft, const struct server_query *query);
void server_draft_end(struct server_draft *draft); /* a second time, or of one not begun, is harmless */

/* To be called now and then while it is written: takes what the text has grown by from the budget, and as much for the answer that it
 * is copied to. GD_BUDGET. */
GD_MUST_USE enum gd_status server_draft_hold(struct server_draft *draft);

/* Writes the draft, which is one value, to an answer. */
void server_draft_encode(const struct server_draft *draft, struct proto_writer *writer);

#endif
