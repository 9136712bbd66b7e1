/* Jobs: operations that are answered later, and what clients ask about them. */
#include "server/query/handlers.h"

#include <stdlib.h>
#include <string.h>

#include "proto/accept.h"
#include "proto/job.h"
#include "proto/page.h"
#include "server/http/events.h"
#include "server/query/request.h"
#include "server/jobs/jobs.h"
#include "server/http/reply.h"
#include "server/query/api.h"
#include "server/work/deadlines.h"

#define EVENT_STREAM "text/event-stream"
#define LENT_FROM    65536 /* bytes of an answer; shorter ones are copied */

/* --- found ------------------------------------------------------------------------------------ */

/* The job that the path names, for the caller to release; NULL: replied. */
static struct server_async *find_job(struct server_exchange *exchange)
{
    const struct proto_capture *id = &exchange->match.captures[0];
    struct server_async *job =
        server_jobs_find(exchange->host->api->jobs, exchange->tenant, id->text, id->length);
    if (!job)
        server_reply_refusal(exchange, PROTO_PROBLEM_NOT_FOUND,
                             "there is no job of this id: it was removed, or has ended some time "
                             "ago, or the daemon was "
                             "started again; GET /v1/jobs lists those that there are");
    return job;
}

/* --- told ------------------------------------------------------------------------------------- */

static void release_job(void *user)
{
    server_async_release(user);
}

/* A large answer is sent as the job holds it, which is kept meanwhile. */
static struct server_lent lend(struct server_async *job, const struct proto_job_answer *answer,
                               const char *tail)
{
    return (struct server_lent){.bytes = answer->body,
                                .size = answer->size,
                                .tail = tail,
                                .lender = server_async_retain(job),
                                .release = release_job};
}

static void reply_told(struct server_exchange *exchange, unsigned status, struct server_async *job,
                       const struct proto_job *told)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    if (told->answer && told->answer->size >= LENT_FROM && proto_job_encode_head(&writer, told)) {
        const struct server_lent lent = lend(job, told->answer, PROTO_JOB_TAIL);
        server_reply_lent(exchange, status, "application/json", &writer, &lent);
        return;
    }
    proto_job_encode(&writer, told, PROTO_JOB_FULL);
    server_reply_json(exchange, status, &writer);
}

/* What the operation answered, as it did. */
static void reply_answer(struct server_exchange *exchange, struct server_async *job,
                         const struct proto_job_answer *answer)
{
    struct proto_writer writer;
    for (uint32_t i = 0; i < answer->header_count; i++)
        server_reply_header(exchange, answer->headers[i].name, "%s", answer->headers[i].value);
    server_reply_writer(exchange, &writer);
    if (answer->size >= LENT_FROM) {
        const struct server_lent lent = lend(job, answer, "");
        server_reply_lent(exchange, answer->status, answer->media_type, &writer, &lent);
        return;
    }
    proto_append(&writer, answer->body, answer->size);
    server_reply_text(exchange, answer->status, answer->media_type, &writer);
}

void server_handle_get_job(struct server_exchange *exchange)
{
    if (!server_reply_accepts_json(exchange) || !server_request_is_plain(exchange)) return;
    struct server_async *job = find_job(exchange);
    if (!job) return;
    struct proto_job told = server_jobs_look(job);
    reply_told(exchange, 200, job, &told);
    server_async_release(job);
}

void server_handle_get_job_result(struct server_exchange *exchange)
{
    if (!server_request_is_plain(exchange)) return;
    struct server_async *job = find_job(exchange);
    if (!job) return;
    struct proto_job told = server_jobs_look(job);
    if (told.answer)
        reply_answer(exchange, job, told.answer);
    else
        server_reply_refusal(
            exchange, PROTO_PROBLEM_CONFLICT,
            told.state == PROTO_JOB_CANCELLED
                ? "the job was cancelled and has no answer; ask again"
                : "the job has not ended; its events tell when it has, or ask again later");
    server_async_release(job);
}

static void write_page(struct proto_writer *writer, struct server_async *const *jobs,
                       uint32_t count, uint32_t limit)
{
    uint32_t written = count < limit ? count : limit;
    proto_page_begin(writer, "jobs");
    for (uint32_t i = 0; i < written; i++) {
        struct proto_job told = server_jobs_look(jobs[i]);
        proto_job_encode(writer, &told, PROTO_JOB_BRIEF);
    }
    proto_page_end(writer, count > limit ? server_jobs_look(jobs[limit - 1]).id : NULL);
}

/* The jobs on a page, and one more if there is a next page; at most `most`. */
static uint32_t find_listed(struct server_exchange *exchange, const struct proto_page *page,
                            uint32_t most, struct server_async **jobs)
{
    return server_jobs_list(exchange->host->api->jobs, exchange->tenant, page->after,
                            page->limit < most ? page->limit + 1 : most, jobs);
}

