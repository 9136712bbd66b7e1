/* See batches.h. */
#include "server/jobs/batches.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

#include "server/jobs/batch_item.h"
#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/http/reply.h"
#include "server/server.h"
#include "server/base/thread.h"

#define LOOK_NS      UINT64_C(500000000)
#define RENEW_NS     UINT64_C(4000000000) /* a quarter of a lease */
#define PAUSE_MS     500                  /* before an item that could not be done is taken again */
#define NODE         33
#define PROBLEM_MOST 65536 /* bytes of a problem's text */

struct server_batches {
    struct server *server;
    struct server_thread *thread;
    pthread_mutex_t lock;
    struct server_store_sql *sql;    /* under the lock until it is there; NULL: not opened as yet */
    atomic_bool cant_open;           /* the last time that it was tried */
    struct server_batch_item *items; /* under the lock */
    char node[NODE];
    uint64_t renewed_ns;
    char last_tenant[SERVER_TENANT + 1]; /* of the item that was begun last; of the thread */
    char asked[SERVER_BATCH_ID];         /* the batch that `many` is of; of the thread, as that */
    struct proto_many many;
    atomic_bool is_draining;
    atomic_uint running;
    atomic_uint_least64_t answered, returned;
};

/* --- the queue's database --------------------------------------------------------------------- */

static bool local_path(const struct server_config *config, char path[SERVER_DISK_PATH])
{
    if (config->store == SERVER_STORE_KIND_MEMORY)
        strcpy(path, ":memory:");
    else
        snprintf(path, SERVER_DISK_PATH, "%s/" SERVER_SQL_BATCHES, config->data_dir);
    return config->store == SERVER_STORE_KIND_LOCAL;
}

/* Under the lock. */
static void open_sql(struct server_batches *batches, char *error, size_t error_size)
{
    const struct server_config *config = &batches->server->config;
    char path[SERVER_DISK_PATH];
    snprintf(error, error_size, "out of memory");
    if (config->store == SERVER_STORE_KIND_POSTGRES) {
        batches->sql = server_store_sql_postgres_open(config->store_url);
        return;
    }
    (void)local_path(config, path);
    batches->sql = server_store_sql_local_open(path, server_batch_queue_tables, error, error_size);
    /* whose daemon has ended */
    if (batches->sql) (void)server_batch_queue_return_all(batches->sql);
    if (!batches->sql && !atomic_exchange(&batches->cant_open, true))
        server_log_message(SERVER_LOG_ERROR, "batches_unavailable", "%s", error);
    if (batches->sql) atomic_store(&batches->cant_open, false);
}

struct server_store_sql *server_batches_sql(struct server_batches *batches, char *error,
                                            size_t error_size)
{
    pthread_mutex_lock(&batches->lock);
    if (!batches->sql) open_sql(batches, error, error_size);
    struct server_store_sql *sql = batches->sql;
    pthread_mutex_unlock(&batches->lock);
    return sql;
}

/* A folder that had no batch has no database for them, and gets none by being looked at. */
static bool has_queue(struct server_batches *batches)
{
    char path[SERVER_DISK_PATH], error[256];
    const struct server_config *config = &batches->server->config;
    pthread_mutex_lock(&batches->lock);
    bool is_open = batches->sql != NULL;
    pthread_mutex_unlock(&batches->lock);
    if (is_open) return true;
    if (config->store == SERVER_STORE_KIND_MEMORY) return false;
    if (local_path(config, path) && !server_disk_exists(path)) return false;
    return server_batches_sql(batches, error, sizeof error) != NULL;
}

/* --- an item's answer ------------------------------------------------------------------------- */

static void finish(struct server_exchange *exchange)
{
    struct server_batch_item *item = server_batch_item_of(exchange);
    struct server_batches *batches = item->owner;
    server_batch_item_take_answer(item);
    pthread_mutex_lock(&batches->lock);
    item->exchange = NULL;
    item->status = exchange->response.status;
    pthread_mutex_unlock(&batches->lock);
    server_exchange_destroy(exchange);
    server_thread_wake(batches->thread);
}

/* The daemon could not take it up just now: that says nothing of the item. */
static bool was_refused(const struct server_batch_item *item)
{
    return item->status == 503 || !item->size;
}

