/* See async.h. */
#include "server/jobs/async.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/jobs/jobs.h"
#include "server/base/log.h"
#include "server/http/reply.h"

/* --- the answer ------------------------------------------------------------------------------- */

static void refuse_answer(struct server_exchange *exchange, size_t bytes)
{
    server_reply_drop_body(exchange);
    server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                         "the answer of %zu bytes is more than can be kept for jobs at this "
                         "moment; ask for less of it, "
                         "ask without Prefer: respond-async, or raise --memory-budget",
                         bytes);
}

/* Nobody looks at the answer before the state says that it is there. */
static void keep_answer(struct server_async *job, struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    size_t bytes = response->owned ? response->size : 0;
    if (server_jobs_reserve(job, bytes) && server_kept_take(&job->kept, response)) return;
    refuse_answer(exchange, bytes);
    (void)server_kept_take(&job->kept, response); /* a refusal has no headers */
}

/* --- the transport ---------------------------------------------------------------------------- */

static struct server_async *job_of(struct server_exchange *exchange)
{
    return (struct server_async *)exchange->transport;
}

static void begin(struct server_exchange *exchange)
{
    server_jobs_begin(job_of(exchange));
}

static void report(struct server_exchange *exchange, double part)
{
    struct server_async *job = job_of(exchange);
    unsigned step =
        part > 0 ? part < 1 ? (unsigned)(part * SERVER_ASYNC_STEPS) : SERVER_ASYNC_STEPS : 0;
    unsigned before = atomic_load_explicit(&job->progress, memory_order_relaxed);
    while (step > before && !atomic_compare_exchange_weak(&job->progress, &before, step)) continue;
}

static bool is_gone(struct server_exchange *exchange)
{
    return atomic_load_explicit(&exchange->job.is_unwanted, memory_order_relaxed);
}

static void log_end(const struct server_async *job, const struct server_exchange *exchange,
                    enum proto_job_state state)
{
    struct server_log_line line;
    bool is_internal = exchange->response.status == 500;
    if (!server_log_begin(&line, is_internal ? SERVER_LOG_ERROR : SERVER_LOG_INFO, "job")) return;
    server_log_text(&line, "job", job->id);
    server_log_text(&line, "state", proto_job_state_name(state));
    server_log_text(&line, "method", exchange->method);
    server_log_text(&line, "path", exchange->path);
    server_log_text(&line, "route", exchange->match.route->path);
    server_log_integer(&line, "status", exchange->response.status);
    server_log_text(&line, "code", server_exchange_code(exchange));
    server_log_text(&line, "key", server_grant_name(&exchange->grant));
    server_log_integer(&line, "bytes", (int64_t)exchange->response.size);
    server_log_milliseconds(&line, "ms", gd_now_ns() - exchange->started_ns);
    server_log_text(&line, "request_id", exchange->request_id);
    server_log_text(&line, "traceparent", server_exchange_header(exchange, "traceparent"));
    server_log_end(&line);
}

/* The exchange is answered: the answer is kept, unless the job was cancelled meanwhile. */
static void finish(struct server_exchange *exchange)
{
    struct server_async *job = job_of(exchange);
    if (server_jobs_look(job).state != PROTO_JOB_CANCELLED) keep_answer(job, exchange);
    log_end(job, exchange, server_jobs_end(job));
    server_exchange_destroy(exchange);
    server_jobs_tell(job);
    server_async_release(job);
}

/* --- life ------------------------------------------------------------------------------------- */

struct server_async *server_async_retain(struct server_async *job)
{
    atomic_fetch_add(&job->references, 1);
    return job;
}

void server_async_release(struct server_async *job)
{
    if (!job || atomic_fetch_sub(&job->references, 1) != 1) return;
    server_jobs_give(job->jobs, job->held);
    server_budget_give(job->budget, SERVER_BUDGET_RECORDS, job->own);
    server_kept_free(&job->kept);
    free(job->request);
    free(job);
}

struct server_async *server_async_create(struct server_jobs *jobs, struct server_exchange *exchange)
{
    struct server_async *job = calloc(1, sizeof *job);
    if (!job) return NULL;
    job->jobs = jobs;
    job->references = 1;
    const char *key = server_grant_name(&exchange->grant);
    snprintf(job->tenant, sizeof job->tenant, "%s", exchange->tenant);
    snprintf(job->key, sizeof job->key, "%s", key ? key : "");
    job->transport = (struct server_transport){
        .finish = finish, .is_gone = is_gone, .begin = begin, .report = report};
    job->budget = exchange->host->budget;
    if (server_budget_take(job->budget, SERVER_BUDGET_RECORDS, sizeof *job + exchange->target_size))
        job->own = sizeof *job + exchange->target_size;
    if (job->own && asprintf(&job->request, "%s %s", exchange->method, exchange->path) < 0)
        job->request = NULL;
    if (job->request) job->exchange = server_exchange_detach(exchange, &job->transport);
    if (job->exchange) job->exchange->job.is_patient = true;
    if (job->exchange) return job;
    server_async_release(job);
    return NULL;
}

void server_async_run(struct server_async *job)
{
    struct server_exchange *exchange = job->exchange;
    server_async_retain(job); /* for the exchange */
    exchange->host->dispatch(exchange);
    if (exchange->response.status)
        exchange->transport->finish(exchange);
    else
        server_exchange_submit(exchange);
}

void server_async_abandon(struct server_async *job)
{
    server_exchange_destroy(job->exchange);
    server_async_release(job);
}
