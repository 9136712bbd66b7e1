/* See postgres.h. */
#include "server/store/postgres/transactions.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "gd/control.h"
#include "server/base/log.h"
#include "server/store/postgres/connection.h"

#define MOST        5                    /* connections, with the one that listens */
#define TAKE_NS     UINT64_C(5000000000) /* for one of them to come free */
#define PATIENCE_NS UINT64_C(3000000000) /* for a transaction to begin anew */
/* of its statements: longer than the server waits for a lock */
#define LONGEST_NS UINT64_C(8000000000)
#define PAUSE_NS   UINT64_C(5000000)   /* the first; each is twice as long as the one before, */
#define PAUSE_MOST UINT64_C(200000000) /* up to this */
#define SECOND_NS  UINT64_C(1000000000)

struct server_postgres {
    pthread_mutex_t lock;
    pthread_cond_t change;
    struct server_postgres_connection *idle; /* under the lock, as the next */
    unsigned count;                          /* of connections, idle or not */
    atomic_bool is_away;
    char url[];
};

struct server_postgres *server_postgres_create(const char *url)
{
    size_t size = strlen(url) + 1;
    struct server_postgres *postgres = calloc(1, sizeof *postgres + size);
    pthread_condattr_t attributes;
    if (!postgres) return NULL;
    memcpy(postgres->url, url, size);
    pthread_mutex_init(&postgres->lock, NULL);
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC); /* that of gd_now_ns */
    pthread_cond_init(&postgres->change, &attributes);
    pthread_condattr_destroy(&attributes);
    return postgres;
}

void server_postgres_destroy(struct server_postgres *postgres)
{
    if (!postgres) return;
    while (postgres->idle) {
        struct server_postgres_connection *next = postgres->idle->next;
        server_postgres_disconnect(postgres->idle);
        postgres->idle = next;
    }
    pthread_cond_destroy(&postgres->change);
    pthread_mutex_destroy(&postgres->lock);
    free(postgres);
}

bool server_postgres_is_away(struct server_postgres *postgres)
{
    return atomic_load(&postgres->is_away);
}

void server_postgres_has_answered(struct server_postgres *postgres)
{
    atomic_store(&postgres->is_away, false);
}

/* --- connections ------------------------------------------------------------------------------ */

/* An idle connection, or leave to make one: then `*out` is NULL. False: all are in use for too
 * long. */
static bool reserve(struct server_postgres *postgres, struct server_postgres_connection **out)
{
    uint64_t until_ns = gd_now_ns() + TAKE_NS;
    const struct timespec until = {.tv_sec = (time_t)(until_ns / SECOND_NS),
                                   .tv_nsec = (long)(until_ns % SECOND_NS)};
    pthread_mutex_lock(&postgres->lock);
    bool has_time = true;
    while (has_time && !postgres->idle && postgres->count >= MOST)
        has_time = pthread_cond_timedwait(&postgres->change, &postgres->lock, &until) == 0;
    *out = postgres->idle;
    bool is_reserved = *out || postgres->count < MOST;
    if (*out)
        postgres->idle = (*out)->next;
    else
        postgres->count += is_reserved;
    pthread_mutex_unlock(&postgres->lock);
    return is_reserved;
}

/* One is idle again, or gone (NULL). */
static void leave(struct server_postgres *postgres, struct server_postgres_connection *connection)
{
    pthread_mutex_lock(&postgres->lock);
    if (connection) {
        connection->next = postgres->idle;
        postgres->idle = connection;
    } else {
        postgres->count--;
    }
    pthread_cond_signal(&postgres->change);
    pthread_mutex_unlock(&postgres->lock);
}

enum server_store_outcome server_postgres_take(struct server_postgres *postgres, bool is_prober,
                                               struct server_postgres_connection **out, char *error)
{
    char own_error[SERVER_POSTGRES_ERROR];
    if (!error) error = own_error;
    snprintf(error, SERVER_POSTGRES_ERROR, "the database is away");
    if (!is_prober && server_postgres_is_away(postgres)) return SERVER_STORE_UNAVAILABLE;
    if (!reserve(postgres, out)) return SERVER_STORE_UNAVAILABLE;
    if (*out) return SERVER_STORE_DONE;
    enum server_store_outcome outcome = server_postgres_connect(postgres->url, out, error);
    if (outcome) leave(postgres, NULL);
    atomic_store(&postgres->is_away, outcome == SERVER_STORE_UNAVAILABLE);
    return outcome;
}

void server_postgres_give(struct server_postgres *postgres,
                          struct server_postgres_connection *connection)
{
    bool is_lost = connection->is_lost;
    if (is_lost) server_postgres_disconnect(connection);
    leave(postgres, is_lost ? NULL : connection);
}

/* --- one attempt ------------------------------------------------------------------------------ */

struct attempt {
    server_postgres_body *body;
    void *user;
    uint64_t patience_ns, longest_ns; /* of all attempts, and of one statement */
    /* of the transaction, once it is asked to commit; empty: it has not come to that */
    char number[32];
};

static bool on_number(void *user, const struct server_sql_value *row)
{
    struct attempt *attempt = user;
    snprintf(attempt->number, sizeof attempt->number, "%s", row[0].bytes);
    return true;
}

static enum server_store_outcome commit(struct server_postgres_connection *connection,
                                        struct attempt *attempt)
{
    enum server_store_outcome outcome = server_postgres_run(
        connection, "SELECT pg_current_xact_id()::text", NULL, 0, on_number, attempt);
    if (!outcome) outcome = server_postgres_run(connection, "COMMIT", NULL, 0, NULL, NULL);
    /* what became of it is known */
    if (outcome != SERVER_STORE_UNAVAILABLE) attempt->number[0] = '\0';
    return outcome;
}

