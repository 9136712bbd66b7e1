#include "server/store/postgres/connection.h"

#include <endian.h>
#include <errno.h>
#include <poll.h>
#include <postgresql/libpq-fe.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "gd/control.h"
#include "server/base/log.h"
#include "server/base/thread.h"

#define CONNECT_NS UINT64_C(1500000000)
/* largest number of connections, including that of the listener */
#define CONNECTIONS 5
#define TAKE_NS     UINT64_C(5000000000) /* longest wait for a connection */
#define PATIENCE_NS UINT64_C(3000000000) /* longest time for which a transaction is retried */
/* deadline of the statements of a transaction; longer than the server's lock_timeout */
#define LONGEST_NS UINT64_C(8000000000)
/* first pause between two attempts; each further pause is twice as long */
#define PAUSE_NS   UINT64_C(5000000)
#define PAUSE_MOST UINT64_C(200000000) /* longest pause */
#define MS         UINT64_C(1000000)

/* Fixed numbers of types: PostgreSQL's pg_type.dat. */
#define OID_BYTES   17
#define OID_INTEGER 20
#define OID_TEXT    25

/* Settings of every session: the schema, durable commits, and timeouts. The timeouts limit how long
 * a daemon blocks other daemons if it loses its connection during a change. */
static const char settings[] =
    "SET search_path = geodesicd; SET client_min_messages = warning; SET lock_timeout = 5000;"
    " SET idle_in_transaction_session_timeout = 10000; SET tcp_keepalives_idle = 10;"
    " SET tcp_keepalives_interval = 5; SET tcp_keepalives_count = 3; SET bytea_output = hex;"
    " SELECT set_config('synchronous_commit', 'on', false)"
    " WHERE current_setting('synchronous_commit') IN ('off', 'local')";

struct server_pg {
    PGconn *link;
    bool is_lost;
    uint64_t longest_ns; /* deadline of a statement */
    struct server_pg *next;
    char error[SERVER_PG_ERROR]; /* message of the last failure, in one line */
};

struct server_pg_pool {
    struct server_store_sql sql; /* must be the first member */
    pthread_mutex_t lock;
    pthread_cond_t change;
    struct server_pg *idle; /* under the lock */
    unsigned used;          /* number of connections that are not idle; guarded by the lock */
    atomic_bool is_away;
    char url[];
};

/* --- errors ----------------------------------------------------------------------------------- */

/* Keeps the first line of a message. */
static void error_note(struct server_pg *pg, const char *message)
{
    snprintf(pg->error, sizeof pg->error, "%.*s", (int)strcspn(message, "\n"), message);
}

static enum server_outcome connection_lose(struct server_pg *pg)
{
    const char *message = PQerrorMessage(pg->link);
    if (!pg->is_lost) error_note(pg, *message ? message : "it did not answer in time");
    pg->is_lost = true;
    return SERVER_STORE_UNAVAILABLE;
}

/* Returns the outcome of an error, by its SQLSTATE (PostgreSQL's documentation, appendix A). */
static enum server_outcome error_outcome(struct server_pg *pg, const PGresult *result)
{
    static const struct {
        const char *state; /* or its beginning */
        enum server_outcome outcome;
    } outcomes[] = {
        /* these four codes: the server stops, starts or is a standby */
        {"08", SERVER_STORE_UNAVAILABLE},    {"57P", SERVER_STORE_UNAVAILABLE},
        {"25006", SERVER_STORE_UNAVAILABLE}, {"25P0", SERVER_STORE_UNAVAILABLE},
        {"40", SERVER_STORE_STALE},          {"23503", SERVER_STORE_STALE},
        {"23505", SERVER_STORE_STALE},       {"55P03", SERVER_STORE_STALE},
        {"53100", SERVER_STORE_FULL},        {"53", SERVER_STORE_UNAVAILABLE},
        {"57014", SERVER_STORE_UNAVAILABLE},
    };
    const char *state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
    enum server_outcome outcome = SERVER_STORE_REFUSED;
    error_note(pg, PQresultErrorMessage(result));
    if (!state && strstr(pg->error, "out of memory")) return SERVER_STORE_NO_MEMORY;
    if (!state || PQstatus(pg->link) == CONNECTION_BAD) outcome = SERVER_STORE_UNAVAILABLE;
    for (size_t i = 0; outcome == SERVER_STORE_REFUSED && i < sizeof outcomes / sizeof *outcomes;
         i++)
        if (strncmp(state, outcomes[i].state, strlen(outcomes[i].state)) == 0)
            outcome = outcomes[i].outcome;
    pg->is_lost |= outcome == SERVER_STORE_UNAVAILABLE;
    return outcome;
}