/* Time or memory ran out: another daemon, or another moment, may have more; but not for ever. */
static bool may_get_through(const struct server_batch_item *item)
{
    return (item->status == 504 || item->status == 507) &&
           item->claim.attempts < SERVER_BATCH_TRIES;
}

static void settle(struct server_batches *batches, const struct server_batch_item *item)
{
    const struct server_batch_claim *claim = &item->claim;
    if (was_refused(item) || may_get_through(item)) {
        (void)server_batch_queue_return(batches->sql, claim, batches->node, !was_refused(item),
                                        atomic_load(&batches->is_draining) ? 0 : PAUSE_MS);
        atomic_fetch_add(&batches->returned, 1);
        return;
    }
    if (!server_batch_queue_answer(batches->sql, claim->id, claim->item, item->status, item->answer,
                                   item->size))
        atomic_fetch_add(&batches->answered, 1);
}

/* An item that was answered, taken out of the list; NULL: there is none. */
static struct server_batch_item *take_answered(struct server_batches *batches)
{
    pthread_mutex_lock(&batches->lock);
    struct server_batch_item **link = &batches->items;
    while (*link && !(*link)->status) link = &(*link)->next;
    struct server_batch_item *item = *link;
    if (item) *link = item->next;
    pthread_mutex_unlock(&batches->lock);
    return item;
}

static void settle_all(struct server_batches *batches)
{
    struct server_batch_item *item;
    while ((item = take_answered(batches))) {
        settle(batches, item);
        atomic_fetch_sub(&batches->running, 1);
        server_batch_item_free(item);
    }
}

/* --- leases ----------------------------------------------------------------------------------- */

/* By the thread, which alone takes items out of the list. */
static void renew(struct server_batches *batches)
{
    uint64_t now_ns = gd_now_ns();
    if (now_ns - batches->renewed_ns < RENEW_NS) return;
    batches->renewed_ns = now_ns;
    pthread_mutex_lock(&batches->lock);
    struct server_batch_item *item = batches->items;
    pthread_mutex_unlock(&batches->lock);
    for (; item; item = item->next) {
        if (server_batch_queue_renew(batches->sql, item->claim.id, item->claim.item,
                                     batches->node) != SERVER_STORE_ABSENT)
            continue;
        pthread_mutex_lock(&batches->lock);
        server_batch_item_give_up(item);
        pthread_mutex_unlock(&batches->lock);
    }
}

/* --- beginning -------------------------------------------------------------------------------- */

/* What the batch asks, read once for its items one after the other. */
static bool learn(struct server_batches *batches, const char *id, struct proto_problem *problem)
{
    void *text = NULL;
    size_t size = 0;
    if (batches->many.document && strcmp(batches->asked, id) == 0) return true;
    proto_many_free(&batches->many);
    if (server_batch_queue_document(batches->sql, id, &text, &size))
        return proto_problem_set(problem, PROTO_PROBLEM_STORE_UNAVAILABLE,
                                 "the batch can't be read");
    bool is_read = proto_many_read(text, size, &batches->many, problem);
    if (is_read) snprintf(batches->asked, sizeof batches->asked, "%s", id);
    free(text);
    return is_read;
}

static void add(struct server_batches *batches, struct server_batch_item *item)
{
    pthread_mutex_lock(&batches->lock);
    item->next = batches->items;
    batches->items = item;
    pthread_mutex_unlock(&batches->lock);
    atomic_fetch_add(&batches->running, 1);
}

/* An item that was begun so often, each time by a daemon that did not live to tell, or that can't
 * be asked. */
static void refuse(struct server_batches *batches, const struct server_batch_claim *claim,
                   const struct proto_problem *problem)
{
    struct proto_writer writer;
    struct server_batch_item item = {.claim = *claim, .status = problem->status};
    proto_writer_init(&writer, PROBLEM_MOST);
    proto_problem_encode(&writer, problem);
    item.answer = proto_writer_take(&writer, &item.size);
    settle(batches, &item);
    free(item.answer);
}

