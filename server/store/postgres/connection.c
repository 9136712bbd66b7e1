/* See postgres_connection.h and postgres.h. */
#include "server/store/postgres/connection.h"

#include <arpa/inet.h>
#include <endian.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/control.h"

#define CONNECT_NS UINT64_C(1500000000)
#define MS         UINT64_C(1000000)

/* Types of PostgreSQL, by their numbers, which never change (its pg_type.dat). */
#define OID_BYTES   17
#define OID_INTEGER 20
#define OID_TEXT    25

/* What every session has: names are found in our schema; a commit is durable before it is told; and
 * a node that is cut off while it changes something keeps the others waiting for no longer than
 * that. */
static const char settings[] =
    "SET search_path = geodesicd; SET client_min_messages = warning; SET lock_timeout = 5000;"
    " SET idle_in_transaction_session_timeout = 10000; SET tcp_keepalives_idle = 10; SET "
    "tcp_keepalives_interval = 5;"
    " SET tcp_keepalives_count = 3; SET bytea_output = hex;"
    " SELECT set_config('synchronous_commit', 'on', false) WHERE "
    "current_setting('synchronous_commit') IN ('off', "
    "'local')";

/* --- errors ----------------------------------------------------------------------------------- */

/* The first line of what libpq says. */
static void note_error(struct server_postgres_connection *connection, const char *message)
{
    snprintf(connection->error, sizeof connection->error, "%.*s", (int)strcspn(message, "\n"),
             message);
}

static enum server_store_outcome lose(struct server_postgres_connection *connection,
                                      const char *why)
{
    if (!connection->is_lost) note_error(connection, why ? why : PQerrorMessage(connection->link));
    connection->is_lost = true;
    return SERVER_STORE_UNAVAILABLE;
}

/* What was noted says why. */
static enum server_store_outcome abandon(struct server_postgres_connection *connection)
{
    connection->is_lost = true;
    return SERVER_STORE_UNAVAILABLE;
}

static bool is_of(const char *state, const char *class_or_code)
{
    return strncmp(state, class_or_code, strlen(class_or_code)) == 0;
}

/* What an error is to us, by its SQLSTATE (PostgreSQL's documentation, appendix A). */
static enum server_store_outcome judge(struct server_postgres_connection *connection,
                                       const PGresult *result)
{
    const char *state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
    note_error(connection, PQresultErrorMessage(result));
    /* of this process */
    if (!state && strstr(connection->error, "out of memory")) return SERVER_STORE_NO_MEMORY;
    if (!state || PQstatus(connection->link) == CONNECTION_BAD) return abandon(connection);
    if (is_of(state, "08") || is_of(state, "57P") || is_of(state, "25006") || is_of(state, "25P0"))
        return abandon(connection); /* it ends, starts, or follows another */
    if (is_of(state, "40") || is_of(state, "23503") || is_of(state, "55P03"))
        return SERVER_STORE_STALE;
    if (is_of(state, "53100")) return SERVER_STORE_FULL;
    if (is_of(state, "53") || is_of(state, "57014")) return abandon(connection);
    return SERVER_STORE_REFUSED;
}

/* --- waiting ---------------------------------------------------------------------------------- */

/* Until the socket is ready for one of the events; false: it was not in time. */
static bool wait_for(PGconn *link, short events, uint64_t until_ns)
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
    while ((left = PQflush(link)) > 0) {
        if (!wait_for(link, POLLIN | POLLOUT, until_ns)) return false;
        if (!PQconsumeInput(link)) return false;
    }
    return left == 0;
}

/* The next result of what was sent; false: lost or late. `*out` is NULL after the last. */
static bool next_result(PGconn *link, uint64_t until_ns, PGresult **out)
{
    while (PQisBusy(link))
        if (!wait_for(link, POLLIN, until_ns) || !PQconsumeInput(link)) return false;
    *out = PQgetResult(link);
    return true;
}

/* --- statements ------------------------------------------------------------------------------- */