static enum server_store_outcome attempt_transaction(struct server_postgres_connection *connection,
                                                     struct attempt *attempt)
{
    attempt->number[0] = '\0';
    enum server_store_outcome outcome =
        server_postgres_run(connection, "BEGIN", NULL, 0, NULL, NULL);
    if (!outcome) outcome = attempt->body(connection, attempt->user);
    if (!outcome) return commit(connection, attempt);
    if (outcome != SERVER_STORE_UNAVAILABLE)
        (void)server_postgres_run(connection, "ROLLBACK", NULL, 0, NULL, NULL);
    return outcome;
}

static enum server_store_outcome attempt_reading(struct server_postgres_connection *connection,
                                                 struct attempt *attempt)
{
    return attempt->body(connection, attempt->user);
}

/* --- what became of a commit that was not answered -------------------------------------------- */

static bool on_status(void *user, const struct server_sql_value *row)
{
    enum server_store_outcome *outcome = user;
    const char *status = row[0].type == SERVER_SQL_TEXT ? row[0].bytes : "";
    *outcome = strcmp(status, "committed") == 0 ? SERVER_STORE_DONE
               : strcmp(status, "aborted") == 0 ? SERVER_STORE_STALE
                                                /* it is still under way */
                                                : SERVER_STORE_UNAVAILABLE;
    return true;
}

/* DONE: it is committed; STALE: it is not and never will be; UNAVAILABLE: not known for now. */
static enum server_store_outcome look(struct server_postgres_connection *connection,
                                      const struct attempt *attempt)
{
    const struct server_sql_value number = server_sql_text(attempt->number);
    enum server_store_outcome found = SERVER_STORE_UNAVAILABLE;
    enum server_store_outcome outcome = server_postgres_run(
        connection, "SELECT pg_xact_status($1::text::xid8)", &number, 1, on_status, &found);
    return outcome ? SERVER_STORE_UNAVAILABLE : found;
}

/* --- attempts --------------------------------------------------------------------------------- */

static bool pause_until(uint64_t until_ns, uint64_t *pause_ns)
{
    const struct timespec pause = {.tv_nsec = (long)*pause_ns};
    if (gd_now_ns() + *pause_ns >= until_ns) return false;
    nanosleep(&pause, NULL);
    *pause_ns = 2 * *pause_ns < PAUSE_MOST ? 2 * *pause_ns : PAUSE_MOST;
    return true;
}

/* One attempt, or, while it is not known what became of the one before, a look at that. */
/* What the operator should know of. */
static void tell(enum server_store_outcome outcome, const char *error)
{
    if (outcome == SERVER_STORE_REFUSED || outcome == SERVER_STORE_FULL)
        server_log_message(SERVER_LOG_ERROR, "database_refused", "%s", error);
    else if (outcome == SERVER_STORE_UNAVAILABLE)
        server_log_message(SERVER_LOG_WARN, "database_lost", "%s",
                           *error ? error : "others were always quicker");
}

static enum server_store_outcome
go_on(struct server_postgres_connection *connection, struct attempt *attempt,
      enum server_store_outcome (*make)(struct server_postgres_connection *connection,
                                        struct attempt *attempt))
{
    if (!attempt->number[0]) return make(connection, attempt);
    enum server_store_outcome outcome = look(connection, attempt);
    if (outcome == SERVER_STORE_STALE) attempt->number[0] = '\0';
    return outcome;
}

static enum server_store_outcome
try_on(struct server_postgres *postgres, struct attempt *attempt,
       enum server_store_outcome (*make)(struct server_postgres_connection *connection,
                                         struct attempt *attempt))
{
    uint64_t until_ns = gd_now_ns() + attempt->patience_ns, pause_ns = PAUSE_NS;
    enum server_store_outcome outcome;
    char error[SERVER_POSTGRES_ERROR] = "";
    if (server_postgres_is_away(postgres)) return SERVER_STORE_UNAVAILABLE;
    do {
        struct server_postgres_connection *connection;
        outcome = server_postgres_take(postgres, true, &connection, error);
        if (outcome) continue;
        connection->longest_ns = attempt->longest_ns;
        outcome = go_on(connection, attempt, make);
        if (outcome) snprintf(error, sizeof error, "%s", connection->error);
        server_postgres_give(postgres, connection);
    } while ((outcome == SERVER_STORE_UNAVAILABLE || outcome == SERVER_STORE_STALE) &&
             pause_until(until_ns, &pause_ns));
    if (outcome == SERVER_STORE_STALE) outcome = SERVER_STORE_UNAVAILABLE;
    tell(outcome, error);
    return outcome;
}

enum server_store_outcome server_postgres_transact(struct server_postgres *postgres,
                                                   server_postgres_body *body, void *user)
{
    struct attempt attempt = {
        .body = body, .user = user, .patience_ns = PATIENCE_NS, .longest_ns = LONGEST_NS};
    return try_on(postgres, &attempt, attempt_transaction);
}

enum server_store_outcome server_postgres_read(struct server_postgres *postgres,
                                               uint64_t patience_ns, server_postgres_body *body,
                                               void *user)
{
    struct attempt attempt = {
        .body = body, .user = user, .patience_ns = patience_ns, .longest_ns = patience_ns};
    return try_on(postgres, &attempt, attempt_reading);
}