/* --- statements ------------------------------------------------------------------------------- */

/* Waits until the socket is ready for one of the events. Returns false if it is not ready in
 * time. */
static bool socket_wait(PGconn *link, short events, uint64_t until_ns)
{
    for (;;) {
        uint64_t now_ns = gd_now_ns();
        struct pollfd socket = {.fd = PQsocket(link), .events = events};
        if (socket.fd < 0 || now_ns >= until_ns) return false;
        int ready = poll(&socket, 1, (int)((until_ns - now_ns + MS - 1) / MS));
        if (ready > 0) return true;
        if (ready < 0 && errno != EINTR) return false;
    }
}

static bool send_all(PGconn *link, uint64_t until_ns)
{
    int left;
    while ((left = PQflush(link)) > 0)
        if (!socket_wait(link, POLLIN | POLLOUT, until_ns) || !PQconsumeInput(link)) return false;
    return left == 0;
}

static struct server_sql_value value_read(const PGresult *result, int row, int column)
{
    const char *bytes = PQgetvalue(result, row, column);
    uint64_t integer;
    if (PQgetisnull(result, row, column)) return server_sql_text(NULL);
    struct server_sql_value value =
        server_sql_bytes(bytes, (size_t)PQgetlength(result, row, column));
    if (PQftype(result, column) == OID_INTEGER) {
        memcpy(&integer, bytes, sizeof integer);
        return server_sql_integer((int64_t)be64toh(integer));
    }
    if (PQftype(result, column) != OID_BYTES) value.type = SERVER_SQL_TEXT;
    return value;
}

static void rows_visit(const PGresult *result, server_sql_visit *visit, void *user)
{
    struct server_sql_value row[SERVER_SQL_VALUES] = {0};
    int columns = PQnfields(result) < SERVER_SQL_VALUES ? PQnfields(result) : SERVER_SQL_VALUES;
    bool goes_on = visit != NULL;
    for (int i = 0; goes_on && i < PQntuples(result); i++) {
        for (int column = 0; column < columns; column++)
            row[column] = value_read(result, i, column);
        goes_on = visit(user, row);
    }
}

/* Sends the queued statement and visits the rows of all results. */
static enum server_outcome results_receive(struct server_pg *pg, uint64_t until_ns,
                                           server_sql_visit *visit, void *user)
{
    PGconn *link = pg->link;
    enum server_outcome outcome = SERVER_STORE_DONE;
    if (!send_all(link, until_ns)) return connection_lose(pg);
    while (!pg->is_lost) {
        while (PQisBusy(link))
            if (!socket_wait(link, POLLIN, until_ns) || !PQconsumeInput(link))
                return connection_lose(pg);
        PGresult *result = PQgetResult(link);
        if (!result) break;
        ExecStatusType status = PQresultStatus(result);
        if (status == PGRES_TUPLES_OK)
            rows_visit(result, visit, user);
        else if (status != PGRES_COMMAND_OK && !outcome)
            outcome = error_outcome(pg, result);
        PQclear(result);
    }
    return outcome;
}

