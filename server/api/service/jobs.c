/* Deferred jobs: starts, lists, describes, follows and removes them (jobs/job_table.h). */
#include "server/query/handlers.h"

#include <string.h>

#include "proto/http/accept.h"
#include "proto/http/job.h"
#include "proto/http/page.h"
#include "proto/queries/many.h"
#include "server/exchange/events.h"
#include "server/exchange/reply.h"
#include "server/jobs/job_table.h"
#include "server/query/api.h"
#include "server/query/request.h"

#define EVENT_STREAM "text/event-stream"
/* answers of at least this many bytes are lent; shorter answers are copied */
#define LENT_FROM 65536

static void release_job(void *user)
{
    server_deferred_job_release(user);
}

/* Returns the job in the path, which becomes the exchange's state; or replies with a problem and
 * returns NULL. */
static struct server_deferred_job *find_job(struct server_exchange *exchange)
{
    const struct proto_capture *id = &exchange->match.captures[0];
    struct server_deferred_job *job =
        server_job_table_find(exchange->host->api->jobs, exchange->tenant, id->text, id->length);
    if (job)
        server_exchange_keep(exchange, job, release_job);
    else
        server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND,
                             "there is no job of this id: it was removed, or has ended some time "
                             "ago, or the daemon was "
                             "started again; GET /v1/jobs lists those that there are");
    return job;
}

/* --- describe --------------------------------------------------------------------------------- */

/* Lends a large answer to the response. The response holds a reference of the job until it is
 * sent. */
static struct server_lent lend_answer(struct server_deferred_job *job,
                                      const struct proto_job_answer *answer, const char *tail)
{
    return (struct server_lent){.bytes = answer->body,
                                .size = answer->size,
                                .tail = tail,
                                .lender = server_deferred_job_retain(job),
                                .release = release_job};
}

static void reply_job(struct server_exchange *exchange, unsigned status,
                      struct server_deferred_job *job, const struct proto_job *state)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    if (state->answer && state->answer->size >= LENT_FROM &&
        proto_job_encode_head(&writer, state)) {
        const struct server_lent lent = lend_answer(job, state->answer, PROTO_JOB_TAIL);
        server_reply_lent(exchange, status, "application/json", &writer, &lent);
        return;
    }
    proto_job_encode(&writer, state, PROTO_JOB_FULL);
    server_reply_json(exchange, status, &writer);
}

static void reply_answer(struct server_exchange *exchange, struct server_deferred_job *job,
                         const struct proto_job_answer *answer)
{
    struct proto_writer writer;
    for (uint32_t i = 0; i < answer->header_count; i++)
        server_reply_header(exchange, answer->headers[i].name, "%s", answer->headers[i].value);
    server_reply_writer(exchange, &writer);
    if (answer->size >= LENT_FROM) {
        const struct server_lent lent = lend_answer(job, answer, "");
        server_reply_lent(exchange, answer->status, answer->media_type, &writer, &lent);
        return;
    }
    proto_append(&writer, answer->body, answer->size);
    server_reply_text(exchange, answer->status, answer->media_type, &writer);
}

static bool describe_job(struct server_exchange *exchange)
{
    const struct proto_job state = server_deferred_job_describe(exchange->state);
    reply_job(exchange, 200, exchange->state, &state);
    return true;
}

/* Parks the exchange, without a worker, until the job has ended or the wait is over. */
static bool wait_for_end(struct server_exchange *exchange)
{
    struct proto_problem problem;
    uint64_t wait_s;
    return proto_many_parse_wait(&exchange->parameters, &wait_s, &problem) &&
           server_deferred_job_wait(exchange->state, &exchange->job,
                                    server_request_wait_end(exchange, wait_s));
}

void server_handle_get_job(struct server_exchange *exchange)
{
    uint64_t wait_s;
    if (!server_reply_accepts_json(exchange) || !server_request_wait(exchange, &wait_s)) return;
    struct server_deferred_job *job = find_job(exchange);
    if (!job) return;
    if (wait_s && !proto_job_has_ended(server_deferred_job_describe(job).state))
        server_exchange_defer(exchange, describe_job, wait_for_end);
    else
        (void)describe_job(exchange);
}

void server_handle_get_job_result(struct server_exchange *exchange)
{
    if (!server_request_is_plain(exchange)) return;
    struct server_deferred_job *job = find_job(exchange);
    if (!job) return;
    const struct proto_job state = server_deferred_job_describe(job);
    if (state.answer)
        reply_answer(exchange, job, state.answer);
    else
        server_reply_refusal(exchange, PROTO_PROBLEM_CONFLICT,
                             state.state == PROTO_JOB_CANCELLED
                                 ? "the job was cancelled and has no answer; send the request again"
                                 : "the job has not ended; GET it with ?wait= until it has");
}

/* --- list ------------------------------------------------------------------------------------- */

