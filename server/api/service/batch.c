/* Batch: many queries in one request, a line each, answered in their order by the same steps as
 * requests of their own (query.h).
 *
 * One worker takes line after line; a line that has to wait for somebody else's field parks the
 * whole exchange. When the time is over, or memory, the lines that are left are told so.
 *
 * The answer is collected at first, and leaves as a whole if that goes without a stop. Before the
 * first line that takes time, or when much is collected, the exchange is answered with a stream
 * (relay.h), and the work goes on in one detached from it: from then on what is collected is handed
 * on before each line that takes time. A job (Prefer: respond-async) collects all. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "proto/accept.h"
#include "proto/batch.h"
#include "proto/decode.h"
#include "server/query/query.h"
#include "server/query/request.h"
#include "server/http/relay.h"
#include "server/http/reply.h"
#include "server/query/api.h"

#define NDJSON "application/x-ndjson"
#define ANSWER_MOST                                                                                \
    ((size_t)64 << 20) /* bytes of collected answers after which no line is begun                  \
                        */
/* bytes of answers that are handed on even before a quick line */
#define RIPE 65536

struct batch {
    /* the request's, or the one that goes on when that is answered */
    struct server_exchange *exchange;
    struct server_surface *surface;
    struct proto_batch_line line; /* in work */
    struct server_query *query;   /* of that line; NULL: it is answered */
    size_t begin;                 /* of its answer */
    struct proto_writer writer;   /* of answers that are not handed on */
    struct server_relay *relay;   /* NULL: none was handed on */
    bool has_answered_all, is_refused;
};

static const struct server_query_kind *const kinds[] = {
    &server_query_distance,        &server_query_path,
    &server_query_nearest,         &server_query_matrix,
    &server_query_distance_to_set, &server_query_curve_distance};

static void free_batch(void *state)
{
    struct batch *batch = state;
    if (batch->relay) server_relay_end(batch->relay, batch->has_answered_all);
    server_relay_release(batch->relay);
    server_query_destroy(batch->query);
    server_surface_release(batch->surface);
    proto_writer_free(&batch->writer);
    free(batch);
}

/* --- a line's question ------------------------------------------------------------------------ */

static const struct server_query_kind *find_kind(const char *name, struct proto_problem *problem)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcmp(kinds[i]->name, name) == 0) return kinds[i];
    char names[256] = "";
    size_t length = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", i ? ", " : "",
                                   kinds[i]->name);
    proto_problem_refuse(problem, "/query", "a batch has no query \"%s\"; it takes %s", name,
                         names);
    return NULL;
}

static bool create_query(struct batch *batch, const char *name, struct proto_problem *problem)
{
    const struct server_query_kind *kind = find_kind(name, problem);
    if (!kind) return false;
    batch->query = server_query_create(kind, batch->exchange, batch->surface);
    if (!batch->query) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    double size = (double)batch->exchange->body.size;
    batch->query->begun = (double)(batch->line.text - batch->exchange->body.bytes) / size;
    batch->query->share = (double)batch->line.size / size;
    return true;
}

static bool read_line(struct batch *batch, struct proto_problem *problem)
{
    struct proto_parameters parameters = server_exchange_parameters(batch->exchange);
    struct proto_batch_query line;
    if (!server_request_begin_parsing(batch->exchange, batch->line.text, batch->line.size, problem))
        return false;
    bool is_read = proto_batch_decode(&batch->line, &line, problem);
    bool ok = is_read && create_query(batch, line.name, problem) &&
              proto_batch_options(&line, &parameters, batch->query->kind->fields,
                                  &batch->query->options, problem) &&
              batch->query->kind->decode(batch->query, line.document, problem);
    if (is_read) proto_batch_query_free(&line);
    server_request_end_parsing(batch->exchange);
    return ok;
}

/* --- a line's answer -------------------------------------------------------------------------- */

/* OK, or why no more work is to be done. */
static enum gd_status check_time(const struct batch *batch)
{
    const struct server_body *body = &batch->exchange->body;
    struct server_monitor monitor = {.exchange = batch->exchange, .share = 1};
    struct gd_control control = server_exchange_control(&monitor);
    return gd_control_check(&control,
                            (double)(batch->line.text - body->bytes) / (double)body->size);
}