enum server_outcome server_pg_run(struct server_pg *pg, const struct server_statement *statement)
{
    Oid types[SERVER_SQL_VALUES];
    const char *values[SERVER_SQL_VALUES];
    int sizes[SERVER_SQL_VALUES], formats[SERVER_SQL_VALUES];
    uint64_t integers[SERVER_SQL_VALUES]; /* big-endian */
    if (pg->is_lost) return SERVER_STORE_UNAVAILABLE;
    for (int i = 0; i < statement->count; i++) {
        const struct server_sql_value *value = &statement->values[i];
        bool is_integer = value->type == SERVER_SQL_INTEGER;
        integers[i] = htobe64((uint64_t)value->integer);
        types[i] = is_integer                        ? OID_INTEGER
                   : value->type == SERVER_SQL_BYTES ? OID_BYTES
                                                     : OID_TEXT;
        formats[i] = 1;
        sizes[i] = is_integer ? (int)sizeof(uint64_t) : (int)value->size;
        /* a NULL pointer is the SQL value NULL */
        values[i] = is_integer ? (const char *)&integers[i] : value->bytes;
    }
    if (!PQsendQueryParams(pg->link, statement->text, statement->count, types, values, sizes,
                           formats, 1)) {
        (void)connection_lose(pg);
        return strstr(pg->error, "memory") ? SERVER_STORE_NO_MEMORY : SERVER_STORE_UNAVAILABLE;
    }
    return results_receive(pg, gd_now_ns() + pg->longest_ns, statement->visit, statement->user);
}

bool server_pg_await(struct server_pg *pg, uint64_t ns)
{
    PGconn *link = pg->link;
    PGnotify *notice = PQnotifies(link);
    if (pg->is_lost) return false;
    if (!notice && socket_wait(link, POLLIN, gd_now_ns() + ns) && !PQconsumeInput(link)) {
        (void)connection_lose(pg);
        return false;
    }
    do PQfreemem(notice);
    while ((notice = PQnotifies(link)));
    return true;
}

/* --- connecting ------------------------------------------------------------------------------- */

static void on_notice(void *user, const PGresult *result)
{
    (void)user, (void)result;
}

static PGconn *connect_begin(const char *url)
{
    /* the address is last, so that its values replace the others */
    enum { COUNT = 9 };
    const char *const parameters[COUNT][2] = {{"gssencmode", "disable"},
                                              {"application_name", "geodesicd"},
                                              {"tcp_user_timeout", "8000"},
                                              {"keepalives_idle", "10"},
                                              {"keepalives_interval", "5"},
                                              {"keepalives_count", "3"},
                                              {"target_session_attrs", "read-write"},
                                              {"dbname", url},
                                              {NULL, NULL}};
    const char *names[COUNT], *values[COUNT];
    for (int i = 0; i < COUNT; i++) {
        names[i] = parameters[i][0];
        values[i] = parameters[i][1];
    }
    return PQconnectStartParams(names, values, 1);
}

static bool connect_end(PGconn *link, uint64_t until_ns)
{
    PostgresPollingStatusType next = PGRES_POLLING_WRITING;
    while (next != PGRES_POLLING_OK) {
        if (PQstatus(link) == CONNECTION_BAD || next == PGRES_POLLING_FAILED) return false;
        if (!socket_wait(link, next == PGRES_POLLING_READING ? POLLIN : POLLOUT, until_ns))
            return false;
        next = PQconnectPoll(link);
    }
    return PQsetnonblocking(link, 1) == 0;
}

static void connection_close(struct server_pg *pg)
{
    PQfinish(pg->link);
    free(pg);
}

