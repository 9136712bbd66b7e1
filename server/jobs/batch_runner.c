#include "server/jobs/batch_runner.h"

#include <limits.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "proto/queries/many.h"
#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/base/thread.h"
#include "server/jobs/job_table.h"

#define POLL_NS      UINT64_C(500000000)
#define RENEW_NS     UINT64_C(4000000000) /* about a quarter of a lease */
#define PAUSE_MS     500                  /* time until a returned item is claimed again */
#define BODY_MOST    ((size_t)4 << 20)
#define PROBLEM_MOST 65536 /* limit on the bytes of a problem's text */
#define PLACES       16

struct item {
    /* must be the first member: a pointer to it is cast to the item */
    struct server_transport transport;
    struct server_batch_runner *runner;
    struct server_batch_claim claim;
    char tag[SERVER_ETAG + 2]; /* If-Match, quoted */
    /* guarded by the runner's lock: */
    struct item *next;
    struct server_exchange *exchange; /* NULL means answered */
    unsigned status;                  /* 0 if not answered */
    /* used by the thread after the item is answered: */
    char *answer; /* NULL means that there is no answer, or that memory for the answer was short */
    size_t size;
    size_t held; /* bytes of SERVER_BUDGET_ANSWERS */
};

struct server_batch_runner {
    struct server_host *host;
    const struct server_config *config;
    struct server_thread *thread;
    pthread_mutex_t lock;
    _Atomic(struct server_store_sql *) sql; /* set once, under the lock; NULL if not opened yet */
    char path[SERVER_DISK_PATH];            /* path of the queue's file; unused with PostgreSQL */
    struct item *items;                     /* guarded by the lock; only the thread removes items */
    uint64_t news;                          /* under the lock */
    /* a bit for each of `places` whose batches have changed; guarded by the lock */
    unsigned due;
    /* the addresses at which jobs are parked: see place_of */
    char places[PLACES];
    atomic_bool cant_open; /* true if the last attempt to open the queue failed */
    atomic_bool is_draining;
    atomic_uint running;
    atomic_uint_least64_t answered, returned;
    /* Used by the thread: */
    char node[SERVER_JOB_ID]; /* its name in leases */
    uint64_t renewed_ns, looked_ns;
    char last_tenant[SERVER_TENANT + 1]; /* tenant of the last claimed item */
    char read_id[PROTO_MANY_ID];         /* id of the batch from which `many` was read */
    struct proto_many many;
};

/* --- the queue's database --------------------------------------------------------------------- */

/* Opens the queue, under the lock. */
static void runner_open(struct server_batch_runner *runner, char error[SERVER_ERROR])
{
    snprintf(error, SERVER_ERROR, "out of memory");
    if (runner->config->store == SERVER_STORE_KIND_POSTGRES) {
        runner->sql = server_store_sql_postgres_open(runner->config->store_url);
        return;
    }
    struct server_store_sql *sql =
        server_store_sql_local_open(runner->path, server_batch_queue_tables, error);
    if (sql) /* returns items that an earlier daemon had claimed */
        (void)server_batch_queue_return_all(sql);
    else if (!atomic_load(&runner->cant_open))
        server_log_message(SERVER_LOG_ERROR, "batches_unavailable", "%s", error);
    atomic_store(&runner->cant_open, !sql);
    runner->sql = sql;
}

struct server_store_sql *server_batch_runner_sql(struct server_batch_runner *runner,
                                                 char error[SERVER_ERROR])
{
    SERVER_LOCK(&runner->lock);
    if (!runner->sql) runner_open(runner, error);
    return runner->sql;
}

/* Opens the queue if there is one. A folder that never had a batch has no database. */
static bool runner_has_queue(struct server_batch_runner *runner)
{
    char error[SERVER_ERROR];
    enum server_store_kind store = runner->config->store;
    if (runner->sql) return true;
    if (store == SERVER_STORE_KIND_MEMORY) return false;
    if (store == SERVER_STORE_KIND_LOCAL && !server_disk_exists(runner->path)) return false;
    return server_batch_runner_sql(runner, error) != NULL;
}

/* --- an item's exchange ----------------------------------------------------------------------- */

/* Takes over the answer; copies a static body. If memory is short, the item gets no answer. */
static void item_take_answer(struct item *item, struct server_response *response)
{
    item->size = response->body ? response->size : 0;
    item->answer = response->owned;
    item->held = response->held;
    response->owned = NULL;
    response->held = 0;
    if (item->answer || !item->size) return;
    item->answer = malloc(item->size);
    if (item->answer)
        memcpy(item->answer, response->body, item->size);
    else
        item->size = 0;
}

