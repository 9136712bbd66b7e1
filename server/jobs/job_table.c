#include "server/jobs/job_table.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

#include "server/base/log.h"
#include "server/base/sorted.h"
#include "server/base/thread.h"
#include "server/exchange/events.h"
#include "server/exchange/reply.h"
#include "server/store/kind.h"

#define EXPIRE_NS      UINT64_C(1000000000)
#define PROGRESS_STEPS 1000000

enum unit { UNIT_JOBS, UNIT_BYTES, UNITS }; /* UNIT_BYTES counts the bytes of answers */

/* A key's share of the table. When the table is full, jobs of the largest user are dropped. Tenants
 * are compared first, then the keys of a tenant, so that a tenant gains nothing by many keys. */
struct usage {
    struct usage *next;                                               /* sorted by tenant */
    char tenant[SERVER_CREDENTIAL_NAME], key[SERVER_CREDENTIAL_NAME]; /* "" without keys */
    uint64_t amounts[UNITS];
    uint64_t active; /* number of jobs that have not ended */
};

struct server_job_table {
    struct server_host *host;
    struct server_job_limits limits;
    pthread_mutex_t lock;
    struct server_sorted list; /* jobs by id, with room for limits.jobs */
    uint64_t expired_ns;
    size_t held; /* bytes of the answers of jobs in the list */
    struct usage *usages;
    bool is_draining;
    uint64_t ended[PROTO_JOB_STATE_COUNT];
};

struct server_deferred_job {
    /* must be the first member: exchange_job casts it to the job */
    struct server_transport transport;
    struct server_job_table *table;
    atomic_uint references;
    char id[SERVER_JOB_ID], tenant[SERVER_TENANT + 1], key[SERVER_CREDENTIAL_NAME];
    char *request; /* "POST /v1/…" */
    int64_t created;
    atomic_uint progress; /* in PROGRESS_STEPS; never decreases */
    struct server_share *share;
    size_t own; /* bytes of SERVER_BUDGET_RECORDS that are counted for this struct */
    /* guarded by the table's lock: */
    enum proto_job_state state;
    struct server_exchange *exchange; /* NULL means that the exchange is answered */
    uint64_t ended_ns;
    struct usage *usage; /* NULL means that the job is not in the table */
    size_t held;         /* bytes that are counted for the answer: */
    bool is_adopted;     /* in the tenant's share, else in SERVER_BUDGET_JOBS */
    /* Written before the state becomes DONE or FAILED, then constant: */
    struct proto_job_answer answer;
    struct proto_job_header headers[SERVER_RESPONSE_HEADERS];
    char *header_values;
    void *body; /* NULL means that the answer's body is static, or there is none */
};

/* --- references ------------------------------------------------------------------------------- */

