/* See jobs.h. */
#include "server/jobs/jobs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#include "server/http/events.h"
#include "server/jobs/holdings.h"
#include "server/server.h"
#include "server/work/deadlines.h"

#define RANDOM_DIGITS UINT64_C(0xffffffffffff)
#define SWEEP_NS      UINT64_C(1000000000)
#define ANSWERS_PART  8 /* of the memory budget: what kept answers take at most */

struct server_jobs {
    struct server *server;
    pthread_mutex_t lock;
    struct server_async **list; /* by id */
    uint32_t count, most;
    uint64_t last_serial, swept_ns;
    atomic_size_t held; /* bytes of answers, */
    size_t held_most;   /* and the most of them */
    struct server_holdings holdings;
    uint64_t active; /* jobs that have not ended */
    bool is_draining;
    uint64_t ended[PROTO_JOB_STATE_COUNT];
};

/* --- states ----------------------------------------------------------------------------------- */

struct proto_job server_jobs_look(struct server_async *job)
{
    pthread_mutex_lock(&job->jobs->lock);
    bool is_answered = job->state == PROTO_JOB_DONE || job->state == PROTO_JOB_FAILED;
    struct proto_job told = {.id = job->id,
                             .request = job->request,
                             .state = job->state,
                             .progress = (double)atomic_load(&job->progress) / SERVER_ASYNC_STEPS,
                             .created = job->created,
                             .answer = is_answered ? &job->kept.answer : NULL};
    pthread_mutex_unlock(&job->jobs->lock);
    if (told.state == PROTO_JOB_DONE) told.progress = 1;
    return told;
}

static void end(struct server_async *job, enum proto_job_state state)
{
    job->state = state;
    job->ended_ns = gd_now_ns();
    job->jobs->ended[state]++;
    job->jobs->active--;
    job->holding->active--;
}

void server_jobs_tell(struct server_async *job)
{
    server_events_wake(job->jobs->server->events, job);
}

void server_jobs_begin(struct server_async *job)
{
    pthread_mutex_lock(&job->jobs->lock);
    bool is_new = job->state == PROTO_JOB_QUEUED;
    if (is_new) job->state = PROTO_JOB_RUNNING;
    pthread_mutex_unlock(&job->jobs->lock);
    if (is_new) server_jobs_tell(job);
}

enum proto_job_state server_jobs_end(struct server_async *job)
{
    pthread_mutex_lock(&job->jobs->lock);
    job->exchange = NULL;
    if (job->state != PROTO_JOB_CANCELLED)
        end(job, job->kept.answer.status < 400 ? PROTO_JOB_DONE : PROTO_JOB_FAILED);
    enum proto_job_state state = job->state;
    pthread_mutex_unlock(&job->jobs->lock);
    return state;
}

/* --- the table, under the lock ---------------------------------------------------------------- */

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

/* The job is not in the table any more. */
static void drop(struct server_jobs *jobs, struct server_async *job)
{
    struct server_holding *holding = job->holding;
    job->holding = NULL;
    holding->amounts[SERVER_MEASURE_BYTES] -= job->held;
    if (--holding->amounts[SERVER_MEASURE_JOBS] == 0)
        server_holdings_drop(&jobs->holdings, holding);
    server_async_release(job);
}

static void remove_at(struct server_jobs *jobs, uint32_t place)
{
    struct server_async *job = jobs->list[place];
    jobs->count--;
    memmove(&jobs->list[place], &jobs->list[place + 1], (jobs->count - place) * sizeof *jobs->list);
    drop(jobs, job);
}

/* Drops the oldest ended job of the key that has the most, the newcomer's more included. False:
 * that is the newcomer, and it has none. */
static bool make_way(struct server_jobs *jobs, enum server_measure measure,
                     struct server_holding *newcomer, uint64_t more)
{
    const struct server_holding *largest =
        server_holdings_largest(&jobs->holdings, measure, newcomer, more);
    for (uint32_t i = 0; i < jobs->count; i++) {
        const struct server_async *job = jobs->list[i];
        if (job->holding != largest || !proto_job_has_ended(job->state)) continue;
        if (measure == SERVER_MEASURE_BYTES && !job->held) continue;
        remove_at(jobs, i);
        return true;
    }
    return false;
}

