/* See store_schema.h. */
#include "server/store/local/schema.h"

#include <sqlite3.h>
#include <stdio.h>

const char *const server_store_schema[] = {
    "CREATE TABLE surfaces (name TEXT PRIMARY KEY, sha256 TEXT NOT NULL, record TEXT NOT NULL,"
    "  uses INTEGER NOT NULL DEFAULT 0, used INTEGER NOT NULL DEFAULT 0) WITHOUT ROWID;"
    "CREATE INDEX surfaces_by_sha256 ON surfaces (sha256);",
    /* kinds and attachments: what was a name is a key (key.h), what was a hash is an object's id
       (record.h) */
    "ALTER TABLE surfaces RENAME COLUMN name TO key; ALTER TABLE surfaces RENAME COLUMN sha256 TO "
    "file;"
    "ALTER TABLE surfaces ADD COLUMN attachment TEXT; CREATE INDEX surfaces_by_attachment ON "
    "surfaces (attachment);",
};
const int server_store_schema_version = sizeof server_store_schema / sizeof *server_store_schema;

enum server_store_outcome server_store_outcome_of(int code)
{
    /* the only I/O error that is just want of room */
    if (code == SQLITE_IOERR_SHMSIZE) return SERVER_STORE_FULL;
    switch (code & 0xff) {
    case SQLITE_OK:
    case SQLITE_ROW:
    case SQLITE_DONE:
        return SERVER_STORE_DONE;
    case SQLITE_FULL:
        return SERVER_STORE_FULL;
    case SQLITE_NOMEM:
        return SERVER_STORE_NO_MEMORY;
    case SQLITE_IOERR:
        return SERVER_STORE_READ_ONLY;
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_READONLY:
    case SQLITE_BUSY:
    case SQLITE_AUTH:
        return SERVER_STORE_REFUSED;
    default:
        return SERVER_STORE_DAMAGED;
    }
}

enum server_store_outcome server_store_version(sqlite3 *database, int *version)
{
    sqlite3_stmt *statement;
    int code = sqlite3_prepare_v2(database, "PRAGMA user_version", -1, &statement, NULL);
    if (code == SQLITE_OK) code = sqlite3_step(statement);
    if (code == SQLITE_ROW) *version = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return server_store_outcome_of(code);
}

/* A copy in a new file, or in memory; `*out` is to be closed whatever the outcome. */
static enum server_store_outcome open_copy(sqlite3 *database, const char *path, sqlite3 **out)
{
    int code = sqlite3_open(path, out);
    sqlite3_backup *backup = code ? NULL : sqlite3_backup_init(*out, "main", database, "main");
    if (backup) (void)sqlite3_backup_step(backup, -1);
    if (backup) (void)sqlite3_backup_finish(backup);
    return server_store_outcome_of(sqlite3_extended_errcode(*out));
}

enum server_store_outcome server_store_copy(sqlite3 *database, const char *path)
{
    sqlite3 *copy;
    enum server_store_outcome outcome = open_copy(database, path, &copy);
    sqlite3_close(copy);
    return outcome;
}

static enum server_store_outcome run(sqlite3 *database, const char *sql)
{
    return server_store_outcome_of(sqlite3_exec(database, sql, NULL, NULL, NULL));
}

static enum server_store_outcome run_steps(sqlite3 *database, const char *const *steps, int from,
                                           int to)
{
    char mark[64];
    enum server_store_outcome outcome = run(database, "BEGIN IMMEDIATE");
    for (int i = from; !outcome && i < to; i++) outcome = run(database, steps[i]);
    snprintf(mark, sizeof mark, "PRAGMA user_version = %d", to);
    if (!outcome) outcome = run(database, mark);
    if (!outcome) outcome = run(database, "COMMIT");
    if (outcome) (void)run(database, "ROLLBACK");
    return outcome;
}

enum server_store_outcome server_store_migrate(sqlite3 *database, const char *const *steps,
                                               int version, const char *copy_path)
{
    int from = 0;
    enum server_store_outcome outcome = server_store_version(database, &from);
    if (outcome || from == version) return outcome;
    if (from < 0 || from > version) return SERVER_STORE_DAMAGED;
    if (from > 0) outcome = server_store_copy(database, copy_path);
    return outcome ? outcome : run_steps(database, steps, from, version);
}

enum server_store_outcome server_store_lift(sqlite3 *database, sqlite3 **out)
{
    sqlite3 *copy;
    int from = 0;
    enum server_store_outcome outcome = open_copy(database, ":memory:", &copy);
    if (!outcome) outcome = server_store_version(copy, &from);
    if (!outcome) outcome = run_steps(copy, server_store_schema, from, server_store_schema_version);
    if (outcome)
        sqlite3_close(copy);
    else
        *out = copy;
    return outcome;
}