int64_t server_job_id_create(char id[SERVER_JOB_ID])
{
    static atomic_uint_least64_t last_serial;
    const uint64_t digits = UINT64_C(0xffffffffffff);
    struct timespec now;
    uint64_t number = 0, serial, last = atomic_load(&last_serial);
    clock_gettime(CLOCK_REALTIME, &now);
    uint64_t now_ms = (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
    do serial = now_ms > last ? now_ms : last + 1;
    while (!atomic_compare_exchange_weak(&last_serial, &last, serial));
    if (getrandom(&number, sizeof number, 0) < 0) number = (uint64_t)now.tv_nsec;
    snprintf(id, SERVER_JOB_ID, "%012llx%012llx", (unsigned long long)(serial & digits),
             (unsigned long long)(number & digits));
    return now.tv_sec;
}

struct server_deferred_job *server_deferred_job_retain(struct server_deferred_job *job)
{
    atomic_fetch_add(&job->references, 1);
    return job;
}

void server_deferred_job_release(struct server_deferred_job *job)
{
    if (!job || atomic_fetch_sub(&job->references, 1) != 1) return;
    if (job->is_adopted)
        server_share_give_answer(job->share, job->held);
    else
        server_budget_give(job->table->host->budget, SERVER_BUDGET_JOBS, job->held);
    server_budget_give(job->table->host->budget, SERVER_BUDGET_RECORDS, job->own);
    free(job->body);
    free(job->header_values);
    free(job->request);
    free(job);
}

/* --- states ----------------------------------------------------------------------------------- */

struct proto_job server_deferred_job_describe(struct server_deferred_job *job)
{
    pthread_mutex_lock(&job->table->lock);
    bool is_answered = job->state == PROTO_JOB_DONE || job->state == PROTO_JOB_FAILED;
    struct proto_job out = {.id = job->id,
                            .request = job->request,
                            .state = job->state,
                            .progress = (double)atomic_load(&job->progress) / PROGRESS_STEPS,
                            .created = job->created,
                            .answer = is_answered ? &job->answer : NULL};
    pthread_mutex_unlock(&job->table->lock);
    if (out.state == PROTO_JOB_DONE) out.progress = 1;
    return out;
}

const char *server_deferred_job_key(const struct server_deferred_job *job)
{
    return job->key;
}

/* Ends a job, under the lock. */
static void job_end(struct server_deferred_job *job, enum proto_job_state state)
{
    job->state = state;
    job->ended_ns = gd_now_ns();
    job->table->ended[state]++;
    job->usage->active--;
}

static void job_notify(struct server_deferred_job *job)
{
    server_events_wake(job->table->host->events, job);
}

/* Call this function without the lock, after the state has changed under the lock. It wakes every
 * waiting request, because a request checks the state and parks under the same lock. */
static void job_notify_end(struct server_deferred_job *job)
{
    job_notify(job);
    server_workers_unpark(job->table->host->waiters, job);
}

bool server_deferred_job_wait(struct server_deferred_job *job, struct server_job *waiting,
                              uint64_t until_ns)
{
    struct server_job_table *table = job->table;
    SERVER_LOCK(&table->lock);
    return !proto_job_has_ended(job->state) && !table->is_draining &&
           server_workers_park(table->host->waiters, waiting, job, until_ns);
}

/* --- the table, under the lock ---------------------------------------------------------------- */

static int job_compare(const void *job, const void *id)
{
    return strcmp(((const struct server_deferred_job *)job)->id, id);
}

/* Returns the usage of a key, and adds it to the list if it is new. Returns NULL if out of
 * memory. */
static struct usage *usage_of(struct usage **list, const char *tenant, const char *key)
{
    int order;
    for (; *list && (order = strcmp((*list)->tenant, tenant)) <= 0; list = &(*list)->next)
        if (order == 0 && strcmp((*list)->key, key) == 0) return *list;
    struct usage *usage = calloc(1, sizeof *usage);
    if (!usage) return NULL;
    snprintf(usage->tenant, sizeof usage->tenant, "%s", tenant);
    snprintf(usage->key, sizeof usage->key, "%s", key);
    usage->next = *list;
    *list = usage;
    return usage;
}

/* Subtracts one job, and frees the usage if it has no more jobs. */
static void usage_drop_job(struct usage **list, struct usage *usage)
{
    if (--usage->amounts[UNIT_JOBS]) return;
    while (*list != usage) list = &(*list)->next;
    *list = usage->next;
    free(usage);
}

/* The key `newcomer` needs room for `more` jobs or bytes, which already count as its own. Returns
 * the largest key of the largest tenant, which must drop an ended job. Ignores keys without ended
 * jobs, except the newcomer. */
static struct usage *usage_largest(struct usage *list, enum unit unit, const struct usage *newcomer,
                                   uint64_t more)
{
    struct usage *largest = NULL;
    uint64_t largest_total = 0;
    for (struct usage *at = list, *first = list; at; first = at) {
        struct usage *best = NULL; /* the largest key of this tenant */
        uint64_t best_amount = 0, total = 0;
        for (; at && strcmp(at->tenant, first->tenant) == 0; at = at->next) {
            uint64_t amount = at->amounts[unit] + (at == newcomer ? more : 0);
            uint64_t fixed = unit == UNIT_JOBS ? at->active : 0;
            total += amount;
            if (at != newcomer && at->amounts[unit] <= fixed) continue;
            if (best && amount <= best_amount) continue;
            best = at;
            best_amount = amount;
        }
        if (!best || (largest && total <= largest_total)) continue;
        largest = best;
        largest_total = total;
    }
    return largest;
}

/* Releases a job that was removed from the list. Clients may still read its answer for hours. From
 * now on the answer counts as unread, so that it takes no room from the answers of other jobs. */
static void table_drop(struct server_job_table *table, struct server_deferred_job *job)
{
    table->held -= job->held;
    job->usage->amounts[UNIT_BYTES] -= job->held;
    job->is_adopted = job->state == PROTO_JOB_DONE || job->state == PROTO_JOB_FAILED;
    if (job->is_adopted) server_share_adopt_job(job->share, job->held);
    usage_drop_job(&table->usages, job->usage);
    job->usage = NULL;
    server_deferred_job_release(job);
}

/* Drops the oldest ended job of the largest user. `more` is added to the newcomer's usage, so the
 * newcomer itself may be the largest user. Returns false if the largest user has no ended job. */
static bool table_evict(struct server_job_table *table, enum unit unit,
                        const struct usage *newcomer, uint64_t more)
{
    const struct usage *largest = usage_largest(table->usages, unit, newcomer, more);
    for (uint32_t i = 0; i < table->list.count; i++) {
        struct server_deferred_job *job = table->list.items[i];
        if (job->usage != largest || !proto_job_has_ended(job->state)) continue;
        if (unit == UNIT_BYTES && !job->held) continue;
        table_drop(table, server_sorted_remove(&table->list, i));
        return true;
    }
    return false;
}

static bool job_is_expired(const struct server_deferred_job *job, uint64_t now_ns)
{
    uint64_t ttl_ns = job->table->limits.ttl_s * UINT64_C(1000000000);
    return proto_job_has_ended(job->state) &&
           now_ns >= job->ended_ns + ttl_ns; /* a job may end after `now_ns` was read */
}

/* Makes room for one more job, which the usage already counts. The problem contains no numbers of
 * other tenants. */
static bool table_admit(struct server_job_table *table, const struct usage *usage,
                        struct proto_problem *problem)
{
    const struct server_job_limits *limits = &table->limits;
    uint64_t own = 0, active = 0;
    for (const struct usage *at = table->usages; at; at = at->next) {
        active += at->active;
        if (strcmp(at->tenant, usage->tenant) == 0) own += at->active;
    }
    bool has_share = !limits->are_tenanted || !own || own + active < limits->jobs;
    if (has_share && (table->list.count < limits->jobs || table_evict(table, UNIT_JOBS, usage, 0)))
        return true;
    (void)proto_problem_set(
        problem, PROTO_PROBLEM_OVERLOADED,
        "%llu jobs%s have not ended yet, and no more are accepted; try again in a moment",
        (unsigned long long)(limits->are_tenanted ? own : active),
        limits->are_tenanted ? " of yours" : "");
    problem->retry_after = 1;
    return false;
}

static bool table_add(struct server_job_table *table, struct server_deferred_job *job,
                      struct proto_problem *problem)
{
    if (table->is_draining) return proto_problem_from_status(problem, GD_CANCELLED, NULL);
    struct usage *usage = usage_of(&table->usages, job->tenant, job->key);
    if (!usage) return proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    usage->amounts[UNIT_JOBS]++;
    if (!table_admit(table, usage, problem)) {
        usage_drop_job(&table->usages, usage);
        return false;
    }
    job->created = server_job_id_create(job->id);
    job->usage = usage;
    usage->active++;
    server_sorted_insert(&table->list, table->list.count, server_deferred_job_retain(job));
    return true;
}

/* --- answers ---------------------------------------------------------------------------------- */

/* Counts bytes of an answer, under the lock. A job that left the table has no usage. */
static void answer_count(struct server_deferred_job *job, size_t bytes)
{
    if (job->usage) {
        job->usage->amounts[UNIT_BYTES] += bytes - job->held;
        job->table->held += bytes - job->held;
    }
    job->held = bytes;
}

/* Drops ended jobs until the bytes of the job's answer fit, and counts these bytes. Returns false
 * if there is no room. */
static bool answer_reserve(struct server_deferred_job *job, size_t bytes)
{
    struct server_job_table *table = job->table;
    pthread_mutex_lock(&table->lock);
    bool fits = bytes <= table->limits.answer_bytes && job->usage;
    while (fits && table->held + bytes > table->limits.answer_bytes)
        fits = table_evict(table, UNIT_BYTES, job->usage, bytes);
    if (fits) answer_count(job, bytes);
    pthread_mutex_unlock(&table->lock);
    if (!fits || server_budget_take(table->host->budget, SERVER_BUDGET_JOBS, bytes)) return fits;
    pthread_mutex_lock(&table->lock);
    answer_count(job, 0);
    pthread_mutex_unlock(&table->lock);
    return false;
}

/* Moves body and headers from the response to the job. If memory is short, returns false and moves
 * nothing. The call cannot fail if the response has no headers. */
static bool answer_take(struct server_deferred_job *job, struct server_response *response)
{
    size_t size = 0;
    uint32_t count = response->header_count;
    for (uint32_t i = 0; i < count; i++) size += strlen(response->headers[i].value) + 1;
    char *at = job->header_values = count ? malloc(size) : NULL;
    if (count && !at) return false;
    job->answer = (struct proto_job_answer){.status = response->status,
                                            .media_type = response->media_type,
                                            .body = response->body,
                                            .size = response->body ? response->size : 0,
                                            .headers = job->headers};
    for (uint32_t i = 0; i < count; i++) {
        const struct server_response_header *header = &response->headers[i];
        if (strcmp(header->name, "Vary") == 0) continue; /* a saved answer has only one form */
        job->headers[job->answer.header_count++] = (struct proto_job_header){header->name, at};
        at = stpcpy(at, header->value) + 1;
    }
    job->body = response->owned;
    response->owned = NULL;
    return true;
}

static void answer_save(struct server_deferred_job *job, struct server_exchange *exchange)
{
    struct server_response *response = &exchange->response;
    size_t bytes = response->owned ? response->size : 0;
    if (answer_reserve(job, bytes) && answer_take(job, response)) return;
    server_exchange_drop_body(exchange);
    server_reply_refusal(exchange, PROTO_PROBLEM_INSUFFICIENT_MEMORY,
                         "the answer of %zu bytes is more than can be kept for jobs at this "
                         "moment; request less of it, send the request without Prefer: "
                         "respond-async, or raise --memory-budget",
                         bytes);
    (void)answer_take(job, response); /* the call cannot fail, because a refusal has no headers */
}

/* --- the transport ---------------------------------------------------------------------------- */

static struct server_deferred_job *exchange_job(struct server_exchange *exchange)
{
    return (struct server_deferred_job *)exchange->transport;
}

static void job_on_begin(struct server_exchange *exchange)
{
    struct server_deferred_job *job = exchange_job(exchange);
    pthread_mutex_lock(&job->table->lock);
    bool is_new = job->state == PROTO_JOB_QUEUED;
    if (is_new) job->state = PROTO_JOB_RUNNING;
    pthread_mutex_unlock(&job->table->lock);
    if (is_new) job_notify(job);
}

static void job_on_report(struct server_exchange *exchange, double part)
{
    struct server_deferred_job *job = exchange_job(exchange);
    unsigned step = part <= 0 ? 0 : part < 1 ? (unsigned)(part * PROGRESS_STEPS) : PROGRESS_STEPS;
    unsigned before = atomic_load_explicit(&job->progress, memory_order_relaxed);
    while (step > before && !atomic_compare_exchange_weak(&job->progress, &before, step)) continue;
}

static void job_log(const struct server_deferred_job *job, const struct server_exchange *exchange,
                    enum proto_job_state state)
{
    struct server_log_line line;
    bool is_internal = exchange->response.status == 500;
    if (!server_log_begin(&line, is_internal ? SERVER_LOG_ERROR : SERVER_LOG_INFO, "job")) return;
    server_log_text(&line, "job", job->id);
    server_log_text(&line, "state", proto_job_state_name(state));
    server_exchange_log(exchange, &line, gd_now_ns() - exchange->started_ns);
    server_log_end(&line);
}

/* Called when the exchange is answered. Drops the answer of a cancelled job. */
static void job_on_finish(struct server_exchange *exchange)
{
    struct server_deferred_job *job = exchange_job(exchange);
    if (server_deferred_job_describe(job).state != PROTO_JOB_CANCELLED) answer_save(job, exchange);
    pthread_mutex_lock(&job->table->lock);
    job->exchange = NULL;
    if (job->state != PROTO_JOB_CANCELLED)
        job_end(job, job->answer.status < 400 ? PROTO_JOB_DONE : PROTO_JOB_FAILED);
    enum proto_job_state state = job->state;
    pthread_mutex_unlock(&job->table->lock);
    job_log(job, exchange, state);
    server_exchange_destroy(exchange);
    job_notify_end(job);
    server_deferred_job_release(job);
}

/* --- the start of a job ----------------------------------------------------------------------- */

/* Creates a job with one reference, not yet in the table. Returns NULL if out of memory. */
static struct server_deferred_job *job_create(struct server_job_table *table,
                                              struct server_exchange *exchange)
{
    struct server_deferred_job *job = calloc(1, sizeof *job);
    if (!job) return NULL;
    const char *key = server_grant_name(&exchange->grant);
    size_t bytes = sizeof *job + exchange->target_size;
    job->table = table;
    job->share = exchange->share;
    job->references = 1;
    job->transport = (struct server_transport){.finish = job_on_finish,
                                               .is_gone = server_exchange_is_unwanted,
                                               .begin = job_on_begin,
                                               .report = job_on_report};
    snprintf(job->tenant, sizeof job->tenant, "%s", exchange->tenant);
    snprintf(job->key, sizeof job->key, "%s", key ? key : "");
    if (server_budget_take(table->host->budget, SERVER_BUDGET_RECORDS, bytes)) job->own = bytes;
    if (job->own && asprintf(&job->request, "%s %s", exchange->method, exchange->path) < 0)
        job->request = NULL;
    if (job->request) job->exchange = server_exchange_detach(exchange, &job->transport);
    if (job->exchange) {
        job->exchange->job.is_patient = true;
        return job;
    }
    server_deferred_job_release(job);
    return NULL;
}

struct server_deferred_job *server_job_table_start(struct server_job_table *table,
                                                   struct server_exchange *exchange,
                                                   struct proto_problem *problem)
{
    struct server_deferred_job *job = job_create(table, exchange);
    if (!job) {
        (void)proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
        return NULL;
    }
    pthread_mutex_lock(&table->lock);
    bool is_added = table_add(table, job, problem);
    pthread_mutex_unlock(&table->lock);
    if (!is_added) {
        server_exchange_destroy(job->exchange);
        server_deferred_job_release(job);
        return NULL;
    }
    server_deferred_job_retain(job); /* this reference belongs to the exchange */
    server_exchange_run(job->exchange);
    table->host->watch(table->host->watcher);
    return job;
}

/* --- finding and ending jobs ------------------------------------------------------------------ */

/* Under the lock: returns true if the tenant may see the job. */
static bool job_is_visible(const struct server_deferred_job *job, const char *tenant,
                           uint64_t now_ns)
{
    return strcmp(job->tenant, tenant) == 0 && !job_is_expired(job, now_ns);
}

struct server_deferred_job *server_job_table_find(struct server_job_table *table,
                                                  const char *tenant, const char *id, size_t size)
{
    char text[SERVER_JOB_ID];
    if (size != SERVER_JOB_ID - 1) return NULL;
    memcpy(text, id, size);
    text[size] = '\0';
    SERVER_LOCK(&table->lock);
    struct server_deferred_job *job = server_sorted_find(&table->list, text);
    if (job && job_is_visible(job, tenant, gd_now_ns()))
        server_deferred_job_retain(job);
    else
        job = NULL;
    return job;
}

uint32_t server_job_table_list(struct server_job_table *table, const char *tenant,
                               const char *after, uint32_t most, struct server_deferred_job **out)
{
    uint32_t count = 0;
    uint64_t now = gd_now_ns();
    SERVER_LOCK(&table->lock);
    for (uint32_t at = server_sorted_after(&table->list, after ? after : "");
         at < table->list.count && count < most; at++)
        if (job_is_visible(table->list.items[at], tenant, now))
            out[count++] = server_deferred_job_retain(table->list.items[at]);
    return count;
}

void server_job_table_cancel(struct server_job_table *table, struct server_deferred_job *job)
{
    pthread_mutex_lock(&table->lock);
    bool has_ended = proto_job_has_ended(job->state);
    if (!has_ended) {
        job_end(job, PROTO_JOB_CANCELLED);
        atomic_store(&job->exchange->job.is_unwanted, true);
    } else if (server_sorted_find(&table->list, job->id) == job) {
        server_sorted_remove(&table->list, server_sorted_index(&table->list, job->id));
        table_drop(table, job);
    }
    pthread_mutex_unlock(&table->lock);
    if (!has_ended) job_notify_end(job);
}

void server_job_table_expire(struct server_job_table *table, uint64_t now_ns)
{
    SERVER_LOCK(&table->lock);
    if (now_ns - table->expired_ns >= EXPIRE_NS) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < table->list.count; i++) {
            struct server_deferred_job *job = table->list.items[i];
            if (job_is_expired(job, now_ns))
                table_drop(table, job);
            else
                table->list.items[kept++] = job;
        }
        table->list.count = kept;
        table->expired_ns = now_ns;
    }
}

