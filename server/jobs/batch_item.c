/* See batch_item.h. */
#include "server/jobs/batch_item.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_BODY ((size_t)4 << 20)
#define CONTENT_TYPE "application/json"

struct server_batch_item *server_batch_item_of(struct server_exchange *exchange)
{
    return (struct server_batch_item *)exchange->transport;
}

/* --- what it asks ----------------------------------------------------------------------------- */

static bool set_body(struct server_exchange *exchange, const struct proto_writer *body,
                     struct proto_problem *problem)
{
    struct server_budget *budget = exchange->host->budget;
    return proto_writer_check(body, problem) &&
           server_body_prepare(&exchange->body, budget, body->size, LARGEST_BODY, problem) &&
           server_body_append(&exchange->body, budget, body->data, body->size) &&
           server_body_check(&exchange->body, budget, problem);
}

/* What a client would send. */
static bool set_request(struct server_batch_item *item, const struct proto_writer *body,
                        struct proto_problem *problem)
{
    struct server_exchange *exchange = item->exchange;
    exchange->method = "POST";
    exchange->job.is_patient = true;
    exchange->tenant = item->claim.tenant;
    server_exchange_add_header(exchange, "Content-Type", CONTENT_TYPE);
    if (item->tag[0]) server_exchange_add_header(exchange, "If-Match", item->tag);
    snprintf(exchange->request_id, sizeof exchange->request_id, "%s-%u", item->claim.id,
             (unsigned)item->claim.item);
    return proto_route_find(proto_routes, proto_route_count, exchange->method, exchange->path,
                            &exchange->match, problem) &&
           set_body(exchange, body, problem);
}

static bool make_exchange(struct server_batch_item *item, struct server_host *host,
                          const struct proto_many *many, struct proto_problem *problem)
{
    struct proto_writer body;
    char target[PROTO_MESH_NAME + 64];
    uint32_t number = (uint32_t)item->claim.item;
    proto_writer_init(&body, LARGEST_BODY);
    const char *question = proto_many_ask(many, number, &body);
    snprintf(target, sizeof target, "/v1/meshes/%s/%s", proto_many_mesh(many, number), question);
    item->exchange = server_exchange_create(host, &item->transport, target);
    bool is_made = item->exchange ? set_request(item, &body, problem)
                                  : proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    proto_writer_free(&body);
    if (!is_made) server_exchange_destroy(item->exchange);
    return is_made;
}

/* --- life ------------------------------------------------------------------------------------- */

static bool is_gone(struct server_exchange *exchange)
{
    return atomic_load_explicit(&exchange->job.is_unwanted, memory_order_relaxed);
}

struct server_batch_item *server_batch_item_create(struct server_host *host,
                                                   const struct proto_many *many,
                                                   const struct server_batch_claim *claim,
                                                   void (*finish)(struct server_exchange *exchange),
                                                   void *owner, struct proto_problem *problem)
{
    struct server_batch_item *item = calloc(1, sizeof *item);
    if (!item) {
        (void)proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
        return NULL;
    }
    *item = (struct server_batch_item){.transport = {.finish = finish, .is_gone = is_gone},
                                       .owner = owner,
                                       .claim = *claim,
                                       .budget = host->budget};
    if (claim->etag[0]) snprintf(item->tag, sizeof item->tag, "\"%s\"", claim->etag);
    if (make_exchange(item, host, many, problem)) return item;
    free(item);
    return NULL;
}

void server_batch_item_free(struct server_batch_item *item)
{
    free(item->answer);
    server_budget_give(item->budget, SERVER_BUDGET_ANSWERS, item->held);
    free(item);
}

/* As a connection does it. */
void server_batch_item_run(struct server_batch_item *item)
{
    struct server_exchange *exchange = item->exchange;
    exchange->host->dispatch(exchange);
    if (exchange->response.status)
        item->transport.finish(exchange);
    else
        server_exchange_submit(exchange);
}

void server_batch_item_take_answer(struct server_batch_item *item)
{
    struct server_response *response = &item->exchange->response;
    item->size = response->body ? response->size : 0;
    item->answer = response->owned;
    item->held = response->held;
    response->owned = NULL;
    response->held = 0;
    if (item->answer || !item->size) return;
    item->answer = malloc(item->size);
    if (item->answer)
        memcpy(item->answer, response->body, item->size);
    else
        item->size = 0;
}

void server_batch_item_give_up(struct server_batch_item *item)
{
    if (item->exchange) atomic_store(&item->exchange->job.is_unwanted, true);
}