static void item_on_finish(struct server_exchange *exchange)
{
    struct item *item = (struct item *)exchange->transport;
    struct server_batch_runner *runner = item->runner;
    item_take_answer(item, &exchange->response);
    pthread_mutex_lock(&runner->lock);
    item->exchange = NULL;
    item->status = exchange->response.status;
    pthread_mutex_unlock(&runner->lock);
    server_exchange_destroy(exchange);
    server_thread_wake(runner->thread);
}

static bool item_set_request(struct item *item, const struct proto_writer *body,
                             struct proto_problem *problem)
{
    struct server_exchange *exchange = item->exchange;
    exchange->method = "POST";
    exchange->job.is_patient = true;
    exchange->tenant = item->claim.tenant;
    server_exchange_add_header(exchange, "Content-Type", "application/json");
    if (item->tag[0]) server_exchange_add_header(exchange, "If-Match", item->tag);
    snprintf(exchange->request_id, sizeof exchange->request_id, "%s-%u", item->claim.id,
             (unsigned)item->claim.item);
    if (!proto_route_find(proto_routes, proto_route_count, exchange->method, exchange->path,
                          &exchange->match, problem) ||
        !proto_writer_check(body, problem) ||
        !server_body_prepare(&exchange->body, exchange->share, body->size, BODY_MOST, problem))
        return false;
    server_body_append(&exchange->body, body->data, body->size);
    return server_body_check(&exchange->body, problem);
}

static bool item_set_exchange(struct item *item, const struct proto_many *many,
                              struct proto_problem *problem)
{
    struct proto_writer body;
    char target[PROTO_MESH_NAME + 64];
    uint32_t number = (uint32_t)item->claim.item;
    proto_writer_init(&body, BODY_MOST);
    const char *query = proto_many_ask(many, number, &body);
    snprintf(target, sizeof target, "/v1/meshes/%s/%s", proto_many_mesh(many, number), query);
    item->exchange = server_exchange_create(item->runner->host, &item->transport, target);
    bool is_set = item->exchange ? item_set_request(item, &body, problem)
                                 : proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    proto_writer_free(&body);
    if (!is_set) server_exchange_destroy(item->exchange);
    return is_set;
}

static struct item *item_create(struct server_batch_runner *runner,
                                const struct server_batch_claim *claim,
                                struct proto_problem *problem)
{
    struct item *item = calloc(1, sizeof *item);
    if (!item) {
        (void)proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
        return NULL;
    }
    *item = (struct item){
        .transport = {.finish = item_on_finish, .is_gone = server_exchange_is_unwanted},
        .runner = runner,
        .claim = *claim};
    if (claim->etag[0]) snprintf(item->tag, sizeof item->tag, "\"%s\"", claim->etag);
    if (item_set_exchange(item, &runner->many, problem)) return item;
    free(item);
    return NULL;
}

/* Under the lock: answers the item as cancelled, unless it already has an answer. */
static void item_cancel(struct item *item)
{
    if (item->exchange) atomic_store(&item->exchange->job.is_unwanted, true);
}

/* --- answers ---------------------------------------------------------------------------------- */

/* Writes the answer, or returns the item to the queue. After 503 or without an answer, this daemon
 * could not start the item, which does not count as an attempt. After 504 and 507, another daemon
 * or a later attempt may have more time or memory; this counts as an attempt. */
static void item_settle(struct server_batch_runner *runner, const struct item *item)
{
    const struct server_batch_claim *claim = &item->claim;
    bool was_refused = item->status == 503 || !item->size;
    bool may_succeed =
        (item->status == 504 || item->status == 507) && claim->attempts < SERVER_BATCH_TRIES;
    if (was_refused || may_succeed) {
        (void)server_batch_queue_return(runner->sql, claim, runner->node, !was_refused,
                                        atomic_load(&runner->is_draining) ? 0 : PAUSE_MS);
        atomic_fetch_add(&runner->returned, 1);
    } else if (!server_batch_queue_answer(runner->sql, claim, item->status, item->answer,
                                          item->size)) {
        atomic_fetch_add(&runner->answered, 1);
    }
}

/* Returns the index in `places` of the address at which jobs wait for changes of that batch. The
 * index is the last digit of the batch's id. */
