/* See sql.h: statements on a SQLite file of the daemon's own, which holds the batches. */
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

/* A statement that finds damage is not repeated: its visitor may have seen rows. */
static enum server_store_outcome sql_run(struct server_store_sql *sql,
                                         const struct server_statement *statement)
{
    struct sql_local *own = (struct sql_local *)sql;
    pthread_mutex_lock(&own->lock);
    int code = sql_open_or_replace(own);
    if (!code) code = server_sqlite_run(own->connection, statement);
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