void server_job_table_drain(struct server_job_table *table)
{
    SERVER_LOCK(&table->lock);
    table->is_draining = true;
    for (uint32_t i = 0; i < table->list.count; i++) {
        const struct server_deferred_job *job = table->list.items[i];
        if (job->state == PROTO_JOB_QUEUED) atomic_store(&job->exchange->job.is_unwanted, true);
        server_workers_unpark(table->host->waiters, job);
    }
}

bool server_job_table_is_empty(struct server_job_table *table)
{
    SERVER_LOCK(&table->lock);
    return table->list.count == 0;
}

struct server_job_statistics server_job_table_statistics(struct server_job_table *table,
                                                         const char *tenant)
{
    struct server_job_statistics statistics = {0};
    SERVER_LOCK(&table->lock);
    for (uint32_t i = 0; i < table->list.count; i++) {
        const struct server_deferred_job *job = table->list.items[i];
        if (!tenant || strcmp(job->tenant, tenant) == 0) statistics.now[job->state]++;
    }
    if (!tenant) memcpy(statistics.ended, table->ended, sizeof statistics.ended);
    return statistics;
}

/* --- life ------------------------------------------------------------------------------------- */

struct server_job_table *server_job_table_create(struct server_host *host,
                                                 const struct server_job_limits *limits)
{
    struct server_job_table *table = calloc(1, sizeof *table);
    if (!table) return NULL;
    table->host = host;
    table->limits = *limits;
    table->list = (struct server_sorted){.items = calloc(limits->jobs, sizeof(void *)),
                                         .capacity = limits->jobs,
                                         .compare = job_compare};
    pthread_mutex_init(&table->lock, NULL);
    if (table->list.items) return table;
    server_job_table_destroy(table);
    return NULL;
}

void server_job_table_destroy(struct server_job_table *table)
{
    if (!table) return;
    for (uint32_t i = 0; i < table->list.count; i++) table_drop(table, table->list.items[i]);
    pthread_mutex_destroy(&table->lock);
    free(table->list.items);
    free(table);
}