/* Is there time and room for another line? */
static bool admit(const struct batch *batch, struct proto_problem *problem)
{
    enum gd_status status = check_time(batch);
    if (status) return proto_problem_from_status(problem, status, NULL);
    if (batch->begin < ANSWER_MOST) return true;
    proto_problem_set(problem, PROTO_PROBLEM_TOO_LARGE,
                      "the answers before this line take the %zu bytes that those of a batch may "
                      "take; send this line and "
                      "the rest as another batch",
                      ANSWER_MOST);
    return proto_problem_limit(problem, ANSWER_MOST);
}

static void end_line(struct batch *batch, bool ok, struct proto_problem *problem)
{
    if (ok) {
        server_query_encode(batch->query, &batch->writer);
        proto_batch_end(&batch->writer, batch->begin);
        ok = proto_writer_check(&batch->writer, problem);
    }
    if (!ok) proto_batch_refuse(&batch->writer, batch->begin, &batch->line, problem);
    server_query_destroy(batch->query);
    batch->query = NULL;
}

/* False: the exchange is parked. */
static bool take_turn(struct batch *batch, enum server_query_turn turn,
                      struct proto_problem *problem)
{
    if (turn == SERVER_QUERY_DONE || turn == SERVER_QUERY_FAILED)
        end_line(batch, turn == SERVER_QUERY_DONE, problem);
    return turn != SERVER_QUERY_PARKED;
}

/* --- line by line ----------------------------------------------------------------------------- */

/* False: there are no more lines. */
static bool begin_line(struct batch *batch)
{
    const struct server_body *body = &batch->exchange->body;
    struct proto_problem problem;
    if (!proto_batch_next(body->bytes, body->size, &batch->line)) return false;
    batch->begin = proto_batch_begin(&batch->writer);
    if (admit(batch, &problem) && read_line(batch, &problem))
        take_turn(batch, server_query_glance(batch->query, &problem), &problem);
    else
        end_line(batch, false, &problem);
    return true;
}

/* --- handing on ------------------------------------------------------------------------------- */

/* Bytes of lines that are answered. */
static size_t ready_in(const struct batch *batch)
{
    return batch->query ? batch->begin : batch->writer.size;
}

/* Is it time to hand on what is collected? */
static bool is_ripe(const struct batch *batch)
{
    size_t ready = ready_in(batch);
    return batch->exchange->transport->can_stream && (batch->query ? ready > 0 : ready >= RIPE);
}

static void hand_on(struct batch *batch)
{
    struct proto_writer *writer = &batch->writer;
    size_t ready = ready_in(batch);
    server_relay_write(batch->relay, writer->data, ready);
    writer->size -= ready;
    memmove(writer->data, writer->data + ready, writer->size);
    batch->begin = 0;
}

static bool is_over(struct server_exchange *exchange)
{
    const struct batch *batch = exchange->state;
    return server_relay_is_over(batch->relay);
}

static const struct server_transport detached = {
    .finish = server_exchange_destroy, .is_gone = is_over, .can_stream = true};

/* A line that waits for somebody's field is refused when it is late, as are all after it: their
 * answers say so. */
static void refuse(struct server_job *job, enum server_refusal why)
{
    struct server_exchange *exchange = server_exchange_of(job);
    struct batch *batch = exchange->state;
    (void)why;
    batch->is_refused = batch->query != NULL;
    job->run(job);
}

/* Answers the request with the stream of the relay; the rest of the work is another exchange's.
 * NULL without memory. */
static struct server_exchange *detach(struct batch *batch, struct server_relay *relay,
                                      bool is_packed)
{
    struct server_exchange *exchange = batch->exchange;
    struct server_exchange *rest = server_exchange_detach(exchange, &detached);
    struct server_stream *stream = rest ? server_relay_open(relay) : NULL;
    if (!stream) {
        if (rest) exchange->body = rest->body;
        if (rest) rest->body = (struct server_body){0};
        server_exchange_destroy(rest);
        return NULL;
    }
    server_reply_tag(exchange, batch->surface->record->etag);
    server_reply_coding(exchange, is_packed);
    server_reply_stream(exchange, 200, NDJSON, stream);
    return rest;
}

/* From here on the batch is the other exchange's. */
static void move_to(struct batch *batch, struct server_exchange *rest)
{
    struct server_exchange *exchange = batch->exchange;
    rest->job.deadline_ns = exchange->job.deadline_ns;
    rest->job.refuse = refuse;
    rest->work = exchange->work;
    server_exchange_keep(rest, batch, free_batch);
    server_exchange_keep(exchange, NULL, NULL);
    batch->exchange = rest;
    if (batch->query) batch->query->exchange = rest;
}