static enum server_outcome connection_open(const char *url, struct server_pg **out,
                                           char error[SERVER_PG_ERROR])
{
    struct server_pg *pg = calloc(1, sizeof *pg);
    enum server_outcome outcome = SERVER_STORE_NO_MEMORY;
    snprintf(error, SERVER_PG_ERROR, "out of memory");
    if (!pg) return outcome;
    if ((pg->link = connect_begin(url))) {
        PQsetNoticeReceiver(pg->link, on_notice, NULL);
        bool is_open =
            connect_end(pg->link, gd_now_ns() + CONNECT_NS) && PQsendQuery(pg->link, settings);
        outcome = is_open ? results_receive(pg, gd_now_ns() + CONNECT_NS, NULL, NULL)
                          : connection_lose(pg);
        snprintf(error, SERVER_PG_ERROR, "%s", pg->error);
    }
    if (outcome)
        connection_close(pg);
    else
        *out = pg;
    return outcome && outcome != SERVER_STORE_NO_MEMORY ? SERVER_STORE_UNAVAILABLE : outcome;
}

/* --- the pool --------------------------------------------------------------------------------- */

struct server_pg_pool *server_pg_pool_create(const char *url)
{
    size_t size = strlen(url) + 1;
    struct server_pg_pool *pool = calloc(1, sizeof *pool + size);
    if (!pool) return NULL;
    memcpy(pool->url, url, size);
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->change, NULL);
    return pool;
}

void server_pg_pool_destroy(struct server_pg_pool *pool)
{
    if (!pool) return;
    while (pool->idle) {
        struct server_pg *next = pool->idle->next;
        connection_close(pool->idle);
        pool->idle = next;
    }
    pthread_cond_destroy(&pool->change);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
}

bool server_pg_pool_is_away(struct server_pg_pool *pool)
{
    return atomic_load(&pool->is_away);
}

void server_pg_pool_has_answered(struct server_pg_pool *pool)
{
    atomic_store(&pool->is_away, false);
}

/* Returns a connection to the pool. NULL stands for a connection that was closed. */
static void pool_return(struct server_pg_pool *pool, struct server_pg *pg)
{
    SERVER_LOCK(&pool->lock);
    if (pg) pg->next = pool->idle;
    if (pg) pool->idle = pg;
    pool->used--;
    pthread_cond_signal(&pool->change);
}

enum server_outcome server_pg_pool_take(struct server_pg_pool *pool, struct server_pg **out,
                                        char error[SERVER_PG_ERROR])
{
    uint64_t until_ns = gd_now_ns() + TAKE_NS;
    bool has_time = true;
    snprintf(error, SERVER_PG_ERROR, "the database is away");
    pthread_mutex_lock(&pool->lock);
    while (has_time && pool->used == CONNECTIONS)
        has_time = server_condition_wait(&pool->change, &pool->lock, until_ns);
    bool is_reserved = pool->used < CONNECTIONS;
    pool->used += is_reserved;
    *out = is_reserved ? pool->idle : NULL;
    if (*out) pool->idle = (*out)->next;
    pthread_mutex_unlock(&pool->lock);
    if (!is_reserved || *out) return is_reserved ? SERVER_STORE_DONE : SERVER_STORE_UNAVAILABLE;
    enum server_outcome outcome = connection_open(pool->url, out, error);
    if (outcome) pool_return(pool, NULL);
    atomic_store(&pool->is_away, outcome == SERVER_STORE_UNAVAILABLE);
    return outcome;
}

void server_pg_pool_give(struct server_pg_pool *pool, struct server_pg *pg)
{
    bool is_lost = pg->is_lost;
    if (is_lost) connection_close(pg);
    pool_return(pool, is_lost ? NULL : pg);
}

/* --- transactions ----------------------------------------------------------------------------- */

struct server_pg_attempt server_pg_transaction(struct server_pg_pool *pool)
{
    return (struct server_pg_attempt){
        .pool = pool, .is_transaction = true, .patience_ns = PATIENCE_NS, .longest_ns = LONGEST_NS};
}

struct server_pg_attempt server_pg_reading(struct server_pg_pool *pool, uint64_t patience_ns)
{
    return (struct server_pg_attempt){
        .pool = pool, .patience_ns = patience_ns, .longest_ns = patience_ns};
}

