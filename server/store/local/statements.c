/* See store_sql.h. */
#include <pthread.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/store/local/schema.h"
#include "server/store/store_sql.h"

#define BUSY_MS 5000

struct sql_local {
    struct server_store_sql sql; /* first */
    pthread_mutex_t lock;
    sqlite3 *connection; /* NULL: the database was damaged and can't be made anew as yet */
    char path[SERVER_DISK_PATH];
    const char *const *steps;
};

/* --- values ----------------------------------------------------------------------------------- */

static int bind(sqlite3_stmt *statement, int number, const struct server_sql_value *value)
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

/* --- statements ------------------------------------------------------------------------------- */

struct visitor {
    server_sql_visit *visit; /* NULL: rows are not wanted */
    void *user;
};

/* All steps are made, also when no more rows are wanted. */
static int step_through(sqlite3_stmt *statement, struct visitor visitor)
{
    struct server_sql_value row[SERVER_SQL_VALUES];
    int code, columns = sqlite3_column_count(statement);
    while ((code = sqlite3_step(statement)) == SQLITE_ROW) {
        for (int i = 0; i < columns && i < SERVER_SQL_VALUES; i++)
            row[i] = read_value(statement, i);
        if (visitor.visit && !visitor.visit(visitor.user, row)) visitor.visit = NULL;
    }
    return code;
}

/* --- the file --------------------------------------------------------------------------------- */

static int on_check(void *user, int columns, char **values, char **names)
{
    (void)names;
    *(bool *)user = columns == 1 && values[0] && strcmp(values[0], "ok") == 0;
    return 0;
}

static int set_up(sqlite3 *connection, const char *const *steps)
{
    bool is_sound = false;
    int code = sqlite3_busy_timeout(connection, BUSY_MS);
    if (!code)
        code = sqlite3_exec(connection,
                            "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;"
                            "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL",
                            NULL, NULL, NULL);
    if (!code)
        code = sqlite3_exec(connection, "PRAGMA integrity_check(1)", on_check, &is_sound, NULL);
    if (!code && !is_sound) return SQLITE_CORRUPT;
    for (; !code && *steps; steps++) code = sqlite3_exec(connection, *steps, NULL, NULL, NULL);
    return code;
}

static void disconnect(struct sql_local *own)
{
    sqlite3_close(own->connection);
    own->connection = NULL;
}

static int connect_to(struct sql_local *own)
{
    int code = sqlite3_open(own->path, &own->connection);
    if (!code) code = set_up(own->connection, own->steps);
    if (code) disconnect(own);
    return code;
}

static bool is_damage(int code)
{
    return (code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB;
}

static int replace(struct sql_local *own)
{
    char suffix[SERVER_DISK_ASIDE_SUFFIX];
    disconnect(own);
    server_disk_set_aside(own->path, server_disk_database_parts, suffix);
    server_log_message(SERVER_LOG_ERROR, "batches_damaged",
                       "the database of batches is damaged: it was renamed to %s%s, and there is a "
                       "new one; batches of "
                       "before are lost, send them again",
                       own->path, suffix);
    return connect_to(own);
}

static int open_or_replace(struct sql_local *own)
{
    int code = own->connection ? SQLITE_OK : connect_to(own);
    return is_damage(code) ? replace(own) : code;
}

/* --- statements ------------------------------------------------------------------------------- */

static int run_once(struct sql_local *own, const char *text, const struct server_sql_value *values,
                    int count, struct visitor visitor)
{
    sqlite3_stmt *statement = NULL;
    int code = sqlite3_prepare_v2(own->connection, text, -1, &statement, NULL);
    for (int i = 0; !code && i < count; i++) code = bind(statement, i + 1, &values[i]);
    if (!code) code = step_through(statement, visitor);
    (void)sqlite3_finalize(statement);
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

/* A statement that meets damage is not run again: rows may have been shown. */
static enum server_store_outcome run(struct server_store_sql *sql, const char *text,
                                     const struct server_sql_value *values, int count,
                                     server_sql_visit *visit, void *user)
{
    struct sql_local *own = (struct sql_local *)sql;
    pthread_mutex_lock(&own->lock);
    int code = open_or_replace(own);
    if (!code) code = run_once(own, text, values, count, (struct visitor){visit, user});
    if (is_damage(code)) (void)replace(own);
    pthread_mutex_unlock(&own->lock);
    enum server_store_outcome outcome = server_store_outcome_of(code);
    return outcome == SERVER_STORE_DAMAGED ? SERVER_STORE_READ_ONLY : outcome;
}

/* --- open and close --------------------------------------------------------------------------- */

static void close_sql(struct server_store_sql *sql)
{
    struct sql_local *own = (struct sql_local *)sql;
    disconnect(own);
    pthread_mutex_destroy(&own->lock);
    free(own);
}

struct server_store_sql *server_store_sql_local_open(const char *path, const char *const *steps,
                                                     char *error, size_t error_size)
{
    struct sql_local *own = calloc(1, sizeof *own);
    snprintf(error, error_size, "out of memory");
    if (!own) return NULL;
    own->sql = (struct server_store_sql){.run = run, .skip_locked = "", .close = close_sql};
    own->steps = steps;
    snprintf(own->path, sizeof own->path, "%s", path);
    pthread_mutex_init(&own->lock, NULL);
    int code = open_or_replace(own);
    if (!code) return &own->sql;
    snprintf(error, error_size, "the database %s can't be used: %s", path, sqlite3_errstr(code));
    close_sql(&own->sql);
    return NULL;
}
