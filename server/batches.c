/* See batches.h. */
#include "server/batches.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

#include "proto/many.h"
#include "server/disk.h"
#include "server/log.h"
#include "server/reply.h"
#include "server/router.h"
#include "server/server.h"
#include "server/thread.h"

#define LOOK_NS      UINT64_C(500000000)
#define RENEW_NS     UINT64_C(4000000000) /* a quarter of a lease */
#define PAUSE_MS     500                  /* before an item that could not be done is taken again */
#define NODE         33
#define LARGEST_BODY ((size_t)4 << 20)
#define CONTENT_TYPE "application/json"

/* An item under way. */
struct item {
    struct server_transport transport; /* first: its exchange finds it by it */
    struct server_batches *batches;
    struct server_batch_claim claim;
    char tag[SERVER_ETAG + 2];
    struct item *next;
    struct server_exchange *exchange; /* under the lock; NULL: answered */
    unsigned status;                  /* 0: not answered */
    char *answer;
    size_t size;
};

struct server_batches {
    struct server *server;
    struct server_thread *thread;
    pthread_mutex_t lock;
    struct server_store_sql *sql; /* under the lock until it is there; NULL: not opened as yet */
    struct item *items;           /* under the lock */
    char node[NODE];
    uint64_t renewed_ns;
    char asked[SERVER_BATCH_ID]; /* the batch that `many` is of; of the thread, as that */
    struct proto_many many;
    atomic_bool is_draining;
    atomic_uint running;
    atomic_uint_least64_t answered, returned;
};

/* --- the queue's database ----------------------------------------------------------------------------------------- */

static bool local_path(const struct server_config *config, char path[SERVER_DISK_PATH])
{
    if (config->store == SERVER_STORE_KIND_MEMORY)
        strcpy(path, ":memory:");
    else
        snprintf(path, SERVER_DISK_PATH, "%s/" SERVER_BATCH_QUEUE_FILE, config->data_dir);
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
    if (batches->sql) (void)server_batch_queue_return_all(batches->sql); /* whose daemon has ended */
}

struct server_store_sql *server_batches_sql(struct server_batches *batches, char *error, size_t error_size)
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
    if (local_path(config, path) && access(path, F_OK) != 0) return false;
    return server_batches_sql(batches, error, sizeof error) != NULL;
}

/* --- an item's answer --------------------------------------------------------------------------------------------- */

static struct item *item_of(struct server_exchange *exchange)
{
    return (struct item *)exchange->transport;
}

static void take_answer(struct item *item, struct server_response *response)
{
    item->size = response->body ? response->size : 0;
    item->answer = response->owned;
    response->owned = NULL;
    if (item->answer || !item->size) return;
    item->answer = malloc(item->size);
    if (item->answer)
        memcpy(item->answer, response->body, item->size);
    else
        item->size = 0;
}

static void finish(struct server_exchange *exchange)
{
    struct item *item = item_of(exchange);
    struct server_batches *batches = item->batches;
    unsigned status = exchange->response.status;
    take_answer(item, &exchange->response);
    pthread_mutex_lock(&batches->lock);
    item->exchange = NULL;
    item->status = status;
    pthread_mutex_unlock(&batches->lock);
    server_exchange_destroy(exchange);
    server_thread_wake(batches->thread);
}

static bool is_gone(struct server_exchange *exchange)
{
    return atomic_load_explicit(&exchange->job.is_unwanted, memory_order_relaxed);
}

/* The daemon could not take it up just now: that says nothing of the item. */
static bool was_refused(const struct item *item)
{
    return item->status == 503 || !item->size;
}

/* Time or memory ran out: another daemon, or another moment, may have more; but not for ever. */
static bool may_get_through(const struct item *item)
{
    return (item->status == 504 || item->status == 507) && item->claim.attempts < SERVER_BATCH_TRIES;
}

static void settle(struct server_batches *batches, const struct item *item)
{
    const struct server_batch_claim *claim = &item->claim;
    if (was_refused(item) || may_get_through(item)) {
        (void)server_batch_queue_return(batches->sql, claim, batches->node, !was_refused(item),
                                        atomic_load(&batches->is_draining) ? 0 : PAUSE_MS);
        atomic_fetch_add(&batches->returned, 1);
        return;
    }
    if (!server_batch_queue_answer(batches->sql, claim->id, claim->item, item->status, item->answer, item->size))
        atomic_fetch_add(&batches->answered, 1);
}

