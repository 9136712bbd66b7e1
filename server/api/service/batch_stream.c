/* Batch stream: answers many queries in one request. Each line of JSON is a query. The lines are
 * answered in order, by the steps of single requests (query.h).
 *
 * DESIGN. One worker answers line after line. If a line needs a field that another request builds,
 * the exchange is parked. When time or memory runs out, each remaining line is answered with the
 * problem.
 *
 * Answers are collected. If no line takes long, they are sent as one response. Otherwise, before
 * the first long line or when many bytes are ready, the response becomes a stream (relay.h), and a
 * detached exchange continues the work. From then on, collected answers are passed to the stream
 * before each long line. A job (Prefer: respond-async) collects all answers. */
#include "server/query/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "proto/http/accept.h"
#include "proto/queries/batch.h"
#include "server/exchange/relay.h"
#include "server/exchange/reply.h"
#include "server/query/query.h"
#include "server/query/request.h"

#define NDJSON "application/x-ndjson"
/* limit on the bytes of collected answers; later lines are refused */
#define ANSWER_MOST ((size_t)64 << 20)
/* if more bytes of answers are collected, they are passed to the stream, even before a quick
 * line */
#define FLUSH_BYTES 65536

struct batch {
    struct server_exchange *exchange; /* the request's exchange, or the detached one */
    struct server_surface *surface;
    struct proto_batch_line line; /* the current line */
    /* query of the current line; NULL means that the line is answered */
    struct server_query *query;
    size_t begin;               /* offset of the current line's answer in the writer */
    struct proto_writer writer; /* answers that are not yet in the stream */
    struct server_relay *relay; /* NULL means that the request is not answered yet */
    bool is_whole;              /* true if all lines are answered in the stream */
    bool is_refused;            /* the line is late */
};

static void batch_free(void *state)
{
    struct batch *batch = state;
    if (batch->relay) server_relay_end(batch->relay, batch->is_whole);
    server_relay_release(batch->relay);
    server_query_destroy(batch->query);
    server_surface_release(batch->surface);
    proto_writer_free(&batch->writer);
    free(batch);
}

/* --- one line --------------------------------------------------------------------------------- */

/* Returns the route of a query that a line can contain. */
static const struct proto_route *route_find(const char *name, struct proto_problem *problem)
{
    static const char *const names[] = {"distance",        "path",           "nearest", "matrix",
                                        "distance-to-set", "curve-distance", "spline",  "trace",
                                        "transport",       "voronoi"};
    char known[256] = "";
    bool is_known = false;
    for (size_t i = 0, length = 0; i < sizeof names / sizeof names[0]; i++) {
        is_known |= strcmp(names[i], name) == 0;
        length += (size_t)snprintf(known + length, sizeof known - length, "%s%s", i ? ", " : "",
                                   names[i]);
    }
    for (size_t i = 0; i < proto_route_count && is_known; i++)
        if (proto_routes[i].query && strcmp(proto_routes[i].query, name) == 0)
            return &proto_routes[i];
    proto_problem_refuse(problem, "/query", "a batch has no query \"%s\"; it takes %s", name,
                         known);
    return NULL;
}

static bool line_decode(struct batch *batch, const struct proto_batch_query *line,
                        struct proto_problem *problem)
{
    const struct server_body *body = &batch->exchange->body;
    const struct proto_route *route = route_find(line->name, problem);
    if (!route) return false;
    struct server_query *query = server_query_create(route->kind, batch->exchange, batch->surface);
    batch->query = query;
    if (!query) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    query->problem = problem;
    query->begun = (double)(batch->line.text - body->bytes) / (double)body->size;
    query->share = (double)batch->line.size / (double)body->size;
    if (!proto_batch_options(line, &batch->exchange->parameters, route, &query->options, problem))
        return false;
    if (route->kind->has_bare_points && !line->has_geometry &&
        !proto_parameters_get(&batch->exchange->parameters, "geometry"))
        query->options.geometry = PROTO_GEOMETRY_XYZ;
    return route->kind->decode(query, line->document);
}