/* True: the exchange is answered, and the batch is another thread's. False, without memory: it goes
 * on collecting. */
static bool start_stream(struct batch *batch)
{
    struct server_host *host = batch->exchange->host;
    bool is_packed = server_reply_takes_gzip(batch->exchange);
    struct server_relay *relay = server_relay_create(host, is_packed);
    struct server_exchange *rest = relay ? detach(batch, relay, is_packed) : NULL;
    if (!rest) {
        server_relay_release(relay);
        return false;
    }
    batch->relay = relay;
    move_to(batch, rest);
    server_exchange_count_deferred(host);
    server_workers_resume(host->workers, &rest->job);
    return true;
}

/* --- from the first line to the last ---------------------------------------------------------- */

/* True: there is nothing more to be done now, as `is_done` says: the exchange is answered or else
 * parked. */
static bool pass_on(struct batch *batch, bool *is_done)
{
    if (!is_ripe(batch)) return false;
    if (!batch->relay) return *is_done = start_stream(batch);
    hand_on(batch);
    *is_done = false;
    return server_relay_wait(batch->relay, &batch->exchange->job);
}

static void end_late_line(struct batch *batch)
{
    struct proto_problem problem;
    enum gd_status status = check_time(batch);
    (void)proto_problem_from_status(&problem, status ? status : GD_DEADLINE, NULL);
    batch->is_refused = false;
    end_line(batch, false, &problem);
}

static bool is_wanted(const struct batch *batch)
{
    return !batch->relay || !server_relay_is_over(batch->relay);
}

static void reply(struct batch *batch)
{
    struct server_exchange *exchange = batch->exchange;
    if (batch->relay) {
        hand_on(batch);
        batch->has_answered_all = !batch->writer.failure;
        server_reply_empty(exchange, 200);
        return;
    }
    server_reply_tag(exchange, batch->surface->record->etag);
    server_reply_text(exchange, 200, NDJSON, &batch->writer);
}

static bool work(struct server_exchange *exchange)
{
    struct batch *batch = exchange->state;
    struct proto_problem problem;
    bool is_done;
    if (batch->is_refused) end_late_line(batch);
    while (is_wanted(batch)) {
        if (pass_on(batch, &is_done)) return is_done;
        if (batch->query) {
            if (!take_turn(batch, batch->query->kind->solve(batch->query, &problem), &problem))
                return false;
        } else if (!begin_line(batch)) {
            break;
        }
    }
    reply(batch);
    return true;
}

/* --- the request ------------------------------------------------------------------------------ */

static bool is_ndjson(const char *content_type)
{
    size_t size = content_type ? strcspn(content_type, "; \t") : 0;
    return !content_type ||
           (size == strlen(NDJSON) && strncasecmp(content_type, NDJSON, size) == 0);
}

static bool check(struct server_exchange *exchange, struct proto_options *options,
                  struct proto_problem *problem)
{
    struct proto_parameters parameters = server_exchange_parameters(exchange);
    if (!proto_accept_quality(server_exchange_header(exchange, "Accept"), NDJSON))
        return proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                                 "the answer is lines of JSON; send Accept: " NDJSON " or none");
    if (!is_ndjson(server_exchange_header(exchange, "Content-Type")))
        return proto_problem_set(
            problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
            "a batch is lines of JSON: send it with the header Content-Type: " NDJSON);
    return proto_batch_parse(&parameters, options, problem);
}

void server_handle_batch(struct server_exchange *exchange)
{
    struct proto_options options;
    struct proto_problem problem;
    if (!check(exchange, &options, &problem)) {
        server_reply_problem(exchange, &problem);
        return;
    }
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    struct batch *batch = calloc(1, sizeof *batch);
    if (!batch) {
        server_surface_release(surface);
        server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                             "the system is out of memory");
        return;
    }
    *batch = (struct batch){.exchange = exchange, .surface = surface};
    server_reply_writer(exchange, &batch->writer);
    server_exchange_keep(exchange, batch, free_batch);
    server_exchange_shorten(exchange, options.timeout_ms);
    server_exchange_defer(exchange, work, NULL);
}