static void begin(struct server_batches *batches, const struct server_batch_claim *claim)
{
    struct proto_problem problem;
    struct server_batch_item *item = NULL;
    if (claim->attempts > SERVER_BATCH_TRIES)
        (void)proto_problem_set(&problem, PROTO_PROBLEM_INTERNAL,
                                "this item was begun %d times, and no daemon lived to answer it",
                                SERVER_BATCH_TRIES);
    else if (learn(batches, claim->id, &problem))
        item = server_batch_item_create(&batches->server->host, &batches->many, claim, finish,
                                        batches, &problem);
    if (item) {
        add(batches, item);
        server_batch_item_run(item);
    } else {
        refuse(batches, claim, &problem);
    }
}

/* Batches have what requests leave over: nothing is begun while a request waits. */
static bool has_time(const struct server_batches *batches)
{
    struct server_workers_load load = server_workers_load(batches->server->workers);
    uint32_t most = load.threads > 1 ? load.threads - 1 : 1;
    return !atomic_load(&batches->is_draining) && load.queued == 0 &&
           atomic_load(&batches->running) < most;
}

static bool claim_next(struct server_batches *batches, struct server_batch_claim *claim)
{
    if (server_batch_queue_claim(batches->sql, batches->node, batches->last_tenant, claim))
        return false;
    memcpy(batches->last_tenant, claim->tenant, sizeof batches->last_tenant);
    return true;
}

static void begin_some(struct server_batches *batches)
{
    struct server_batch_claim claim;
    while (has_time(batches) && claim_next(batches, &claim)) begin(batches, &claim);
}

/* --- life ------------------------------------------------------------------------------------- */

static void work(void *user, struct server_thread *thread)
{
    struct server_batches *batches = user;
    while (server_thread_pause(thread, LOOK_NS)) {
        if (!has_queue(batches)) continue;
        settle_all(batches);
        renew(batches);
        begin_some(batches);
    }
}

/* A name that no other daemon has, at no other time. */
static void name_node(char node[NODE])
{
    unsigned char bytes[NODE / 2];
    if (getrandom(bytes, sizeof bytes, 0) < (ssize_t)sizeof bytes)
        memcpy(bytes, &(uint64_t){gd_now_ns()}, 8);
    for (size_t i = 0; i < sizeof bytes; i++) sprintf(node + 2 * i, "%02x", bytes[i]);
}

struct server_batches *server_batches_create(struct server *server, char *error, size_t error_size)
{
    struct server_batches *batches = calloc(1, sizeof *batches);
    snprintf(error, error_size, "out of memory or threads");
    if (!batches) return NULL;
    batches->server = server;
    name_node(batches->node);
    pthread_mutex_init(&batches->lock, NULL);
    (void)has_queue(batches); /* damage is found before the first batch is asked about */
    batches->thread = server_thread_start(work, batches);
    if (batches->thread) return batches;
    server_batches_destroy(batches);
    return NULL;
}

void server_batches_drain(struct server_batches *batches)
{
    atomic_store(&batches->is_draining, true);
    pthread_mutex_lock(&batches->lock);
    for (struct server_batch_item *item = batches->items; item; item = item->next)
        server_batch_item_give_up(item);
    pthread_mutex_unlock(&batches->lock);
}

void server_batches_destroy(struct server_batches *batches)
{
    if (!batches) return;
    server_thread_stop(batches->thread);
    if (batches->sql) {
        settle_all(batches);
        batches->sql->close(batches->sql);
    }
    proto_many_free(&batches->many);
    pthread_mutex_destroy(&batches->lock);
    free(batches);
}

const char *server_batches_health(struct server_batches *batches)
{
    bool cant_open = batches && atomic_load(&batches->cant_open);
    return cant_open ? "the database of batches can't be opened: see the log, mend the data folder"
                     : NULL;
}

void server_batches_wake(struct server_batches *batches)
{
    server_thread_wake(batches->thread);
}

void server_batches_end(struct server_batches *batches, const char *id)
{
    pthread_mutex_lock(&batches->lock);
    for (struct server_batch_item *item = batches->items; item; item = item->next)
        if (strcmp(item->claim.id, id) == 0) server_batch_item_give_up(item);
    pthread_mutex_unlock(&batches->lock);
}

struct server_batches_statistics server_batches_statistics(struct server_batches *batches)
{
    if (!batches) return (struct server_batches_statistics){0};
    return (struct server_batches_statistics){.answered = atomic_load(&batches->answered),
                                              .returned = atomic_load(&batches->returned),
                                              .running = atomic_load(&batches->running)};
}
