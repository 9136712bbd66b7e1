/* See query.h. */
#include "server/query/query.h"

#include <stdlib.h>
#include <string.h>

#include "server/work/budgeted_call.h"
#include "server/http/answer_stream.h"
#include "server/http/etag.h"
#include "server/query/request.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define BYTES "application/octet-stream"

enum { MOST_PARAMETERS = 24 };

/* --- life ------------------------------------------------------------------------------------- */

struct server_query *server_query_create(const struct server_query_kind *kind,
                                         struct server_exchange *exchange,
                                         struct server_surface *surface)
{
    struct server_query *query = malloc(kind->size);
    if (!query) return NULL;
    memset((char *)query + sizeof *query, 0, kind->size - sizeof *query);
    *query = (struct server_query){
        .kind = kind, .exchange = exchange, .surface = server_surface_retain(surface), .share = 1};
    server_reply_writer(exchange, &query->draft);
    return query;
}

void server_query_destroy(struct server_query *query)
{
    if (!query) return;
    if (query->kind->release) query->kind->release(query);
    proto_writer_free(&query->draft);
    if (query->held) server_query_give(query, query->held);
    server_surface_release(query->surface);
    free(query);
}

enum server_query_turn server_query_glance(struct server_query *query,
                                           struct proto_problem *problem)
{
    return query->kind->glance ? query->kind->glance(query, problem) : SERVER_QUERY_AGAIN;
}

struct server_monitor server_query_monitor(const struct server_query *query, double begun,
                                           double share)
{
    return (struct server_monitor){.exchange = query->exchange,
                                   .begun = query->begun + query->share * begun,
                                   .share = query->share * share};
}

struct server_monitor server_monitor_portion(const struct server_monitor *whole, double begun,
                                             double share)
{
    return (struct server_monitor){.exchange = whole->exchange,
                                   .begun = whole->begun + whole->share * begun,
                                   .share = whole->share * share};
}

void server_query_count(const struct server_query *query, enum gd_status status)
{
    server_metrics_count_status(query->exchange->host->metrics, status);
}

enum server_query_turn server_query_fail(const struct server_query *query, enum gd_status status,
                                         const char *what, struct proto_problem *problem)
{
    server_query_count(query, status);
    if (status == GD_BUDGET && query->draft.failure)
        (void)proto_writer_check(&query->draft, problem);
    else if (status == GD_BUDGET)
        server_budget_refuse(query->exchange->host->budget, what, 0, problem);
    else
        proto_problem_from_status(problem, status, NULL);
    return SERVER_QUERY_FAILED;
}

/* --- what it holds ---------------------------------------------------------------------------- */

enum gd_status server_query_take(struct server_query *query, size_t bytes)
{
    if (!server_budget_take(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes))
        return GD_BUDGET;
    query->held += bytes;
    return GD_OK;
}

void server_query_give(struct server_query *query, size_t bytes)
{
    server_budget_give(query->exchange->host->budget, SERVER_BUDGET_FLIGHT, bytes);
    query->held -= bytes;
}

struct holding {
    server_query_maker *make;
    void *user;
    size_t kept;
};

static enum gd_status make_and_count(void *user, const struct gd_control *control, size_t *kept)
{
    struct holding *holding = user;
    enum gd_status status = holding->make(holding->user, control, kept);
    holding->kept = *kept;
    return status;
}

enum gd_status server_query_call(struct server_query *query, struct server_monitor *part,
                                 server_query_maker *make, void *user, size_t grant)
{
    struct holding holding = {.make = make, .user = user};
    const struct server_budgeted_call call = {.make = make_and_count,
                                              .user = &holding,
                                              .control = server_exchange_control(part),
                                              .grant = grant};
    enum gd_status status = server_budgeted_call_run(query->exchange->host->workspaces, &call);
    query->held += holding.kept;
    return status;
}

/* --- the draft -------------------------------------------------------------------------------- */

enum gd_status server_query_check_draft(const struct server_query *query)
{
    return query->draft.failure ? GD_BUDGET : GD_OK;
}

enum server_query_turn server_query_end_draft(struct server_query *query, enum gd_status status,
                                              const char *what, struct proto_problem *problem)
{
    if (status) return server_query_fail(query, status, what, problem);
    return proto_writer_check(&query->draft, problem) ? SERVER_QUERY_DONE : SERVER_QUERY_FAILED;
}

void server_query_encode(const struct server_query *query, struct proto_writer *writer)
{
    if (query->kind->encode)
        query->kind->encode(query, writer);
    else
        proto_write_raw(writer, query->draft.data, query->draft.size);
}

/* --- a request of its own --------------------------------------------------------------------- */

static void reply_bytes(struct server_query *query)
{
    size_t size = query->kind->bytes(query, NULL);
    void *bytes = server_reply_allocate(query->exchange, size);
    if (!bytes) return;
    query->kind->bytes(query, bytes);
    server_reply_bytes(query->exchange, 200, BYTES, bytes, size);
}

static void reply_form(struct server_query *query)
{
    const struct server_form *form = &query->kind->forms[query->form - SERVER_FORM_FIRST];
    struct proto_problem problem;
    char *bytes;
    size_t size;
    if (!query->kind->write(query, &bytes, &size, &problem)) {
        server_reply_problem(query->exchange, &problem);
        return;
    }
    server_reply_header(query->exchange, "Content-Disposition", "attachment; filename=\"%s.%s\"",
                        query->kind->name, form->name);
    server_reply_bytes(query->exchange, 200, form->media_type, bytes, size);
}

