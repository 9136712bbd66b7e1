/* See sql.h: statements on a SQLite file of the daemon's own, which holds the batches. */
#include "server/store/sql.h"

#include <pthread.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/store/local/database.h"

struct sql_local {
    struct server_store_sql sql; /* first */
    pthread_mutex_t lock;
    sqlite3 *connection; /* NULL: the database was damaged and a new one can't be made yet */
    char path[SERVER_DISK_PATH];
    const char *const *steps;
};

/* --- the file --------------------------------------------------------------------------------- */

static void sql_disconnect(struct sql_local *own)
{
    sqlite3_close(own->connection);
    own->connection = NULL;
}

static int sql_connect(struct sql_local *own)
{
    int code =
        server_sqlite_open(own->path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, &own->connection);
    if (!code)
        code = sqlite3_exec(own->connection, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL",
                            NULL, NULL, NULL);
    if (!code) code = server_sqlite_check(own->connection);
    for (int i = 0; !code && own->steps[i]; i++)
        code = sqlite3_exec(own->connection, own->steps[i], NULL, NULL, NULL);
    if (code) sql_disconnect(own);
    return code;
}

static bool is_damage(int code)
{
    return (code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB;
}

static int sql_replace(struct sql_local *own)
{
    char suffix[SERVER_DISK_ASIDE_SUFFIX];
    sql_disconnect(own);
    server_disk_set_aside(own->path, server_disk_database_parts, suffix);
    server_log_message(SERVER_LOG_ERROR, "batches_damaged",
                       "the database of batches is damaged: it was renamed to %s%s, and there is a "
                       "new one; batches of before are lost, send them again",
                       own->path, suffix);
    return sql_connect(own);
}

static int sql_open_or_replace(struct sql_local *own)
{
    int code = own->connection ? SQLITE_OK : sql_connect(own);
    return is_damage(code) ? sql_replace(own) : code;
}

/* --- statements ------------------------------------------------------------------------------- */

static int value_bind(sqlite3_stmt *statement, int number, const struct server_sql_value *value)
{
    char name[16];
    snprintf(name, sizeof name, "$%d", number);
    int index = sqlite3_bind_parameter_index(statement, name);
    switch (value->type) {
    case SERVER_SQL_INTEGER:
        return sqlite3_bind_int64(statement, index, value->integer);
    case SERVER_SQL_TEXT:
        return sqlite3_bind_text64(statement, index, value->bytes, value->size, SQLITE_STATIC,
                                   SQLITE_UTF8);
    case SERVER_SQL_BYTES:
        return sqlite3_bind_blob64(statement, index, value->size ? value->bytes : "", value->size,
                                   SQLITE_STATIC);
    case SERVER_SQL_NULL:
        break;
    }
    return sqlite3_bind_null(statement, index);
}

static struct server_sql_value value_read(sqlite3_stmt *statement, int column)
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

/* Makes all steps, even if the visitor wants no more rows. */
static int statement_run(sqlite3 *connection, const struct server_sql_statement *what)
{
    struct server_sql_value row[SERVER_SQL_VALUES] = {0};
    sqlite3_stmt *statement = NULL;
    bool visits = what->visit != NULL;
    int code = sqlite3_prepare_v2(connection, what->text, -1, &statement, NULL);
    int columns = sqlite3_column_count(statement);
    for (int i = 0; !code && i < what->count; i++)
        code = value_bind(statement, i + 1, &what->values[i]);
    while (!code && (code = sqlite3_step(statement)) == SQLITE_ROW) {
        for (int i = 0; i < columns && i < SERVER_SQL_VALUES; i++)
            row[i] = value_read(statement, i);
        visits = visits && what->visit(what->user, row);
        code = SQLITE_OK;
    }
    (void)sqlite3_finalize(statement);
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

/* A statement that finds damage is not repeated: its visitor may have seen rows. */
static enum server_store_outcome sql_run(struct server_store_sql *sql,
                                         const struct server_sql_statement *statement)
{
    struct sql_local *own = (struct sql_local *)sql;
    pthread_mutex_lock(&own->lock);
    int code = sql_open_or_replace(own);
    if (!code) code = statement_run(own->connection, statement);
    if (is_damage(code)) (void)sql_replace(own);
    pthread_mutex_unlock(&own->lock);
    enum server_store_outcome outcome = server_sqlite_outcome(code);
    return outcome == SERVER_STORE_DAMAGED ? SERVER_STORE_READ_ONLY : outcome;
}

static void sql_close(struct server_store_sql *sql)
{
    struct sql_local *own = (struct sql_local *)sql;
    sql_disconnect(own);
    pthread_mutex_destroy(&own->lock);
    free(own);
}

struct server_store_sql *server_store_sql_local_open(const char *path, const char *const *steps,
                                                     char *error, size_t error_size)
{
    struct sql_local *own = calloc(1, sizeof *own);
    snprintf(error, error_size, "out of memory");
    if (!own) return NULL;
    own->sql = (struct server_store_sql){.run = sql_run, .skip_locked = "", .close = sql_close};
    own->steps = steps;
    snprintf(own->path, sizeof own->path, "%s", path);
    pthread_mutex_init(&own->lock, NULL);
    int code = sql_open_or_replace(own);
    if (!code) return &own->sql;
    snprintf(error, error_size, "the database %s can't be used: %s", path, sqlite3_errstr(code));
    sql_close(&own->sql);
    return NULL;
}
