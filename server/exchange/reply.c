#include "server/exchange/reply.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/http/accept.h"
#include "server/exchange/etag.h"
#include "server/base/gzip.h"

/* answers of fewer bytes are not compressed, because they fit into one packet */
#define GZIP_FROM    1025
#define PROBLEM_MOST 65536 /* limit on the bytes of a problem's text, far above any real one */
#define JSON         "application/json"
#define PROBLEM_JSON "application/problem+json"
#define EXPOSED_HEADERS                                                                            \
    "Allow, Content-Encoding, Deprecation, ETag, Geodesic-Faces, Geodesic-Largest-Distance, "      \
    "Link, Location, Preference-Applied, Retry-After, WWW-Authenticate, X-Request-Id"
/* a browser that shows data as a document must not load anything for this document */
#define DATA_POLICY "default-src 'none'; frame-ancestors 'none'"

/* Answers with bytes that outlive the answer. Returns the response, so that the caller can set
 * `owned`. */
static struct server_response *response_set(struct server_exchange *exchange, unsigned status,
                                            const char *media_type, const void *body, size_t size)
{
    struct server_response *response = &exchange->response;
    response->status = status;
    response->media_type = media_type;
    response->body = body;
    response->owned = NULL;
    response->size = size;
    return response;
}

static void header_add(struct server_response *response, const char *name, const char *value)
{
    if (response->header_count == SERVER_RESPONSE_HEADERS) return;
    size_t size = strnlen(value, SERVER_HEADER_VALUE - 1);
    char *copy = response->headers[response->header_count].value;
    memcpy(copy, value, size);
    copy[size] = '\0';
    response->headers[response->header_count].size = size;
    response->headers[response->header_count++].name = name;
}