/* An item that was answered, taken out of the list; NULL: there is none. */
static struct item *take_answered(struct server_batches *batches)
{
    pthread_mutex_lock(&batches->lock);
    struct item **link = &batches->items;
    while (*link && !(*link)->status) link = &(*link)->next;
    struct item *item = *link;
    if (item) *link = item->next;
    pthread_mutex_unlock(&batches->lock);
    return item;
}

static void free_item(struct item *item)
{
    free(item->answer);
    free(item);
}

static void settle_all(struct server_batches *batches)
{
    struct item *item;
    while ((item = take_answered(batches))) {
        settle(batches, item);
        atomic_fetch_sub(&batches->running, 1);
        free_item(item);
    }
}

/* --- leases ------------------------------------------------------------------------------------------------------- */

/* Ends the item's work; its answer will be that it was cancelled. */
static void give_up(struct item *item)
{
    if (item->exchange) atomic_store(&item->exchange->job.is_unwanted, true);
}

/* By the thread, which alone takes items out of the list. */
static void renew(struct server_batches *batches)
{
    uint64_t now_ns = gd_now_ns();
    if (now_ns - batches->renewed_ns < RENEW_NS) return;
    batches->renewed_ns = now_ns;
    pthread_mutex_lock(&batches->lock);
    struct item *item = batches->items;
    pthread_mutex_unlock(&batches->lock);
    for (; item; item = item->next) {
        if (server_batch_queue_renew(batches->sql, item->claim.id, item->claim.item, batches->node) !=
            SERVER_STORE_ABSENT)
            continue;
        pthread_mutex_lock(&batches->lock);
        give_up(item);
        pthread_mutex_unlock(&batches->lock);
    }
}

/* --- beginning ---------------------------------------------------------------------------------------------------- */

/* What the batch asks, read once for its items one after the other. */
static bool learn(struct server_batches *batches, const char *id, struct proto_problem *problem)
{
    void *text = NULL;
    size_t size = 0;
    if (batches->many.document && strcmp(batches->asked, id) == 0) return true;
    proto_many_free(&batches->many);
    if (server_batch_queue_document(batches->sql, id, &text, &size))
        return proto_problem_set(problem, PROTO_PROBLEM_STORE_UNAVAILABLE, "the batch can't be read");
    bool is_read = proto_many_read(text, size, &batches->many, problem);
    if (is_read) snprintf(batches->asked, sizeof batches->asked, "%s", id);
    free(text);
    return is_read;
}

static bool set_body(struct server_exchange *exchange, const struct proto_writer *body, struct proto_problem *problem)
{
    struct server_budget *budget = &exchange->server->budget;
    return proto_writer_check(body, problem) &&
           server_body_prepare(&exchange->body, budget, body->size, LARGEST_BODY, problem) &&
           server_body_append(&exchange->body, budget, body->data, body->size) &&
           server_body_check(&exchange->body, budget, problem);
}

/* The exchange of an item; NULL with the problem. */
static struct server_exchange *make_exchange(struct server_batches *batches, struct item *item,
                                             struct proto_problem *problem)
{
    struct proto_writer body;
    char target[PROTO_MESH_NAME + 64];
    uint32_t number = (uint32_t)item->claim.item;
    proto_writer_init(&body, LARGEST_BODY);
    const char *question = proto_many_ask(&batches->many, number, &body);
    snprintf(target, sizeof target, "/v1/meshes/%s/%s", proto_many_mesh(&batches->many, number), question);
    struct server_exchange *exchange = server_exchange_create(batches->server, &item->transport, target);
    bool is_made = exchange != NULL;
    if (!is_made) (void)proto_problem_from_status(problem, GD_NO_MEMORY, NULL);
    if (is_made) {
        exchange->method = "POST";
        exchange->tenant = item->claim.tenant;
        server_exchange_add_header(exchange, "Content-Type", CONTENT_TYPE);
        if (item->tag[0]) server_exchange_add_header(exchange, "If-Match", item->tag);
        snprintf(exchange->request_id, sizeof exchange->request_id, "%s-%u", item->claim.id, number);
        is_made = proto_route_find(proto_routes, proto_route_count, exchange->method, exchange->path, &exchange->match,
                                   problem) &&
                  set_body(exchange, &body, problem);
    }
    proto_writer_free(&body);
    if (is_made) return exchange;
    server_exchange_destroy(exchange);
    return NULL;
}