static enum server_outcome attempt_commit(struct server_pg_attempt *attempt)
{
    struct server_sql_integers number = {0};
    enum server_outcome outcome =
        server_pg_run(attempt->pg, SERVER_SQL("SELECT pg_current_xact_id()::text::bigint", NULL, 0,
                                              server_sql_on_integers, &number));
    if (!outcome) outcome = server_pg_run(attempt->pg, SERVER_SQL("COMMIT"));
    attempt->number = outcome == SERVER_STORE_UNAVAILABLE ? number.at[0] : 0;
    return outcome;
}

/* Queries the status of a transaction whose COMMIT was not answered. Returns DONE if the
 * transaction was committed, STALE if it was aborted, UNAVAILABLE if it is in progress or its
 * status is unknown. */
static enum server_outcome attempt_ask(struct server_pg_attempt *attempt)
{
    struct server_sql_integers ended = {0};
    if (server_pg_run(attempt->pg,
                      SERVER_SQL("SELECT (status = 'committed')::int::bigint"
                                 " FROM pg_xact_status($1::bigint::text::xid8) AS status"
                                 " WHERE status IN ('committed', 'aborted')",
                                 SERVER_VALUES(server_sql_integer(attempt->number)),
                                 server_sql_on_integers, &ended)) ||
        !ended.rows)
        return SERVER_STORE_UNAVAILABLE;
    attempt->number = 0;
    return ended.at[0] ? SERVER_STORE_DONE : SERVER_STORE_STALE;
}

/* Waits before the next attempt, each time longer. Returns false if there is no time for another
 * attempt. */
static bool attempt_pause(struct server_pg_attempt *attempt)
{
    if (gd_now_ns() + attempt->pause_ns >= attempt->until_ns) return false;
    server_pause(attempt->pause_ns);
    attempt->pause_ns = 2 * attempt->pause_ns < PAUSE_MOST ? 2 * attempt->pause_ns : PAUSE_MOST;
    return true;
}

static void attempt_release(struct server_pg_attempt *attempt)
{
    if (attempt->outcome) snprintf(attempt->error, sizeof attempt->error, "%s", attempt->pg->error);
    server_pg_pool_give(attempt->pool, attempt->pg);
    attempt->pg = NULL;
}

/* Begins an attempt. Returns false if the outcome is already set. */
static bool attempt_begin(struct server_pg_attempt *attempt)
{
    attempt->outcome = server_pg_pool_take(attempt->pool, &attempt->pg, attempt->error);
    if (attempt->outcome) return false;
    attempt->pg->longest_ns = attempt->longest_ns;
    bool asks = attempt->number != 0;
    if (asks)
        attempt->outcome = attempt_ask(attempt);
    else if (attempt->is_transaction)
        attempt->outcome = server_pg_run(attempt->pg, SERVER_SQL("BEGIN"));
    if (!asks && !attempt->outcome) return true;
    attempt_release(attempt);
    return false;
}

bool server_pg_next(struct server_pg_attempt *attempt)
{
    bool is_first = !attempt->until_ns;
    if (is_first) {
        attempt->until_ns = gd_now_ns() + attempt->patience_ns;
        attempt->pause_ns = PAUSE_NS;
        attempt->outcome = SERVER_STORE_UNAVAILABLE;
        if (server_pg_pool_is_away(attempt->pool)) return false;
    } else {
        if (attempt->is_transaction && !attempt->outcome)
            attempt->outcome = attempt_commit(attempt);
        else if (attempt->is_transaction && attempt->outcome != SERVER_STORE_UNAVAILABLE)
            (void)server_pg_run(attempt->pg, SERVER_SQL("ROLLBACK"));
        attempt_release(attempt);
    }
    while (
        (attempt->outcome == SERVER_STORE_UNAVAILABLE || attempt->outcome == SERVER_STORE_STALE) &&
        (is_first || attempt_pause(attempt))) {
        is_first = false;
        if (attempt_begin(attempt)) return true;
    }
    if (attempt->outcome == SERVER_STORE_STALE) attempt->outcome = SERVER_STORE_UNAVAILABLE;
    if (attempt->outcome == SERVER_STORE_REFUSED || attempt->outcome == SERVER_STORE_FULL)
        server_log_message(SERVER_LOG_ERROR, "database_refused", "%s", attempt->error);
    else if (attempt->outcome == SERVER_STORE_UNAVAILABLE)
        server_log_message(SERVER_LOG_WARN, "database_lost", "%s",
                           *attempt->error ? attempt->error
                                           : "changes of other daemons always came first");
    return false;
}