static bool line_read(struct batch *batch, struct proto_problem *problem)
{
    struct proto_batch_query line;
    if (!server_request_begin_parsing(batch->exchange, batch->line.text, batch->line.size, problem))
        return false;
    bool ok = proto_batch_decode(&batch->line, &line, problem);
    if (ok) {
        ok = line_decode(batch, &line, problem);
        proto_batch_query_free(&line);
    }
    server_request_end_parsing(batch->exchange);
    return ok;
}

/* Checks the deadline of the batch, the drain of the daemon, and whether the client is still
 * connected. */
static enum gd_status batch_check(const struct batch *batch)
{
    const struct server_body *body = &batch->exchange->body;
    struct server_monitor monitor = {.exchange = batch->exchange, .share = 1};
    struct gd_control control = server_exchange_control(&monitor);
    return gd_control_check(&control,
                            (double)(batch->line.text - body->bytes) / (double)body->size);
}

static bool line_admit(const struct batch *batch, struct proto_problem *problem)
{
    enum gd_status status = batch_check(batch);
    if (status) return proto_problem_from_status(problem, status, NULL);
    if (batch->begin < ANSWER_MOST) return true;
    return proto_problem_exceed(
        problem, NULL, ANSWER_MOST,
        "the answers before this line have reached the limit of %zu bytes for a batch; send "
        "this line and the rest as another batch",
        ANSWER_MOST);
}

static void line_end(struct batch *batch, bool ok, struct proto_problem *problem)
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

/* Starts the next line. Returns false at the end. */
static bool line_begin(struct batch *batch)
{
    const struct server_body *body = &batch->exchange->body;
    enum server_query_turn turn = SERVER_QUERY_FAILED;
    struct proto_problem problem;
    if (!proto_batch_next(body->bytes, body->size, &batch->line)) return false;
    batch->begin = proto_batch_begin(&batch->writer);
    if (line_admit(batch, &problem) && line_read(batch, &problem))
        turn = server_query_try_inline(batch->query);
    if (turn != SERVER_QUERY_AGAIN) line_end(batch, turn == SERVER_QUERY_DONE, &problem);
    return true;
}

static void line_end_late(struct batch *batch)
{
    struct proto_problem problem;
    enum gd_status status = batch_check(batch);
    (void)proto_problem_from_status(&problem, status ? status : GD_DEADLINE, NULL);
    batch->is_refused = false;
    line_end(batch, false, &problem);
}

/* --- the stream ------------------------------------------------------------------------------- */

/* Returns the number of bytes of answers that are not yet sent. */
static size_t batch_ready(const struct batch *batch)
{
    return batch->query ? batch->begin : batch->writer.size;
}

static void stream_write(struct batch *batch)
{
    struct proto_writer *writer = &batch->writer;
    size_t ready = batch_ready(batch);
    server_relay_write(batch->relay, writer->data, ready);
    writer->size -= ready;
    memmove(writer->data, writer->data + ready, writer->size);
    batch->begin = 0;
}

static bool on_is_gone(struct server_exchange *exchange)
{
    const struct batch *batch = exchange->state;
    return server_relay_is_over(batch->relay);
}

/* Refuses a late line that waits for a field, and all lines after it. */
static void on_refuse(struct server_job *job, enum server_refusal why)
{
    struct batch *batch = server_exchange_of(job)->state;
    (void)why;
    batch->is_refused = batch->query != NULL;
    job->run(job);
}

/* Starts the stream. Returns true if the request is answered; the batch then belongs to the
 * detached exchange, perhaps in another thread. Returns false if out of memory; the batch then
 * continues to collect answers. */