struct parameters {
    Oid types[SERVER_SQL_VALUES];
    const char *values[SERVER_SQL_VALUES];
    int sizes[SERVER_SQL_VALUES], formats[SERVER_SQL_VALUES];
    uint64_t integers[SERVER_SQL_VALUES]; /* in the byte order of networks */
};

static void set_parameters(struct parameters *parameters, const struct server_sql_value *values,
                           int count)
{
    for (int i = 0; i < count; i++) {
        const struct server_sql_value *value = &values[i];
        bool is_integer = value->type == SERVER_SQL_INTEGER;
        parameters->integers[i] = htobe64((uint64_t)value->integer);
        parameters->types[i] = is_integer                        ? OID_INTEGER
                               : value->type == SERVER_SQL_BYTES ? OID_BYTES
                                                                 : OID_TEXT;
        parameters->formats[i] = 1;
        parameters->sizes[i] = is_integer ? (int)sizeof(uint64_t) : (int)value->size;
        parameters->values[i] = value->type == SERVER_SQL_NULL ? NULL
                                : is_integer ? (const char *)&parameters->integers[i]
                                             : value->bytes;
    }
}

static struct server_sql_value read_value(const PGresult *result, int row, int column)
{
    struct server_sql_value value = {.bytes = PQgetvalue(result, row, column),
                                     .size = (size_t)PQgetlength(result, row, column)};
    uint64_t integer;
    if (PQgetisnull(result, row, column)) return (struct server_sql_value){.type = SERVER_SQL_NULL};
    switch (PQftype(result, column)) {
    case OID_INTEGER:
        memcpy(&integer, value.bytes, sizeof integer);
        return server_sql_integer((int64_t)be64toh(integer));
    case OID_BYTES:
        value.type = SERVER_SQL_BYTES;
        return value;
    default:
        value.type = SERVER_SQL_TEXT;
        return value;
    }
}

static void show_rows(const PGresult *result, server_sql_visit *visit, void *user)
{
    struct server_sql_value row[SERVER_SQL_VALUES] = {0};
    int columns = PQnfields(result) < SERVER_SQL_VALUES ? PQnfields(result) : SERVER_SQL_VALUES;
    bool goes_on = visit != NULL;
    for (int i = 0; goes_on && i < PQntuples(result); i++) {
        for (int column = 0; column < columns; column++)
            row[column] = read_value(result, i, column);
        goes_on = visit(user, row);
    }
}

/* Shows the rows of all results. */
static enum server_store_outcome receive(struct server_postgres_connection *connection,
                                         uint64_t until_ns, server_sql_visit *visit, void *user)
{
    enum server_store_outcome outcome = SERVER_STORE_DONE;
    PGresult *result;
    for (;;) {
        if (!next_result(connection->link, until_ns, &result))
            return lose(connection, PQstatus(connection->link) == CONNECTION_BAD
                                        ? NULL
                                        : "it did not answer in time");
        if (!result) break;
        ExecStatusType status = PQresultStatus(result);
        if (status == PGRES_TUPLES_OK)
            show_rows(result, visit, user);
        else if (status != PGRES_COMMAND_OK && !outcome)
            outcome = judge(connection, result);
        PQclear(result);
        if (connection->is_lost) break;
    }
    return outcome;
}

enum server_store_outcome server_postgres_run(struct server_postgres_connection *connection,
                                              const char *text,
                                              const struct server_sql_value *values, int count,
                                              server_sql_visit *visit, void *user)
{
    struct parameters parameters;
    uint64_t until_ns = gd_now_ns() + connection->longest_ns;
    if (connection->is_lost) return SERVER_STORE_UNAVAILABLE;
    set_parameters(&parameters, values, count);
    int is_sent =
        count ? PQsendQueryParams(connection->link, text, count, parameters.types,
                                  parameters.values, parameters.sizes, parameters.formats, 1)
              : PQsendQueryParams(connection->link, text, 0, NULL, NULL, NULL, NULL, 1);
    if (!is_sent) {
        bool lacks_memory = strstr(PQerrorMessage(connection->link), "memory") != NULL;
        (void)lose(connection, NULL);
        return lacks_memory ? SERVER_STORE_NO_MEMORY : SERVER_STORE_UNAVAILABLE;
    }
    if (!send_all(connection->link, until_ns)) return lose(connection, NULL);
    return receive(connection, until_ns, visit, user);
}

