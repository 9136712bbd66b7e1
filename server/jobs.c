/* See jobs.h. */
#include "server/jobs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#include "server/events.h"
#include "server/kept.h"
#include "server/key.h"
#include "server/log.h"
#include "server/reply.h"
#include "server/router.h"
#include "server/server.h"
#include "server/timekeeper.h"

#define ID             25 /* 12 digits that grow, 12 that can't be guessed, NUL */
#define RANDOM_DIGITS  UINT64_C(0xffffffffffff)
#define PROGRESS_STEPS 1000000
#define SWEEP_NS       UINT64_C(1000000000)
#define ANSWERS_PART   8 /* of the memory budget: what kept answers take at most */

struct server_async {
    struct server_transport transport; /* first: an exchange finds its job by it */
    struct server_jobs *jobs;
    atomic_uint references;
    char id[ID];
    char tenant[SERVER_TENANT + 1]; /* whose it is (key.h) */
    char *request;
    int64_t created;
    atomic_uint progress; /* in PROGRESS_STEPS; only grows */
    /* under the lock: */
    enum proto_job_state state;
    struct server_exchange *exchange; /* not answered yet; NULL: it is */
    uint64_t ended_ns;
    /* unchanged once the state is DONE or FAILED: */
    struct server_kept kept;
    size_t held; /* bytes of SERVER_BUDGET_JOBS that are counted for it */
};

struct server_jobs {
    struct server *server;
    pthread_mutex_t lock;
    struct server_async **list; /* by id */
    uint32_t count, most;
    uint64_t last_serial, swept_ns;
    atomic_size_t held; /* bytes of answers, */
    size_t held_most;   /* and the most of them */
    bool is_draining;
    uint64_t ended[PROTO_JOB_STATE_COUNT];
};

/* --- one job ------------------------------------------------------------------------------------------------------ */

struct server_async *server_async_retain(struct server_async *job)
{
    atomic_fetch_add(&job->references, 1);
    return job;
}

/* Takes no lock: so it may be called under one. */
void server_async_release(struct server_async *job)
{
    if (!job || atomic_fetch_sub(&job->references, 1) != 1) return;
    server_budget_give(&job->jobs->server->budget, SERVER_BUDGET_JOBS, job->held);
    atomic_fetch_sub(&job->jobs->held, job->held);
    server_kept_free(&job->kept);
    free(job->request);
    free(job);
}

struct proto_job server_async_look(struct server_async *job)
{
    pthread_mutex_lock(&job->jobs->lock);
    bool is_answered = job->state == PROTO_JOB_DONE || job->state == PROTO_JOB_FAILED;
    struct proto_job told = {.id = job->id,
                             .request = job->request,
                             .state = job->state,
                             .progress = (double)atomic_load(&job->progress) / PROGRESS_STEPS,
                             .created = job->created,
                             .answer = is_answered ? &job->kept.answer : NULL};
    pthread_mutex_unlock(&job->jobs->lock);
    if (told.state == PROTO_JOB_DONE) told.progress = 1;
    return told;
}

/* --- the table, under the lock ------------------------------------------------------------------------------------ */

