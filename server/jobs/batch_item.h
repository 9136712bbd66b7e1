/* Batch item: an item of a batch under way on this daemon: what it asks as an exchange of its own,
 * then its answer.
 *
 * The exchange goes through the router's dispatch, a handler and the workers as a connection's
 * does; `finish` is called when it is answered, by whichever thread that is. */
#ifndef SERVER_JOBS_BATCH_ITEM_H
#define SERVER_JOBS_BATCH_ITEM_H

#include "proto/many.h"
#include "server/jobs/batch_queue.h"
#include "server/http/exchange.h"

struct server_batch_item {
    struct server_transport transport; /* first: its exchange finds it by it */
    void *owner;                       /* for `finish` */
    struct server_batch_claim claim;
    char tag[SERVER_ETAG + 2];
    struct server_batch_item *next;   /* the owner's, as what follows: */
    struct server_exchange *exchange; /* NULL: answered */
    unsigned status;                  /* 0: not answered */
    char *answer;                     /* NULL: none, or no memory for it */
    /* of the answer: bytes, and how many SERVER_BUDGET_ANSWERS counts */
    size_t size, held;
    struct server_budget *budget; /* that counts them */
};

/* An item with its exchange; `many` is the batch's, and borrowed for the call. NULL with the
 * problem. */
struct server_batch_item *server_batch_item_create(struct server_host *host,
                                                   const struct proto_many *many,
                                                   const struct server_batch_claim *claim,
                                                   void (*finish)(struct server_exchange *exchange),
                                                   void *owner, struct proto_problem *problem);
void server_batch_item_free(struct server_batch_item *item); /* its exchange has been destroyed */

struct server_batch_item *server_batch_item_of(struct server_exchange *exchange);

/* Sets it to work; `finish` may be called before this returns, or the item be gone. */
void server_batch_item_run(struct server_batch_item *item);

/* Takes over the body of its exchange's response. */
void server_batch_item_take_answer(struct server_batch_item *item);

/* Ends its work if it is not answered: its answer will be that it was cancelled. */
void server_batch_item_give_up(struct server_batch_item *item);

#endif