static unsigned place_of(const char *id)
{
    return (unsigned)strtoul(id + PROTO_MANY_ID - 2, NULL, 16) % PLACES;
}

/* Records a change of the batch `id`, or of all batches if `id` is NULL. */
static void runner_note(struct server_batch_runner *runner, const char *id)
{
    SERVER_LOCK(&runner->lock);
    runner->news++;
    runner->due |= id ? 1U << place_of(id) : UINT_MAX;
}

/* Wakes the jobs whose batch has changed, or all jobs if other daemons share the queue. */
static void runner_wake_jobs(struct server_batch_runner *runner)
{
    uint64_t now_ns = gd_now_ns();
    pthread_mutex_lock(&runner->lock);
    unsigned due = runner->due;
    runner->due = 0;
    pthread_mutex_unlock(&runner->lock);
    if (runner->sql->is_shared && now_ns - runner->looked_ns >= POLL_NS) {
        runner->looked_ns = now_ns;
        due = UINT_MAX;
    }
    for (unsigned i = 0; i < PLACES; i++)
        if (due >> i & 1) server_workers_unpark(runner->host->batch_readers, &runner->places[i]);
}

uint64_t server_batch_runner_news(struct server_batch_runner *runner)
{
    SERVER_LOCK(&runner->lock);
    return runner->news;
}

bool server_batch_runner_wait(struct server_batch_runner *runner, struct server_job *job,
                              const struct server_batch_wait *wait)
{
    SERVER_LOCK(&runner->lock);
    return wait->news == runner->news && !atomic_load(&runner->is_draining) &&
           server_workers_park(runner->host->batch_readers, job,
                               &runner->places[place_of(wait->id)], wait->until_ns);
}

static void runner_settle(struct server_batch_runner *runner)
{
    for (;;) {
        pthread_mutex_lock(&runner->lock);
        struct item **link = &runner->items;
        while (*link && !(*link)->status) link = &(*link)->next;
        struct item *item = *link;
        if (item) *link = item->next;
        pthread_mutex_unlock(&runner->lock);
        if (!item) return;
        item_settle(runner, item);
        runner_note(runner, item->claim.id);
        atomic_fetch_sub(&runner->running, 1);
        free(item->answer);
        server_share_give_answer(&runner->host->budget->common, item->held);
        free(item);
    }
}

static void runner_renew(struct server_batch_runner *runner)
{
    uint64_t now_ns = gd_now_ns();
    if (now_ns - runner->renewed_ns < RENEW_NS) return;
    runner->renewed_ns = now_ns;
    pthread_mutex_lock(&runner->lock);
    struct item *item = runner->items;
    pthread_mutex_unlock(&runner->lock);
    for (; item; item = item->next) {
        if (server_batch_queue_renew(runner->sql, &item->claim, runner->node) !=
            SERVER_STORE_ABSENT)
            continue;
        pthread_mutex_lock(&runner->lock);
        item_cancel(item);
        pthread_mutex_unlock(&runner->lock);
    }
}

/* --- new items -------------------------------------------------------------------------------- */

/* Reads the batch's document, unless the preceding item belonged to the same batch. */
static bool runner_read(struct server_batch_runner *runner, const char *id,
                        struct proto_problem *problem)
{
    void *text = NULL;
    size_t size = 0;
    if (runner->many.document && strcmp(runner->read_id, id) == 0) return true;
    proto_many_free(&runner->many);
    if (server_batch_queue_document(runner->sql, id, &text, &size))
        return proto_problem_set(problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                                 "the batch can't be read");
    bool is_read = proto_many_read(text, size, &runner->many, problem);
    if (is_read) snprintf(runner->read_id, sizeof runner->read_id, "%s", id);
    free(text);
    return is_read;
}

static void runner_refuse(struct server_batch_runner *runner,
                          const struct server_batch_claim *claim,
                          const struct proto_problem *problem)
{
    struct proto_writer writer;
    struct item item = {.claim = *claim, .status = problem->status};
    proto_writer_init(&writer, PROBLEM_MOST);
    proto_problem_encode(&writer, problem);
    item.answer = proto_writer_take(&writer, &item.size);
    item_settle(runner, &item);
    runner_note(runner, claim->id);
    free(item.answer);
}