static bool stream_start(struct batch *batch)
{
    static const struct server_transport transport = {
        .finish = server_exchange_destroy, .is_gone = on_is_gone, .can_stream = true};
    struct server_exchange *exchange = batch->exchange;
    struct server_exchange *rest =
        server_request_stream(exchange, &transport, NDJSON, &batch->relay);
    if (!rest) return false;
    server_reply_tag(exchange, batch->surface->record->etag, "ndjson");
    rest->job.refuse = on_refuse;
    server_exchange_keep(rest, batch, batch_free);
    server_exchange_keep(exchange, NULL, NULL);
    batch->exchange = rest;
    if (batch->query) batch->query->exchange = rest;
    server_request_go_on(rest);
    return true;
}

/* Passes answers to the stream. Returns true if the exchange is answered (`is_done`) or parked. */
static bool stream_pass(struct batch *batch, bool *is_done)
{
    size_t ready = batch_ready(batch);
    *is_done = false;
    if (!batch->exchange->transport->can_stream || ready < (batch->query ? 1 : FLUSH_BYTES))
        return false;
    if (!batch->relay) return *is_done = stream_start(batch);
    stream_write(batch);
    return server_relay_wait(batch->relay, &batch->exchange->job);
}

/* --- the request ------------------------------------------------------------------------------ */

static void batch_reply(struct batch *batch)
{
    struct server_exchange *exchange = batch->exchange;
    if (batch->relay) {
        stream_write(batch);
        batch->is_whole = !batch->writer.failure;
        server_reply_empty(exchange, 200);
        return;
    }
    server_reply_tag(exchange, batch->surface->record->etag, "ndjson");
    server_reply_text(exchange, 200, NDJSON, &batch->writer);
}

static bool batch_work(struct server_exchange *exchange)
{
    struct batch *batch = exchange->state;
    struct proto_problem problem;
    bool is_done;
    if (batch->is_refused) line_end_late(batch);
    while (!batch->relay || !server_relay_is_over(batch->relay)) {
        if (stream_pass(batch, &is_done)) return is_done;
        if (!batch->query) {
            if (!line_begin(batch)) break;
            continue;
        }
        batch->query->problem = &problem;
        enum server_query_turn turn = server_query_solve(batch->query);
        if (turn == SERVER_QUERY_PARKED) return false;
        if (turn != SERVER_QUERY_AGAIN) line_end(batch, turn == SERVER_QUERY_DONE, &problem);
    }
    batch_reply(batch);
    return true;
}

static bool request_check(struct server_exchange *exchange, struct proto_options *options,
                          struct proto_problem *problem)
{
    const char *type = server_exchange_header(exchange, "Content-Type");
    size_t size = type ? strcspn(type, "; \t") : 0;
    if (!proto_accept_quality(server_exchange_header(exchange, "Accept"), NDJSON))
        return proto_problem_set(problem, PROTO_PROBLEM_NOT_ACCEPTABLE,
                                 "the answer is lines of JSON; send Accept: " NDJSON " or none");
    if (type && (size != strlen(NDJSON) || strncasecmp(type, NDJSON, size) != 0))
        return proto_problem_set(
            problem, PROTO_PROBLEM_UNSUPPORTED_MEDIA_TYPE,
            "a batch is lines of JSON: send it with the header Content-Type: " NDJSON);
    return proto_options_parse(&exchange->parameters, NULL, proto_post_batch_parameters, options,
                               problem);
}

void server_handle_batch(struct server_exchange *exchange)
{
    struct proto_options options;
    struct proto_problem problem;
    if (!server_reply_check(exchange, request_check(exchange, &options, &problem), &problem))
        return;
    struct server_surface *surface = server_request_surface(exchange);
    if (!surface) return;
    struct batch *batch = server_request_allocate(exchange, sizeof *batch, batch_free);
    if (!batch) return;
    batch->exchange = exchange;
    batch->surface = server_surface_retain(surface);
    server_reply_writer(exchange, &batch->writer);
    server_exchange_shorten(exchange, options.timeout_ms);
    server_exchange_defer(exchange, batch_work, NULL);
}