static bool is_expired(const struct server_jobs *jobs, const struct server_async *job,
                       uint64_t now_ns)
{
    uint64_t ttl_ns = jobs->server->config.job_ttl_s * UINT64_C(1000000000);
    return proto_job_has_ended(job->state) &&
           now_ns >= job->ended_ns + ttl_ns; /* a job may end after `now_ns` was read */
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
    snprintf(job->id, sizeof job->id, "%012llx%012llx",
             (unsigned long long)(serial & RANDOM_DIGITS),
             (unsigned long long)(digits & RANDOM_DIGITS));
    job->created = (int64_t)now.tv_sec;
}

/* Tells a tenant no numbers of others. */
static bool refuse_more(const struct server_jobs *jobs, uint64_t own, struct proto_problem *problem)
{
    bool is_shared = jobs->server->access != NULL;
    (void)proto_problem_set(
        problem, PROTO_PROBLEM_OVERLOADED,
        "%llu jobs%s have not ended yet, and no more are taken; try again in a moment",
        (unsigned long long)(is_shared ? own : jobs->active), is_shared ? " of yours" : "");
    problem->retry_after = 1;
    return false;
}

/* Is there a place for one more job of the holding, which counts it already? */
static bool has_place(struct server_jobs *jobs, struct server_holding *holding,
                      struct proto_problem *problem)
{
    uint64_t own = server_holdings_active(&jobs->holdings, holding->tenant),
             others = jobs->active - own;
    bool has_share = !jobs->server->access || !own || 2 * own + others < jobs->most;
    if (has_share && (jobs->count < jobs->most || make_way(jobs, SERVER_MEASURE_JOBS, holding, 0)))
        return true;
    return refuse_more(jobs, own, problem);
}

static void insert(struct server_jobs *jobs, struct server_holding *holding,
                   struct server_async *job)
{
    name(jobs, job);
    job->holding = holding;
    holding->active++;
    jobs->active++;
    jobs->list[jobs->count++] = server_async_retain(job);
}

static bool add(struct server_jobs *jobs, struct server_async *job, struct proto_problem *problem)
{
    if (jobs->is_draining) return proto_problem_from_status(problem, GD_CANCELLED, NULL);
    struct server_holding *holding = server_holdings_of(&jobs->holdings, job->tenant, job->key);
    if (!holding) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    holding->amounts[SERVER_MEASURE_JOBS]++;
    bool has_room = has_place(jobs, holding, problem);
    if (has_room)
        insert(jobs, holding, job);
    else if (--holding->amounts[SERVER_MEASURE_JOBS] == 0)
        server_holdings_drop(&jobs->holdings, holding);
    return has_room;
}

/* --- memory of the answers -------------------------------------------------------------------- */

/* Under the lock: counts the bytes as held by the job. A job that is not in the table any more
 * is nobody's. */
static void count_held(struct server_async *job, size_t bytes)
{
    if (job->holding) job->holding->amounts[SERVER_MEASURE_BYTES] += bytes - job->held;
    job->held = bytes;
}

static bool make_room(struct server_async *job, size_t bytes)
{
    struct server_jobs *jobs = job->jobs;
    if (bytes > jobs->held_most || !job->holding) return false;
    while (atomic_load(&jobs->held) + bytes > jobs->held_most)
        if (!make_way(jobs, SERVER_MEASURE_BYTES, job->holding, bytes)) return false;
    return true;
}

bool server_jobs_reserve(struct server_async *job, size_t bytes)
{
    struct server_jobs *jobs = job->jobs;
    pthread_mutex_lock(&jobs->lock);
    bool fits = make_room(job, bytes);
    if (fits) {
        atomic_fetch_add(&jobs->held, bytes);
        count_held(job, bytes);
    }
    pthread_mutex_unlock(&jobs->lock);
    if (!fits || server_budget_take(&jobs->server->budget, SERVER_BUDGET_JOBS, bytes)) return fits;
    atomic_fetch_sub(&jobs->held, bytes);
    pthread_mutex_lock(&jobs->lock);
    count_held(job, 0);
    pthread_mutex_unlock(&jobs->lock);
    return false;
}