/* The place of the first job whose id is not below `id`. */
static uint32_t place_of(const struct server_jobs *jobs, const char *id)
{
    uint32_t low = 0, high = jobs->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(jobs->list[middle]->id, id) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void remove_at(struct server_jobs *jobs, uint32_t place)
{
    struct server_async *job = jobs->list[place];
    jobs->count--;
    memmove(&jobs->list[place], &jobs->list[place + 1], (jobs->count - place) * sizeof *jobs->list);
    server_async_release(job);
}

/* False: none has ended. */
static bool drop_oldest(struct server_jobs *jobs)
{
    for (uint32_t i = 0; i < jobs->count; i++) {
        if (!proto_job_has_ended(jobs->list[i]->state)) continue;
        remove_at(jobs, i);
        return true;
    }
    return false;
}

static bool is_expired(const struct server_jobs *jobs, const struct server_async *job, uint64_t now_ns)
{
    uint64_t ttl_ns = jobs->server->config.job_ttl_s * UINT64_C(1000000000);
    return proto_job_has_ended(job->state) &&
           now_ns >= job->ended_ns + ttl_ns; /* a job may end after `now_ns` was read */
}

static void end(struct server_async *job, enum proto_job_state state)
{
    job->state = state;
    job->ended_ns = gd_now_ns();
    job->jobs->ended[state]++;
}

/* An id above all others, in the order of time as far as the clock goes forward. */
static void name(struct server_jobs *jobs, struct server_async *job)
{
    struct timespec now;
    uint64_t digits = 0;
    clock_gettime(CLOCK_REALTIME, &now);
    uint64_t serial = (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
    if (serial <= jobs->last_serial) serial = jobs->last_serial + 1;
    jobs->last_serial = serial;
    if (getrandom(&digits, sizeof digits, 0) < 0) digits = gd_now_ns();
    snprintf(job->id, sizeof job->id, "%012llx%012llx", (unsigned long long)(serial & RANDOM_DIGITS),
             (unsigned long long)(digits & RANDOM_DIGITS));
    job->created = (int64_t)now.tv_sec;
}

static bool add(struct server_jobs *jobs, struct server_async *job, struct proto_problem *problem)
{
    if (jobs->is_draining) return proto_problem_from_status(problem, GD_CANCELLED, NULL);
    if (jobs->count == jobs->most && !drop_oldest(jobs)) {
        (void)proto_problem_set(problem, PROTO_PROBLEM_OVERLOADED,
                                "%u jobs have not ended yet, and no more are taken; try again in a moment", jobs->most);
        problem->retry_after = 1;
        return false;
    }
    name(jobs, job);
    jobs->list[jobs->count++] = server_async_retain(job);
    return true;
}

/* --- the answer --------------------------------------------------------------------------------------------------- */

/* Makes room for an answer of `bytes`. */
static bool reserve(struct server_jobs *jobs, size_t bytes)
{
    struct server_budget *budget = &jobs->server->budget;
    pthread_mutex_lock(&jobs->lock);
    bool fits = true;
    while (fits && atomic_load(&jobs->held) + bytes > jobs->held_most) fits = drop_oldest(jobs);
    if (fits) atomic_fetch_add(&jobs->held, bytes);
    pthread_mutex_unlock(&jobs->lock);
    if (!fits || server_budget_take(budget, SERVER_BUDGET_JOBS, bytes)) return fits;
    atomic_fetch_sub(&jobs->held, bytes);
    return false;
}

static void refuse_answer(struct server_exchange *exchange, size_t bytes)
{
    struct server_response *response = &exchange->response;
    free(response->owned);
    response->owned = NULL;
    server_reply_refusal(
        exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
        "the answer of %zu bytes is more than can be kept for jobs at this moment; ask for less of it, "
        "ask without Prefer: respond-async, or raise --memory-budget",
        bytes);
}

/* Nobody looks at the answer before the state says that it is there. */
static void keep_answer(struct server_async *job, struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    size_t bytes = response->owned ? response->size : 0;
    bool has_room = reserve(job->jobs, bytes);
    if (has_room) job->held = bytes;
    if (has_room && server_kept_take(&job->kept, response)) return;
    refuse_answer(exchange, bytes);
    (void)server_kept_take(&job->kept, response); /* a refusal has no headers */
}

/* --- the transport ------------------------------------------------------------------------------------------------ */

static struct server_async *job_of(struct server_exchange *exchange)
{
    return (struct server_async *)exchange->transport;
}

static void begin(struct server_exchange *exchange)
{
    struct server_async *job = job_of(exchange);
    pthread_mutex_lock(&job->jobs->lock);
    bool is_new = job->state == PROTO_JOB_QUEUED;
    if (is_new) job->state = PROTO_JOB_RUNNING;
    pthread_mutex_unlock(&job->jobs->lock);
    if (is_new) server_events_wake(job->jobs->server->events, job);
}

static void report(struct server_exchange *exchange, double part)
{
    struct server_async *job = job_of(exchange);
    unsigned step = part > 0 ? part < 1 ? (unsigned)(part * PROGRESS_STEPS) : PROGRESS_STEPS : 0;
    unsigned before = atomic_load_explicit(&job->progress, memory_order_relaxed);
    while (step > before && !atomic_compare_exchange_weak(&job->progress, &before, step)) continue;
}

static bool is_gone(struct server_exchange *exchange)
{
    return atomic_load_explicit(&exchange->job.is_unwanted, memory_order_relaxed);
}

static void log_end(const struct server_async *job, const struct server_exchange *exchange, enum proto_job_state state)
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

static bool is_cancelled(struct server_async *job)
{
    return server_async_look(job).state == PROTO_JOB_CANCELLED;
}

/* The exchange is answered: the answer is kept, unless the job was cancelled meanwhile. */
static void finish(struct server_exchange *exchange)
{
    struct server_async *job = job_of(exchange);
    struct server_jobs *jobs = job->jobs;
    if (!is_cancelled(job)) keep_answer(job, exchange);
    pthread_mutex_lock(&jobs->lock);
    job->exchange = NULL;
    if (job->state != PROTO_JOB_CANCELLED) end(job, job->kept.answer.status < 400 ? PROTO_JOB_DONE : PROTO_JOB_FAILED);
    enum proto_job_state state = job->state;
    pthread_mutex_unlock(&jobs->lock);
    log_end(job, exchange, state);
    server_exchange_destroy(exchange);
    server_events_wake(jobs->server->events, job);
    server_async_release(job);
}

/* --- in ----------------------------------------------------------------------------------------------------------- */

static struct server_async *create(struct server_jobs *jobs, struct server_exchange *exchange)
{
    struct server_async *job = calloc(1, sizeof *job);
    if (!job) return NULL;
    job->jobs = jobs;
    job->references = 1;
    snprintf(job->tenant, sizeof job->tenant, "%s", exchange->tenant);
    job->transport = (struct server_transport){.finish = finish, .is_gone = is_gone, .begin = begin, .report = report};
    if (asprintf(&job->request, "%s %s", exchange->method, exchange->path) < 0) job->request = NULL;
    if (job->request) job->exchange = server_exchange_detach(exchange, &job->transport);
    if (job->exchange) return job;
    server_async_release(job);
    return NULL;
}

/* As a connection does it; the exchange has a reference of the job. */
static void run(struct server_exchange *exchange)
{
    server_router_dispatch(exchange);
    if (exchange->response.status)
        exchange->transport->finish(exchange);
    else
        server_exchange_submit(exchange);
}

struct server_async *server_jobs_start(struct server_jobs *jobs, struct server_exchange *exchange,
                                       struct proto_problem *problem)
{
    struct server_async *job = create(jobs, exchange);
    if (!job) {
        (void)proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
        return NULL;
    }
    struct server_exchange *own = job->exchange;
    pthread_mutex_lock(&jobs->lock);
    bool is_added = add(jobs, job, problem);
    pthread_mutex_unlock(&jobs->lock);
    if (is_added) {
        server_async_retain(job);
        run(own);
        server_timekeeper_wake(jobs->server->timekeeper);
        return job;
    }
    server_exchange_destroy(own);
    server_async_release(job);
    return NULL;
}

/* --- found, ended, dropped ---------------------------------------------------------------------------------------- */

/* Under the lock: may the tenant know of the job? */
static bool is_known(const struct server_jobs *jobs, const struct server_async *job, const char *tenant,
                     uint64_t now_ns)
{
    return strcmp(job->tenant, tenant) == 0 && !is_expired(jobs, job, now_ns);
}

struct server_async *server_jobs_find(struct server_jobs *jobs, const char *tenant, const char *id, size_t size)
{
    char text[ID];
    if (size != ID - 1) return NULL;
    memcpy(text, id, size);
    text[size] = '\0';
    pthread_mutex_lock(&jobs->lock);
    uint32_t place = place_of(jobs, text);
    struct server_async *job = place < jobs->count ? jobs->list[place] : NULL;
    bool is_found = job && strcmp(job->id, text) == 0 && is_known(jobs, job, tenant, gd_now_ns());
    if (is_found) server_async_retain(job);
    pthread_mutex_unlock(&jobs->lock);
    return is_found ? job : NULL;
}

uint32_t server_jobs_list(struct server_jobs *jobs, const char *tenant, const char *after, uint32_t most,
                          struct server_async **out)
{
    uint32_t count = 0;
    uint64_t now = gd_now_ns();
    pthread_mutex_lock(&jobs->lock);
    uint32_t place = after ? place_of(jobs, after) : 0;
    if (after && place < jobs->count && strcmp(jobs->list[place]->id, after) == 0) place++;
    for (; place < jobs->count && count < most; place++)
        if (is_known(jobs, jobs->list[place], tenant, now)) out[count++] = server_async_retain(jobs->list[place]);
    pthread_mutex_unlock(&jobs->lock);
    return count;
}

void server_jobs_cancel(struct server_jobs *jobs, struct server_async *job)
{
    pthread_mutex_lock(&jobs->lock);
    bool is_over = proto_job_has_ended(job->state);
    uint32_t place = place_of(jobs, job->id);
    if (!is_over) {
        end(job, PROTO_JOB_CANCELLED);
        atomic_store(&job->exchange->job.is_unwanted, true);
    } else if (place < jobs->count && jobs->list[place] == job) {
        remove_at(jobs, place);
    }
    pthread_mutex_unlock(&jobs->lock);
    if (!is_over) server_events_wake(jobs->server->events, job);
}

void server_jobs_sweep(struct server_jobs *jobs, uint64_t now_ns)
{
    if (!jobs) return;
    pthread_mutex_lock(&jobs->lock);
    uint32_t kept = 0, count = now_ns - jobs->swept_ns >= SWEEP_NS ? jobs->count : 0;
    for (uint32_t i = 0; i < count; i++) {
        if (is_expired(jobs, jobs->list[i], now_ns))
            server_async_release(jobs->list[i]);
        else
            jobs->list[kept++] = jobs->list[i];
    }
    if (count) {
        jobs->count = kept;
        jobs->swept_ns = now_ns;
    }
    pthread_mutex_unlock(&jobs->lock);
}

void server_jobs_drain(struct server_jobs *jobs)
{
    pthread_mutex_lock(&jobs->lock);
    jobs->is_draining = true;
    for (uint32_t i = 0; i < jobs->count; i++)
        if (jobs->list[i]->state == PROTO_JOB_QUEUED) atomic_store(&jobs->list[i]->exchange->job.is_unwanted, true);
    pthread_mutex_unlock(&jobs->lock);
}

bool server_jobs_is_empty(struct server_jobs *jobs)
{
    if (!jobs) return true;
    pthread_mutex_lock(&jobs->lock);
    bool is_empty = jobs->count == 0;
    pthread_mutex_unlock(&jobs->lock);
    return is_empty;
}

struct server_jobs_statistics server_jobs_statistics(struct server_jobs *jobs)
{
    struct server_jobs_statistics statistics = {0};
    if (!jobs) return statistics;
    pthread_mutex_lock(&jobs->lock);
    for (uint32_t i = 0; i < jobs->count; i++) statistics.now[jobs->list[i]->state]++;
    memcpy(statistics.ended, jobs->ended, sizeof statistics.ended);
    pthread_mutex_unlock(&jobs->lock);
    return statistics;
}

/* --- life --------------------------------------------------------------------------------------------------------- */

struct server_jobs *server_jobs_create(struct server *server)
{
    struct server_jobs *jobs = calloc(1, sizeof *jobs);
    if (!jobs) return NULL;
    jobs->server = server;
    jobs->most = (uint32_t)server->config.max_jobs;
    jobs->held_most = server->budget.limit / ANSWERS_PART;
    jobs->list = calloc(jobs->most, sizeof *jobs->list);
    pthread_mutex_init(&jobs->lock, NULL);
    if (jobs->list) return jobs;
    server_jobs_destroy(jobs);
    return NULL;
}

void server_jobs_destroy(struct server_jobs *jobs)
{
    if (!jobs) return;
    for (uint32_t i = 0; i < jobs->count; i++) server_async_release(jobs->list[i]);
    pthread_mutex_destroy(&jobs->lock);
    free(jobs->list);
    free(jobs);
}