static void reply_page(struct server_exchange *exchange, uint32_t limit,
                       struct server_deferred_job **jobs, uint32_t count)
{
    uint32_t written = count < limit ? count : limit;
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    proto_page_begin(&writer, "jobs");
    for (uint32_t i = 0; i < written; i++) {
        const struct proto_job state = server_deferred_job_describe(jobs[i]);
        proto_job_encode(&writer, &state, PROTO_JOB_BRIEF);
    }
    proto_page_end(&writer,
                   count > limit ? server_deferred_job_describe(jobs[limit - 1]).id : NULL);
    server_reply_json(exchange, 200, &writer);
}

/* Replies with a page of jobs. Returns false if the page is too long for an HTTP thread. */
static bool list_jobs(struct server_exchange *exchange)
{
    uint32_t most = exchange->work ? PROTO_PAGE_MOST : SERVER_REQUEST_SHORT_LIST;
    struct proto_page page;
    struct server_deferred_job *jobs[PROTO_PAGE_MOST + 1];
    if (!server_request_page(exchange, &page)) return true;
    uint32_t wanted = page.limit < most ? page.limit : most;
    uint32_t count = server_job_table_list(exchange->host->api->jobs, exchange->tenant, page.after,
                                           wanted + 1, jobs);
    bool is_whole = page.limit <= most || count <= most;
    if (is_whole) reply_page(exchange, page.limit, jobs, count);
    for (uint32_t i = 0; i < count; i++) server_deferred_job_release(jobs[i]);
    return is_whole;
}

void server_handle_list_jobs(struct server_exchange *exchange)
{
    if (server_reply_accepts_json(exchange) && !list_jobs(exchange))
        server_request_list(exchange, list_jobs);
}

/* --- start, remove ---------------------------------------------------------------------------- */

void server_handle_async(struct server_exchange *exchange)
{
    struct proto_problem problem;
    struct server_job_table *table = exchange->host->api->jobs;
    struct server_deferred_job *job = server_job_table_start(table, exchange, &problem);
    if (!server_reply_check(exchange, job, &problem)) return;
    const struct proto_job state = server_deferred_job_describe(job);
    /* the request was refused at once: the client gets no job */
    if (state.answer && state.answer->status == 503) {
        reply_answer(exchange, job, state.answer);
        server_job_table_cancel(table, job);
    } else {
        server_reply_header(exchange, "Location", "/v1/jobs/%s", state.id);
        server_reply_header(exchange, "Preference-Applied", "respond-async");
        reply_job(exchange, 202, job, &state);
    }
    server_deferred_job_release(job);
}

void server_handle_delete_job(struct server_exchange *exchange)
{
    struct proto_problem problem;
    if (!server_request_is_plain(exchange)) return;
    struct server_deferred_job *job = find_job(exchange);
    if (!job) return;
    bool may_change =
        server_grant_may_change(&exchange->grant, server_deferred_job_key(job), &problem);
    if (server_reply_check(exchange, may_change, &problem)) {
        server_job_table_cancel(exchange->host->api->jobs, job);
        server_exchange_drop_state(exchange); /* frees the job before the client gets the answer */
        server_reply_empty(exchange, 204);
    }
}

/* --- events ----------------------------------------------------------------------------------- */

/* Combines state and progress in one number. */
static uint64_t event_version(void *user)
{
    const struct proto_job state = server_deferred_job_describe(user);
    return (uint64_t)state.state << 32 | (uint64_t)(state.progress * UINT32_MAX);
}

static bool event_write(void *user, struct proto_writer *writer)
{
    const struct proto_job state = server_deferred_job_describe(user);
    proto_job_encode_event(writer, &state);
    return !proto_job_has_ended(state.state);
}

static void reply_events(struct server_exchange *exchange, struct server_deferred_job *job)
{
    struct server_host *host = exchange->host;
    const struct server_event_source source = {.version = event_version,
                                               .write = event_write,
                                               .release = release_job,
                                               .user = server_deferred_job_retain(job)};
    struct server_stream *stream = server_stream_open(host->events, &source);
    if (!stream) {
        server_deferred_job_release(job);
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
        return;
    }
    host->watch(host->watcher);
    server_reply_stream(exchange, 200, EVENT_STREAM, stream);
}

void server_handle_get_job_events(struct server_exchange *exchange)
{
    if (!server_request_is_plain(exchange)) return;
    if (proto_accept_quality(server_exchange_header(exchange, "Accept"), EVENT_STREAM) == 0) {
        server_reply_refusal(exchange, PROTO_PROBLEM_NOT_ACCEPTABLE,
                             "the answer is a stream of events; send Accept: " EVENT_STREAM
                             " or none");
        return;
    }
    const char *last = server_exchange_header(exchange, "Last-Event-ID");
    struct server_deferred_job *job = find_job(exchange);
    if (!job) return;
    if (last && strcmp(last, PROTO_JOB_LAST_EVENT) == 0)
        /* after the last event, 204 stops a browser from reconnecting */
        server_reply_empty(exchange, 204);
    else
        reply_events(exchange, job);
}