const char *server_postgres_error(const struct server_postgres_connection *connection)
{
    return connection->error;
}

bool server_postgres_await(struct server_postgres_connection *connection, uint64_t ns)
{
    PGconn *link = connection->link;
    PGnotify *notice = PQnotifies(link);
    if (connection->is_lost) return false;
    if (!notice && wait_for(link, POLLIN, gd_now_ns() + ns) && !PQconsumeInput(link)) {
        (void)lose(connection, NULL);
        return false;
    }
    do PQfreemem(notice);
    while ((notice = PQnotifies(link)));
    return true;
}

/* --- connecting ------------------------------------------------------------------------------- */

static PGconn *begin_connecting(const char *url)
{
    /* what the address says itself comes last, and counts */
    static const char *const names[] = {"gssencmode",
                                        "application_name",
                                        "tcp_user_timeout",
                                        "keepalives_idle",
                                        "keepalives_interval",
                                        "keepalives_count",
                                        "target_session_attrs",
                                        "dbname",
                                        NULL};
    const char *const values[] = {"disable", "geodesicd",  "8000", "10", "5",
                                  "3",       "read-write", url,    NULL};
    return PQconnectStartParams(names, values, 1);
}

static bool end_connecting(PGconn *link, uint64_t until_ns)
{
    PostgresPollingStatusType next = PGRES_POLLING_WRITING;
    while (next != PGRES_POLLING_OK) {
        if (PQstatus(link) == CONNECTION_BAD || next == PGRES_POLLING_FAILED) return false;
        if (!wait_for(link, next == PGRES_POLLING_READING ? POLLIN : POLLOUT, until_ns))
            return false;
        next = PQconnectPoll(link);
    }
    return PQsetnonblocking(link, 1) == 0;
}

static enum server_store_outcome set_up(struct server_postgres_connection *connection)
{
    uint64_t until_ns = gd_now_ns() + CONNECT_NS;
    if (!PQsendQuery(connection->link, settings) || !send_all(connection->link, until_ns))
        return lose(connection, NULL);
    return receive(connection, until_ns, NULL, NULL);
}

static void ignore_notice(void *user, const PGresult *result)
{
    (void)user, (void)result;
}

enum server_store_outcome server_postgres_connect(const char *url,
                                                  struct server_postgres_connection **out,
                                                  char error[SERVER_POSTGRES_ERROR])
{
    struct server_postgres_connection *connection = calloc(1, sizeof *connection);
    snprintf(error, SERVER_POSTGRES_ERROR, "out of memory");
    if (!connection) return SERVER_STORE_NO_MEMORY;
    connection->link = begin_connecting(url);
    if (!connection->link) {
        free(connection);
        return SERVER_STORE_NO_MEMORY;
    }
    connection->longest_ns = CONNECT_NS;
    PQsetNoticeReceiver(connection->link, ignore_notice, NULL);
    enum server_store_outcome outcome =
        end_connecting(connection->link, gd_now_ns() + CONNECT_NS)
            ? set_up(connection)
            : lose(connection,
                   *PQerrorMessage(connection->link) ? NULL : "it did not answer in time");
    if (!outcome) {
        *out = connection;
        return SERVER_STORE_DONE;
    }
    snprintf(error, SERVER_POSTGRES_ERROR, "%s", connection->error);
    server_postgres_disconnect(connection);
    return outcome == SERVER_STORE_NO_MEMORY ? outcome : SERVER_STORE_UNAVAILABLE;
}

void server_postgres_disconnect(struct server_postgres_connection *connection)
{
    PQfinish(connection->link);
    free(connection);
}