static void add(struct server_batches *batches, struct item *item, struct server_exchange *exchange)
{
    pthread_mutex_lock(&batches->lock);
    item->exchange = exchange;
    item->next = batches->items;
    batches->items = item;
    pthread_mutex_unlock(&batches->lock);
    atomic_fetch_add(&batches->running, 1);
}

/* As a connection does it. */
static void run(struct server_exchange *exchange)
{
    server_router_dispatch(exchange);
    if (exchange->response.status)
        finish(exchange);
    else
        server_exchange_submit(exchange);
}

/* An item that was begun so often, each time by a daemon that did not live to tell, or that can't be asked. */
static void refuse(struct server_batches *batches, const struct server_batch_claim *claim,
                   const struct proto_problem *problem)
{
    struct proto_writer writer;
    struct item item = {.claim = *claim, .status = problem->status};
    proto_writer_init(&writer, SERVER_REPLY_MOST);
    proto_problem_encode(&writer, problem);
    item.answer = proto_writer_take(&writer, &item.size);
    settle(batches, &item);
    free(item.answer);
}

static void begin(struct server_batches *batches, const struct server_batch_claim *claim)
{
    struct proto_problem problem;
    struct server_exchange *exchange = NULL;
    struct item *item = calloc(1, sizeof *item);
    if (claim->attempts > SERVER_BATCH_TRIES) {
        (void)proto_problem_set(&problem, PROTO_PROBLEM_INTERNAL,
                                "this item was begun %d times, and no daemon lived to answer it", SERVER_BATCH_TRIES);
    } else if (!item) {
        (void)proto_problem_from_status(&problem, GD_NO_MEMORY, NULL);
    } else if (learn(batches, claim->id, &problem)) {
        *item = (struct item){.transport = {.finish = finish, .is_gone = is_gone}, .batches = batches, .claim = *claim};
        if (claim->etag[0]) snprintf(item->tag, sizeof item->tag, "\"%s\"", claim->etag);
        exchange = make_exchange(batches, item, &problem);
    }
    if (exchange) {
        add(batches, item, exchange);
        run(exchange);
    } else {
        free(item);
        refuse(batches, claim, &problem);
    }
}

/* Batches have what requests leave over: nothing is begun while a request waits. */
static bool has_time(const struct server_batches *batches)
{
    struct server_workers_load load = server_workers_load(batches->server->workers);
    uint32_t most = load.threads > 1 ? load.threads - 1 : 1;
    return !atomic_load(&batches->is_draining) && load.queued == 0 && atomic_load(&batches->running) < most;
}

static void begin_some(struct server_batches *batches)
{
    struct server_batch_claim claim;
    while (has_time(batches) && server_batch_queue_claim(batches->sql, batches->node, &claim) == SERVER_STORE_DONE)
        begin(batches, &claim);
}

/* --- life --------------------------------------------------------------------------------------------------------- */

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
    if (getrandom(bytes, sizeof bytes, 0) < (ssize_t)sizeof bytes) memcpy(bytes, &(uint64_t){gd_now_ns()}, 8);
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
    batches->thread = server_thread_start(work, batches);
    if (batches->thread) return batches;
    server_batches_destroy(batches);
    return NULL;
}

void server_batches_drain(struct server_batches *batches)
{
    atomic_store(&batches->is_draining, true);
    pthread_mutex_lock(&batches->lock);
    for (struct item *item = batches->items; item; item = item->next) give_up(item);
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

void server_batches_wake(struct server_batches *batches)
{
    server_thread_wake(batches->thread);
}

void server_batches_end(struct server_batches *batches, const char *id)
{
    pthread_mutex_lock(&batches->lock);
    for (struct item *item = batches->items; item; item = item->next)
        if (strcmp(item->claim.id, id) == 0) give_up(item);
    pthread_mutex_unlock(&batches->lock);
}

struct server_batches_statistics server_batches_statistics(struct server_batches *batches)
{
    if (!batches) return (struct server_batches_statistics){0};
    return (struct server_batches_statistics){.answered = atomic_load(&batches->answered),
                                              .returned = atomic_load(&batches->returned),
                                              .running = atomic_load(&batches->running)};
}