static void encode_state(struct server_exchange *exchange, struct proto_writer *writer)
{
    struct server_query *query = exchange->state;
    query->exchange = exchange; /* a stream's may be another */
    query->kind->encode(query, writer);
}

/* The query may be a stream's when this returns. */
static void reply_encoded(struct server_query *query, unsigned status)
{
    const struct server_answer_encoder encoder = {.encode = encode_state, .held = &query->held};
    struct server_exchange *exchange = query->exchange;
    struct proto_writer writer = query->draft; /* empty */
    server_answer_reply(exchange, status, &writer, &encoder);
    proto_writer_free(&writer);
}

static void reply_answer(struct server_query *query)
{
    unsigned status = query->kind->status ? query->kind->status(query) : 200;
    server_reply_tag(query->exchange, query->surface->record->etag);
    if (query->kind->reply) {
        query->kind->reply(query);
        return;
    }
    if (query->kind->forms) server_reply_header(query->exchange, "Vary", "Accept");
    if (query->form == SERVER_FORM_BYTES) {
        reply_bytes(query);
        return;
    }
    if (query->form >= SERVER_FORM_FIRST) {
        reply_form(query);
        return;
    }
    if (query->kind->encode)
        reply_encoded(query, status);
    else
        server_reply_json(query->exchange, status, &query->draft);
}

/* False: the exchange is not its own any more. */
static bool reply_turn(struct server_query *query, enum server_query_turn turn,
                       const struct proto_problem *problem)
{
    switch (turn) {
    case SERVER_QUERY_DONE:
        reply_answer(query);
        break;
    case SERVER_QUERY_FAILED:
        server_reply_problem(query->exchange, problem);
        break;
    case SERVER_QUERY_AGAIN:
        break; /* without a reply: the dispatcher calls again */
    case SERVER_QUERY_PARKED:
        return false;
    }
    return true;
}

static bool work(struct server_exchange *exchange)
{
    struct server_query *query = exchange->state;
    struct proto_problem problem;
    return reply_turn(query, query->kind->solve(query, &problem), &problem);
}

static bool join(struct server_exchange *exchange)
{
    struct server_query *query = exchange->state;
    return query->kind->join && query->kind->join(query);
}

static bool read_query(struct server_query *query, struct proto_problem *problem)
{
    const struct server_query_kind *kind = query->kind;
    bool has_body = query->exchange->match.route->has_body;
    struct proto_parameters parameters = server_exchange_parameters(query->exchange);
    const char *room[MOST_PARAMETERS];
    const char *const *names = server_form_parameters(has_body ? NULL : kind->parameters,
                                                      kind->forms, room, MOST_PARAMETERS);
    if (!proto_options_parse(&parameters, kind->fields, names, &query->options, problem))
        return false;
    if (kind->forms &&
        !server_form_wants_mesh(&parameters, kind->forms, query->form, &query->with_mesh, problem))
        return false;
    if (!has_body) return kind->parse(query, &parameters, problem);
    json_t *document = server_request_document(query->exchange, problem);
    if (!document) return false;
    bool ok = kind->decode(query, document, problem);
    json_decref(document);
    server_request_end_parsing(query->exchange);
    return ok;
}

static void free_query(void *query)
{
    server_query_destroy(query);
}

/* Replies without an answer to who has it already, so that it need not be found once more: the same
 * question about the same surface. */
static bool is_known(struct server_query *query)
{
    struct server_exchange *exchange = query->exchange;
    if (!query->kind->reply || !exchange->has_conditions) return false;
    const struct server_precondition precondition = server_precondition_read(exchange);
    if (!server_precondition_known(&precondition, query->surface->record->etag)) return false;
    server_reply_tag(exchange, query->surface->record->etag);
    server_reply_empty(exchange, 304);
    return true;
}

static void start(struct server_query *query)
{
    struct server_exchange *exchange = query->exchange;
    struct proto_problem problem;
    if (!read_query(query, &problem)) {
        server_reply_problem(exchange, &problem);
        return;
    }
    if (is_known(query)) return;
    server_exchange_shorten(exchange, query->options.timeout_ms);
    enum server_query_turn turn =
        query->with_mesh ? SERVER_QUERY_AGAIN : server_query_glance(query, &problem);
    reply_turn(query, turn, &problem);
    if (turn == SERVER_QUERY_AGAIN) server_exchange_defer(exchange, work, join);
}

static bool start_by_worker(struct server_exchange *exchange)
{
    start(exchange->state);
    return true;
}

/* An HTTP thread parses small bodies only. */
static void begin(struct server_query *query)
{
    struct server_exchange *exchange = query->exchange;
    server_exchange_keep(exchange, query, free_query);
    if (exchange->work || exchange->body.size <= SERVER_REQUEST_SMALL)
        start(query);
    else
        server_exchange_defer(exchange, start_by_worker, NULL);
}

void server_query_handle(struct server_exchange *exchange, const struct server_query_kind *kind)
{
    struct proto_problem problem;
    unsigned form = SERVER_FORM_JSON;
    if (!kind->reply && !server_form_choose(exchange, kind->forms, kind->bytes, &form, &problem)) {
        server_reply_problem(exchange, &problem);
        return;
    }
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    struct server_query *query = server_query_create(kind, exchange, surface);
    server_surface_release(surface);
    if (!query) {
        server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "the system is out of memory");
        return;
    }
    query->form = form;
    begin(query);
}