static void runner_start(struct server_batch_runner *runner, const struct server_batch_claim *claim)
{
    struct proto_problem problem;
    struct item *item = NULL;
    if (claim->attempts > SERVER_BATCH_TRIES)
        (void)proto_problem_set(&problem, PROTO_PROBLEM_INTERNAL,
                                "this item was started %d times, and each time the daemon "
                                "ended before the answer",
                                SERVER_BATCH_TRIES);
    else if (runner_read(runner, claim->id, &problem))
        item = item_create(runner, claim, &problem);
    if (!item) {
        runner_refuse(runner, claim, &problem);
        return;
    }
    pthread_mutex_lock(&runner->lock);
    item->next = runner->items;
    runner->items = item;
    pthread_mutex_unlock(&runner->lock);
    atomic_fetch_add(&runner->running, 1);
    server_exchange_run(item->exchange);
}

/* Returns true if an item may start. No request may be waiting, and one worker must stay free. */
static bool runner_has_time(const struct server_batch_runner *runner)
{
    struct server_workers_load load = server_workers_load(runner->host->workers);
    uint32_t most = load.threads > 1 ? load.threads - 1 : 1;
    return !atomic_load(&runner->is_draining) && load.queued == 0 &&
           atomic_load(&runner->running) < most;
}

static void runner_work(void *user, struct server_thread *thread)
{
    struct server_batch_runner *runner = user;
    struct server_batch_claim claim;
    while (server_thread_pause(thread, POLL_NS)) {
        if (!runner_has_queue(runner)) continue;
        runner_settle(runner);
        runner_renew(runner);
        while (runner_has_time(runner) &&
               !server_batch_queue_claim(runner->sql, runner->node, runner->last_tenant, &claim)) {
            memcpy(runner->last_tenant, claim.tenant, sizeof runner->last_tenant);
            runner_start(runner, &claim);
        }
        runner_wake_jobs(runner);
    }
}

/* --- life ------------------------------------------------------------------------------------- */

struct server_batch_runner *server_batch_runner_create(struct server_host *host,
                                                       const struct server_config *config,
                                                       char error[SERVER_ERROR])
{
    struct server_batch_runner *runner = calloc(1, sizeof *runner);
    snprintf(error, SERVER_ERROR, "out of memory or threads");
    if (!runner) return NULL;
    runner->host = host;
    runner->config = config;
    snprintf(runner->path, sizeof runner->path, "%s/" SERVER_SQL_BATCHES, config->data_dir);
    if (config->store == SERVER_STORE_KIND_MEMORY) strcpy(runner->path, ":memory:");
    (void)server_job_id_create(runner->node);
    pthread_mutex_init(&runner->lock, NULL);
    (void)runner_has_queue(runner); /* detects damage of the database before the first batch */
    runner->thread = server_thread_start(runner_work, runner);
    if (runner->thread) return runner;
    server_batch_runner_destroy(runner);
    return NULL;
}

void server_batch_runner_cancel(struct server_batch_runner *runner, const char *id)
{
    pthread_mutex_lock(&runner->lock);
    for (struct item *item = runner->items; item; item = item->next)
        if (!id || strcmp(item->claim.id, id) == 0) item_cancel(item);
    pthread_mutex_unlock(&runner->lock);
    runner_note(runner, id);
    server_thread_wake(runner->thread);
}

void server_batch_runner_drain(struct server_batch_runner *runner)
{
    atomic_store(&runner->is_draining, true);
    server_batch_runner_cancel(runner, NULL);
}

void server_batch_runner_destroy(struct server_batch_runner *runner)
{
    if (!runner) return;
    server_thread_stop(runner->thread);
    struct server_store_sql *sql = runner->sql;
    if (sql) {
        runner_settle(runner);
        sql->close(sql);
    }
    proto_many_free(&runner->many);
    pthread_mutex_destroy(&runner->lock);
    free(runner);
}

const char *server_batch_runner_health(struct server_batch_runner *runner)
{
    bool cant_open = runner && atomic_load(&runner->cant_open);
    return cant_open ? "the database of batches can't be opened: see the log, mend the data folder"
                     : NULL;
}

void server_batch_runner_wake(struct server_batch_runner *runner)
{
    server_thread_wake(runner->thread);
}

struct server_batch_statistics server_batch_runner_statistics(struct server_batch_runner *runner)
{
    if (!runner) return (struct server_batch_statistics){0};
    return (struct server_batch_statistics){.answered = atomic_load(&runner->answered),
                                            .returned = atomic_load(&runner->returned),
                                            .running = atomic_load(&runner->running)};
}
