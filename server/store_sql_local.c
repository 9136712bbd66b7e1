/* See store_sql.h. */
#include <pthread.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/store_schema.h"
#include "server/store_sql.h"

#define BUSY_MS 5000

struct sql_local {
    struct server_store_sql sql; /* first */
    pthread_mutex_t lock;
    sqlite3 *connection;
};

/* --- values ------------------------------------------------------------------------------------------------------- */

static int bind(sqlite3_stmt *statement, int number, const struct server_sql_value *value)
{
    char name[16];
    snprintf(name, sizeof name, "$%d", number);
    int index = sqlite3_bind_parameter_index(statement, name);
    switch (value->type) {
    case SERVER_SQL_INTEGER:
        return sqlite3_bind_int64(statement, index, value->integer);
    case SERVER_SQL_TEXT:
        return sqlite3_bind_text64(statement, index, value->bytes, value->size, SQLITE_STATIC, SQLITE_UTF8);
    case SERVER_SQL_BYTES:
        return sqlite3_bind_blob64(statement, index, value->size ? value->bytes : "", value->size, SQLITE_STATIC);
    case SERVER_SQL_NULL:
        break;
    }
    return sqlite3_bind_null(statement, index);
}

static struct server_sql_value read_value(sqlite3_stmt *statement, int column)
{
    switch (sqlite3_column_type(statement, column)) {
    case SQLITE_INTEGER:
        return server_sql_integer(sqlite3_column_int64(statement, column));
    case SQLITE_TEXT:
        return server_sql_text((const char *)sqlite3_column_text(statement, column));
    case SQLITE_BLOB:
        return server_sql_bytes(sqlite3_column_blob(statement, column),
                                (size_t)sqlite3_column_bytes(statement, column));
    default:
        return (struct server_sql_value){.type = SERVER_SQL_NULL};
    }
}

/* --- statements --------------------------------------------------------------------------------------------------- */

/* All steps are made, also when no more rows are wanted. */
static int step_through(sqlite3_stmt *statement, server_sql_visit *visit, void *user)
{
    struct server_sql_value row[SERVER_SQL_VALUES];
    int code, columns = sqlite3_column_count(statement);
    while ((code = sqlite3_step(statement)) == SQLITE_ROW) {
        for (int i = 0; i < columns && i < SERVER_SQL_VALUES; i++) row[i] = read_value(statement, i);
        if (visit && !visit(user, row)) visit = NULL;
    }
    return code;
}

static enum server_store_outcome run(struct server_store_sql *sql, const char *text,
                                     const struct server_sql_value *values, int count, server_sql_visit *visit,
                                     void *user)
{
    struct sql_local *own = (struct sql_local *)sql;
    sqlite3_stmt *statement = NULL;
    pthread_mutex_lock(&own->lock);
    int code = sqlite3_prepare_v2(own->connection, text, -1, &statement, NULL);
    for (int i = 0; !code && i < count; i++) code = bind(statement, i + 1, &values[i]);
    if (!code) code = step_through(statement, visit, user);
    if (code == SQLITE_DONE) code = SQLITE_OK;
    (void)sqlite3_finalize(statement);
    enum server_store_outcome outcome = server_store_outcome_of(code);
    pthread_mutex_unlock(&own->lock);
    return outcome == SERVER_STORE_DAMAGED ? SERVER_STORE_READ_ONLY : outcome;
}

/* --- open and close ----------------------------------------------------------------------------------------------- */

static void close_sql(struct server_store_sql *sql)
{
    struct sql_local *own = (struct sql_local *)sql;
    sqlite3_close(own->connection);
    pthread_mutex_destroy(&own->lock);
    free(own);
}

static int set_up(sqlite3 *connection, const char *const *steps)
{
    int code = sqlite3_busy_timeout(connection, BUSY_MS);
    if (!code)
        code = sqlite3_exec(connection, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL", NULL, NULL, NULL);
    for (; !code && *steps; steps++) code = sqlite3_exec(connection, *steps, NULL, NULL, NULL);
    return code;
}

struct server_store_sql *server_store_sql_local_open(const char *path, const char *const *steps, char *error,
                                                     size_t error_size)
{
    struct sql_local *own = calloc(1, sizeof *own);
    snprintf(error, error_size, "out of memory");
    if (!own) return NULL;
    own->sql = (struct server_store_sql){.run = run, .skip_locked = "", .close = close_sql};
    pthread_mutex_init(&own->lock, NULL);
    int code = sqlite3_open(path, &own->connection);
    if (!code) code = set_up(own->connection, steps);
    if (!code) return &own->sql;
    snprintf(error, error_size, "the database %s can't be used: %s", path, sqlite3_errstr(code));
    close_sql(&own->sql);
    return NULL;
}