/* --- statements for the batches (sql.h) ------------------------------------------------------- */

static enum server_outcome pg_sql_run(struct server_store_sql *sql,
                                      const struct server_statement *statement)
{
    struct server_pg_attempt attempt = server_pg_reading((struct server_pg_pool *)sql, TAKE_NS);
    while (server_pg_next(&attempt)) attempt.outcome = server_pg_run(attempt.pg, statement);
    return attempt.outcome;
}

static void pg_sql_close(struct server_store_sql *sql)
{
    server_pg_pool_destroy((struct server_pg_pool *)sql);
}

struct server_store_sql *server_store_sql_postgres_open(const char *url)
{
    struct server_pg_pool *pool = server_pg_pool_create(url);
    if (!pool) return NULL;
    pool->sql = (struct server_store_sql){.run = pg_sql_run,
                                          .is_shared = true,
                                          .skip_locked = " FOR UPDATE OF i SKIP LOCKED",
                                          .close = pg_sql_close};
    return &pool->sql;
}

/* --- the address (store.h) -------------------------------------------------------------------- */

#define STANDARD_PORT "5432"
#define VALUE         4096

/* Copies the value of a keyword from the address. If the address does not set it, copies the value
 * of the environment, or "". Returns false if the address is malformed. */
static bool address_value(const char *url, const char *keyword, char value[VALUE])
{
    PQconninfoOption *given = PQconninfoParse(url, NULL),
                     *standard = given ? PQconndefaults() : NULL;
    bool is_read = given && standard;
    *value = '\0';
    for (int i = 0; is_read && given[i].keyword; i++) { /* both arrays are in libpq's order */
        const char *found = given[i].val ? given[i].val : standard[i].val;
        if (found && strcmp(given[i].keyword, keyword) == 0) snprintf(value, VALUE, "%s", found);
    }
    PQconninfoFree(given);
    PQconninfoFree(standard);
    return is_read;
}

bool server_postgres_each_port(const char *url, bool (*visit)(void *user, uint16_t port),
                               void *user)
{
    /* such as "5432,5433": one port for each host, or one for all */
    char list[VALUE], *rest = list;
    bool goes_on = address_value(url, "port", list);
    if (!*list) strcpy(list, STANDARD_PORT);
    for (char *port; goes_on && (port = strsep(&rest, ","));)
        goes_on = visit(user, (uint16_t)strtoul(*port ? port : STANDARD_PORT, NULL, 10));
    return goes_on;
}

bool server_postgres_each_file(const char *url, void (*visit)(void *user, const char *file),
                               void *user)
{
    static const char *const keywords[] = {"sslcert", "sslkey",    "sslrootcert",
                                           "sslcrl",  "sslcrldir", "passfile"};
    const char *home = getenv("HOME");
    char value[VALUE] = "";
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++) {
        if (!address_value(url, keywords[i], value)) return false;
        if (*value) visit(user, value);
    }
    bool has_home = !*value && home && *home; /* `value` is the value of passfile */
    if (has_home && snprintf(value, sizeof value, "%s/.pgpass", home) < (int)sizeof value)
        visit(user, value);
    return true;
}