void server_reply_header(struct server_exchange *exchange, const char *name, const char *format,
                         ...)
{
    char value[SERVER_HEADER_VALUE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(value, sizeof value, format, arguments);
    va_end(arguments);
    header_add(&exchange->response, name, value);
}

void server_reply_tag(struct server_exchange *exchange, const char *etag, const char *form)
{
    char quoted[SERVER_ETAG_TEXT + 2] = "\"";
    server_etag_write(quoted + 1, etag, form);
    strcat(quoted, "\"");
    header_add(&exchange->response, "ETag", quoted);
}

void server_reply_writer(struct server_exchange *exchange, struct proto_writer *writer)
{
    proto_writer_init(writer, exchange->host->budget->largest_answer);
    writer->account = &exchange->share->account;
}

/* Moves the bytes of a body from SERVER_BUDGET_FLIGHT to SERVER_BUDGET_ANSWERS. */
static bool answer_hold(struct server_exchange *exchange, size_t size,
                        struct proto_problem *problem)
{
    struct server_budget *budget = exchange->host->budget;
    struct proto_writer counting = {.maximum = server_share_largest_answer(exchange->share)};
    size_t counted = proto_writer_counted(size),
           flight = size < exchange->held ? size : exchange->held;
    server_budget_give(budget, SERVER_BUDGET_FLIGHT, flight);
    exchange->held -= flight;
    if (size > counting.maximum)
        counting.failure = PROTO_WRITER_TOO_LARGE;
    else if (counted && !server_share_take_answer(exchange->share, counted))
        counting.failure = PROTO_WRITER_NO_ROOM;
    else
        exchange->response.held = counted;
    return proto_writer_check(&counting, problem);
}

void server_reply_bytes(struct server_exchange *exchange, unsigned status, const char *media_type,
                        void *bytes, size_t size)
{
    struct proto_problem problem;
    if (exchange->response.held || answer_hold(exchange, size, &problem)) {
        response_set(exchange, status, media_type, bytes, size)->owned = bytes;
        return;
    }
    free(bytes);
    server_reply_problem(exchange, &problem);
}

void server_reply_stream(struct server_exchange *exchange, unsigned status, const char *media_type,
                         struct server_stream *stream)
{
    response_set(exchange, status, media_type, NULL, 0)->stream = stream;
}

void server_reply_empty(struct server_exchange *exchange, unsigned status)
{
    response_set(exchange, status, NULL, NULL, 0);
}

/* Answers with the text of a writer that has not failed. If the writer has no account, its text is
 * counted even beyond the limit. */
static void text_set(struct server_exchange *exchange, unsigned status, const char *media_type,
                     struct proto_writer *writer)
{
    size_t size = 0;
    bool is_counted = writer->account != NULL;
    char *text = proto_writer_take(writer, &size);
    exchange->response.held = proto_writer_counted(size);
    if (!is_counted) server_share_count_answer(exchange->share, exchange->response.held);
    response_set(exchange, status, media_type, text, size)->owned = text;
}

void server_reply_text(struct server_exchange *exchange, unsigned status, const char *media_type,
                       struct proto_writer *writer)
{
    struct proto_problem problem;
    if (!proto_writer_check(writer, &problem)) {
        proto_writer_free(writer);
        server_reply_problem(exchange, &problem);
        return;
    }
    text_set(exchange, status, media_type, writer);
}

void server_reply_lent(struct server_exchange *exchange, unsigned status, const char *media_type,
                       struct proto_writer *head, const struct server_lent *lent)
{
    server_reply_text(exchange, status, media_type, head);
    if (exchange->response.problem != PROTO_PROBLEM_NONE) {
        lent->release(lent->lender);
        return;
    }
    exchange->response.lent = *lent;
    exchange->response.size += lent->size + strlen(lent->tail);
}

void server_reply_json(struct server_exchange *exchange, unsigned status,
                       struct proto_writer *writer)
{
    server_reply_text(exchange, status, JSON, writer);
}

/* Replies with a problem; or without a body if there is no memory for the problem's text. */
void server_reply_problem(struct server_exchange *exchange, const struct proto_problem *problem)
{
    struct proto_writer writer;
    size_t size = 0;
    struct proto_problem sent = *problem;
    snprintf(sent.parameter, sizeof sent.parameter, "%s",
             server_exchange_sent_name(exchange, problem->parameter));
    proto_writer_init(&writer, PROBLEM_MOST);
    proto_problem_encode(&writer, &sent);
    char *text = proto_writer_take(&writer, &size);
    proto_writer_free(&writer);
    exchange->response.header_count = 0;
    exchange->response.problem = problem->code;
    if (problem->allow[0]) server_reply_header(exchange, "Allow", "%s, OPTIONS", problem->allow);
    if (problem->challenge) header_add(&exchange->response, "WWW-Authenticate", problem->challenge);
    if (problem->retry_after)
        server_reply_header(exchange, "Retry-After", "%u", problem->retry_after);
    response_set(exchange, problem->status, PROBLEM_JSON, text, size)->owned = text;
}

bool server_reply_check(struct server_exchange *exchange, bool is_well,
                        const struct proto_problem *problem)
{
    if (!is_well) server_reply_problem(exchange, problem);
    return is_well;
}

void server_reply_refusal(struct server_exchange *exchange, enum proto_problem_code code,
                          const char *format, ...)
{
    char sentence[PROTO_PROBLEM_DETAIL];
    struct proto_problem problem;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    (void)proto_problem_set(&problem, code, "%s", sentence);
    if (problem.status == 503 && !problem.retry_after) problem.retry_after = 1;
    server_reply_problem(exchange, &problem);
}

bool server_reply_accepts_json(struct server_exchange *exchange)
{
    if (proto_accept_quality(server_exchange_header(exchange, "Accept"), JSON) > 0) return true;
    server_reply_refusal(exchange, PROTO_PROBLEM_NOT_ACCEPTABLE,
                         "the answer is JSON; send Accept: application/json or none");
    return false;
}

static bool client_lists_gzip(const struct server_exchange *exchange)
{
    return proto_accept_lists_coding(server_exchange_header(exchange, "Accept-Encoding"), "gzip");
}

/* Returns true if the client is a browser on this host. Such a browser accepts gzip, but within a
 * host compression takes more time than it saves. */
static bool client_is_near_browser(const struct server_exchange *exchange)
{
    static const char *const proxied[] = {"Forwarded", "Via", "X-Forwarded-For", "X-Real-IP"};
    if (!exchange->is_local || !server_exchange_header(exchange, "Sec-Fetch-Site")) return false;
    for (size_t i = 0; i < sizeof proxied / sizeof *proxied; i++)
        if (server_exchange_header(exchange, proxied[i])) return false;
    return true;
}

bool server_reply_takes_gzip(const struct server_exchange *exchange)
{
    return client_lists_gzip(exchange) && !client_is_near_browser(exchange);
}

void server_reply_coding(struct server_exchange *exchange, bool is_packed)
{
    header_add(&exchange->response, "Vary", "Accept-Encoding");
    if (is_packed) header_add(&exchange->response, "Content-Encoding", "gzip");
}

void server_reply_asset(struct server_exchange *exchange, const struct proto_asset *asset)
{
    header_add(&exchange->response, "ETag", asset->etag);
    header_add(&exchange->response, "Vary", "Accept-Encoding");
    header_add(&exchange->response, "Referrer-Policy", "no-referrer");
    header_add(&exchange->response, "Cross-Origin-Resource-Policy", "same-origin");
    exchange->response.policy = asset->policy;
    bool is_packed = asset->gzip && client_lists_gzip(exchange);
    if (is_packed) header_add(&exchange->response, "Content-Encoding", "gzip");
    response_set(exchange, 200, asset->media_type, is_packed ? asset->gzip : asset->bytes,
                 is_packed ? asset->gzip_size : asset->size);
}

/* --- sealing ---------------------------------------------------------------------------------- */

static struct server_response_header *response_header(struct server_response *response,
                                                      const char *name)
{
    for (uint32_t i = 0; i < response->header_count; i++)
        if (strcmp(response->headers[i].name, name) == 0) return &response->headers[i];
    return NULL;
}

static void tag_name_packed(struct server_response_header *tag)
{
    static const char end[] = SERVER_ETAG_PACKED_SUFFIX "\"";
    if (tag->size + sizeof end > sizeof tag->value) return;
    memcpy(tag->value + tag->size - 1, end, sizeof end);
    tag->size += sizeof end - 2;
}

/* Makes the answer a 304 without headers that describe the body (RFC 9110, 15.4.5). */
static void not_modified_set(struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    uint32_t kept = 0;
    server_exchange_drop_body(exchange);
    for (uint32_t i = 0; i < response->header_count; i++)
        if (strncmp(response->headers[i].name, "Content-", strlen("Content-")) != 0)
            response->headers[kept++] = response->headers[i];
    response->header_count = kept;
    response->status = 304;
    response->media_type = NULL;
}

/* Evaluates the conditions of a GET or HEAD with the status 200 or 304, in the order of RFC 9110,
 * 13.2.2: If-Match, then If-None-Match. Answers with other statuses ignore them (13.2.1). */
static void conditions_apply(struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    char tag[SERVER_HEADER_VALUE];
    if (!exchange->has_conditions || (response->status != 200 && response->status != 304)) return;
    if (!server_exchange_is(exchange, "GET") && !server_exchange_is(exchange, "HEAD")) return;
    struct server_response_header *quoted = response_header(response, "ETag");
    if (!quoted) return;
    snprintf(tag, sizeof tag, "%.*s", (int)quoted->size - 2, quoted->value + 1);
    const struct server_precondition precondition = server_precondition_read(exchange);
    enum server_etag_form known = server_precondition_known(&precondition, tag);
    if (!server_precondition_matches(&precondition, tag)) {
        server_exchange_drop_body(exchange);
        server_reply_refusal(
            exchange, PROTO_PROBLEM_PRECONDITION_FAILED,
            "the ETag of the resource is not the one in If-Match; get the resource and try again");
    } else if (known) {
        if (known == SERVER_ETAG_PACKED) tag_name_packed(quoted);
        not_modified_set(exchange);
    }
}

/* Returns true if compression saves enough. PNG is compressed already. */
static bool response_is_packable(const struct server_response *response)
{
    return response->owned && !response->lent.bytes && response->size >= GZIP_FROM &&
           strcmp(response->media_type, "image/png") != 0;
}

static void body_compress(struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    struct proto_writer packed;
    if (!response_is_packable(response) || !server_reply_takes_gzip(exchange)) return;
    server_reply_writer(exchange, &packed);
    packed.maximum = response->size - 1;
    if (!server_gzip(response->body, response->size, &packed)) {
        proto_writer_free(&packed); /* compression failed: the body is sent uncompressed */
        return;
    }
    server_exchange_drop_body(exchange);
    text_set(exchange, response->status, response->media_type, &packed);
    header_add(response, "Content-Encoding", "gzip");
}

/* Adds the headers of CORS. Vary makes caches store the answers to different origins separately. */
static void origin_allow(struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    if (exchange->host->has_cors_origins) header_add(response, "Vary", "Origin");
    if (!exchange->cors_origin) return;
    header_add(response, "Access-Control-Allow-Origin", exchange->cors_origin);
    header_add(response, "Access-Control-Expose-Headers", EXPOSED_HEADERS);
}

/* Adds the Content-Security-Policy. --frame-ancestors replaces the 'none' in the policy of pages,
 * never in that of data. */
static void policy_add(struct server_exchange *exchange)
{
    static const char none[] = "frame-ancestors 'none'";
    struct server_response *response = &exchange->response;
    const char *policy = response->policy ? response->policy : DATA_POLICY;
    const char *ancestors = exchange->host->frame_ancestors;
    const char *at = response->policy && *ancestors ? strstr(policy, none) : NULL;
    if (at)
        server_reply_header(exchange, "Content-Security-Policy", "%.*sframe-ancestors %s%s",
                            (int)(at - policy), policy, ancestors, at + sizeof none - 1);
    else
        header_add(response, "Content-Security-Policy", policy);
}

void server_reply_seal(struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    if (response_is_packable(response)) header_add(response, "Vary", "Accept-Encoding");
    conditions_apply(exchange);
    body_compress(exchange);
    struct server_response_header *tag = response_header(response, "ETag");
    if (tag && response->status != 304 && response_header(response, "Content-Encoding"))
        tag_name_packed(tag);
    if (response->media_type) header_add(response, "Content-Type", response->media_type);
    origin_allow(exchange);
    if (exchange->deprecation) {
        server_reply_header(exchange, "Deprecation", "@%lld",
                            (long long)exchange->deprecation->since);
        server_reply_header(exchange, "Link", "<%s>; rel=\"deprecation\"; type=\"text/html\"",
                            exchange->match.route->documentation);
    }
    header_add(response, "X-Request-Id", exchange->request_id);
    header_add(response, "X-Content-Type-Options", "nosniff");
    policy_add(exchange);
    header_add(response, "Cache-Control", tag ? "no-cache" : "no-store");
    if (atomic_load_explicit(&exchange->host->is_draining, memory_order_relaxed))
        response->close = true;
}

/* --- deferred exchanges ----------------------------------------------------------------------- */

static void exchange_finish(struct server_exchange *exchange)
{
    struct server_host *host = exchange->host;
    /* freed now, because other requests may wait for the resources of the state */
    server_exchange_drop_state(exchange);
    exchange->transport->finish(exchange);
    atomic_fetch_sub(&host->deferred, 1);
}

void server_exchange_job_run(struct server_job *job)
{
    struct server_exchange *exchange = server_exchange_of(job);
    if (exchange->transport->begin) exchange->transport->begin(exchange);
    do {
        if (!exchange->work(exchange)) return; /* once it is parked, another thread may own it */
    } while (!exchange->response.status);
    exchange_finish(exchange);
}

void server_exchange_job_refuse(struct server_job *job, enum server_refusal why)
{
    struct server_exchange *exchange = server_exchange_of(job);
    struct proto_problem problem;
    bool is_late = why == SERVER_REFUSAL_DEADLINE && !atomic_load(&job->is_unwanted);
    if (why == SERVER_REFUSAL_MEMORY)
        (void)server_budget_refuse(exchange->host->budget, "the mesh", 0, &problem);
    else
        (void)proto_problem_from_status(&problem, is_late ? GD_DEADLINE : GD_CANCELLED, NULL);
    server_reply_problem(exchange, &problem);
    exchange_finish(exchange);
}

void server_exchange_count_deferred(struct server_host *host)
{
    if (atomic_fetch_add(&host->deferred, 1) == 0) host->watch(host->watcher);
}

bool server_exchange_queue(struct server_exchange *exchange)
{
    struct server_host *host = exchange->host;
    if (server_workers_submit(host->workers, &exchange->job)) return true;
    server_reply_refusal(exchange, PROTO_PROBLEM_OVERLOADED,
                         "all workers are busy, and the queue of %llu requests, which tenants "
                         "share, is full; try again in a moment",
                         (unsigned long long)host->queue_length);
    return false;
}

void server_exchange_submit(struct server_exchange *exchange)
{
    server_exchange_count_deferred(exchange->host);
    exchange->job.tenant = exchange->tenant;
    if (exchange->join && exchange->join(exchange)) return;
    if (!server_exchange_queue(exchange)) exchange_finish(exchange);
}