void server_jobs_give(struct server_jobs *jobs, size_t bytes)
{
    server_budget_give(&jobs->server->budget, SERVER_BUDGET_JOBS, bytes);
    atomic_fetch_sub(&jobs->held, bytes);
}

/* --- in --------------------------------------------------------------------------------------- */

struct server_async *server_jobs_start(struct server_jobs *jobs, struct server_exchange *exchange,
                                       struct proto_problem *problem)
{
    struct server_async *job = server_async_create(jobs, exchange);
    if (!job) {
        (void)proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
        return NULL;
    }
    pthread_mutex_lock(&jobs->lock);
    bool is_added = add(jobs, job, problem);
    pthread_mutex_unlock(&jobs->lock);
    if (!is_added) {
        server_async_abandon(job);
        return NULL;
    }
    server_async_run(job);
    server_timekeeper_wake(jobs->server->timekeeper);
    return job;
}

/* --- found, ended, dropped -------------------------------------------------------------------- */

/* Under the lock: may the tenant know of the job? */
static bool is_known(const struct server_jobs *jobs, const struct server_async *job,
                     const char *tenant, uint64_t now_ns)
{
    return strcmp(job->tenant, tenant) == 0 && !is_expired(jobs, job, now_ns);
}

struct server_async *server_jobs_find(struct server_jobs *jobs, const char *tenant, const char *id,
                                      size_t size)
{
    char text[SERVER_ASYNC_ID];
    if (size != SERVER_ASYNC_ID - 1) return NULL;
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

uint32_t server_jobs_list(struct server_jobs *jobs, const char *tenant, const char *after,
                          uint32_t most, struct server_async **out)
{
    uint32_t count = 0;
    uint64_t now = gd_now_ns();
    pthread_mutex_lock(&jobs->lock);
    uint32_t place = after ? place_of(jobs, after) : 0;
    if (after && place < jobs->count && strcmp(jobs->list[place]->id, after) == 0) place++;
    for (; place < jobs->count && count < most; place++)
        if (is_known(jobs, jobs->list[place], tenant, now))
            out[count++] = server_async_retain(jobs->list[place]);
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
    if (!is_over) server_jobs_tell(job);
}

void server_jobs_sweep(struct server_jobs *jobs, uint64_t now_ns)
{
    if (!jobs) return;
    pthread_mutex_lock(&jobs->lock);
    uint32_t kept = 0, count = now_ns - jobs->swept_ns >= SWEEP_NS ? jobs->count : 0;
    for (uint32_t i = 0; i < count; i++) {
        if (is_expired(jobs, jobs->list[i], now_ns))
            drop(jobs, jobs->list[i]);
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
        if (jobs->list[i]->state == PROTO_JOB_QUEUED)
            atomic_store(&jobs->list[i]->exchange->job.is_unwanted, true);
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

struct server_jobs_statistics server_jobs_statistics(struct server_jobs *jobs, const char *tenant)
{
    struct server_jobs_statistics statistics = {0};
    if (!jobs) return statistics;
    pthread_mutex_lock(&jobs->lock);
    for (uint32_t i = 0; i < jobs->count; i++)
        if (!tenant || strcmp(jobs->list[i]->tenant, tenant) == 0)
            statistics.now[jobs->list[i]->state]++;
    if (!tenant) memcpy(statistics.ended, jobs->ended, sizeof statistics.ended);
    pthread_mutex_unlock(&jobs->lock);
    return statistics;
}

/* --- life ------------------------------------------------------------------------------------- */

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
    for (uint32_t i = 0; i < jobs->count; i++) drop(jobs, jobs->list[i]);
    pthread_mutex_destroy(&jobs->lock);
    free(jobs->list);
    free(jobs);
}