static void reply_page(struct server_exchange *exchange, const struct proto_page *page,
                       struct server_async **jobs, uint32_t count)
{
    struct proto_writer writer;
    server_reply_writer(exchange, &writer);
    write_page(&writer, jobs, count, page->limit);
    for (uint32_t i = 0; i < count; i++) server_async_release(jobs[i]);
    server_reply_json(exchange, 200, &writer);
}

static bool list(struct server_exchange *exchange)
{
    struct proto_page page;
    struct server_async *jobs[PROTO_PAGE_MOST + 1];
    if (!server_request_page(exchange, &page)) return true;
    uint32_t count = find_listed(exchange, &page, PROTO_PAGE_MOST + 1, jobs);
    reply_page(exchange, &page, jobs, count);
    return true;
}

void server_handle_list_jobs(struct server_exchange *exchange)
{
    struct proto_page page;
    struct server_async *jobs[SERVER_REQUEST_SHORT_LIST + 1];
    if (!server_reply_accepts_json(exchange) || !server_request_page(exchange, &page)) return;
    uint32_t count = find_listed(exchange, &page, SERVER_REQUEST_SHORT_LIST + 1, jobs);
    if (page.limit <= SERVER_REQUEST_SHORT_LIST || count <= SERVER_REQUEST_SHORT_LIST) {
        reply_page(exchange, &page, jobs, count);
        return;
    }
    for (uint32_t i = 0; i < count; i++) server_async_release(jobs[i]);
    server_request_list(exchange, list);
}

/* --- begun and ended -------------------------------------------------------------------------- */

/* A job that the daemon had no room or time for: its client is told so at once, and there is
 * nothing to come back for. */
static bool was_refused(const struct proto_job *told)
{
    return told->answer && told->answer->status == 503;
}

static void reply_started(struct server_exchange *exchange, struct server_async *job)
{
    struct proto_job told = server_jobs_look(job);
    if (was_refused(&told)) {
        reply_answer(exchange, job, told.answer);
        server_jobs_cancel(exchange->host->api->jobs, job);
        return;
    }
    server_reply_header(exchange, "Location", "/v1/jobs/%s", told.id);
    server_reply_header(exchange, "Preference-Applied", "respond-async");
    reply_told(exchange, 202, job, &told);
}

void server_handle_async(struct server_exchange *exchange)
{
    struct proto_problem problem;
    struct server_async *job = server_jobs_start(exchange->host->api->jobs, exchange, &problem);
    if (job)
        reply_started(exchange, job);
    else
        server_reply_problem(exchange, &problem);
    server_async_release(job);
}

void server_handle_delete_job(struct server_exchange *exchange)
{
    if (!server_request_is_plain(exchange)) return;
    struct server_async *job = find_job(exchange);
    struct proto_problem problem;
    if (!job) return;
    bool may = server_grant_may_change(&exchange->grant, job->key, &problem);
    if (may) server_jobs_cancel(exchange->host->api->jobs, job);
    server_async_release(job);
    if (may)
        server_reply_empty(exchange, 204);
    else
        server_reply_problem(exchange, &problem);
}

/* --- watched ---------------------------------------------------------------------------------- */

/* State and progress in one number. */
static uint64_t event_version(void *user)
{
    struct proto_job told = server_jobs_look(user);
    return (uint64_t)told.state << 32 | (uint64_t)(told.progress * UINT32_MAX);
}

static bool tell_event(void *user, struct proto_writer *writer)
{
    struct proto_job told = server_jobs_look(user);
    proto_job_encode_event(writer, &told);
    return !proto_job_has_ended(told.state);
}

/* The stream has a reference of the job of its own. */
static void reply_events(struct server_exchange *exchange, struct server_async *job)
{
    struct server_host *host = exchange->host;
    const struct server_event_source source = {.version = event_version,
                                               .tell = tell_event,
                                               .release = release_job,
                                               .user = server_async_retain(job)};
    struct server_stream *stream = server_stream_open(host->events, &source);
    if (!stream) {
        server_async_release(job);
        server_request_fail(exchange, SERVER_STORE_NO_MEMORY);
        return;
    }
    host->watch(host->watcher);
    server_reply_stream(exchange, 200, EVENT_STREAM, stream);
}

/* A browser that has seen the end connects again unless it is told that there is no more. */
static bool has_seen_the_end(const struct server_exchange *exchange)
{
    const char *last = server_exchange_header(exchange, "Last-Event-ID");
    return last && strcmp(last, PROTO_JOB_LAST_EVENT) == 0;
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
    struct server_async *job = find_job(exchange);
    if (!job) return;
    if (has_seen_the_end(exchange))
        server_reply_empty(exchange, 204);
    else
        reply_events(exchange, job);
    server_async_release(job);
}
