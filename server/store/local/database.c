/* See database.h. */
#include "server/store/local/database.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/disk.h"

#define BUSY_MS          5000
#define CHECKPOINT_PAGES 500 /* of the log: 2 MB */

static const char *const schema[] = {
    "CREATE TABLE surfaces (name TEXT PRIMARY KEY, sha256 TEXT NOT NULL, record TEXT NOT NULL,"
    "  uses INTEGER NOT NULL DEFAULT 0, used INTEGER NOT NULL DEFAULT 0) WITHOUT ROWID;"
    "CREATE INDEX surfaces_by_sha256 ON surfaces (sha256);",
    /* kinds and attachments: a name becomes a key (key.h), a hash an object's id (record.h) */
    "ALTER TABLE surfaces RENAME COLUMN name TO key;"
    "ALTER TABLE surfaces RENAME COLUMN sha256 TO file;"
    "ALTER TABLE surfaces ADD COLUMN attachment TEXT;"
    "CREATE INDEX surfaces_by_attachment ON surfaces (attachment);",
};
#define SCHEMA_VERSION ((int)(sizeof schema / sizeof *schema))

enum statement { PUT, REMOVE, COUNT, FIND, NOTE, STATEMENTS };

static const char *const sql[STATEMENTS] = {
    [PUT] = ("INSERT INTO surfaces (key, file, attachment, record) VALUES (?1, ?2, ?3, ?4)"
             " ON CONFLICT (key) DO UPDATE SET file = ?2, attachment = ?3, record = ?4"),
    [REMOVE] = "DELETE FROM surfaces WHERE key = ?1",
    [COUNT] = ("SELECT (SELECT count(*) FROM surfaces WHERE file = ?1)"
               " + (SELECT count(*) FROM surfaces WHERE attachment = ?1)"),
    [FIND] = "SELECT file, attachment FROM surfaces WHERE key = ?1",
    [NOTE] = "UPDATE surfaces SET uses = ?2, used = ?3 WHERE key = ?1",
};

struct server_database {
    sqlite3 *connection;
    sqlite3_stmt *statements[STATEMENTS];
    int log_pages;        /* in the log, after the last commit */
    bool cant_checkpoint; /* one failed: nothing is written any more */
    bool had_no_log;      /* before it was opened to be read: closing removes the log */
};

/* --- SQLite ----------------------------------------------------------------------------------- */

enum server_store_outcome server_sqlite_outcome(int code)
{
    /* the only I/O error that just means a full disk */
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

static int sqlite_run(sqlite3 *connection, const char *text)
{
    return sqlite3_exec(connection, text, NULL, NULL, NULL);
}

int server_sqlite_open(const char *path, int flags, sqlite3 **out)
{
    int code = sqlite3_open_v2(path, out, flags, NULL);
    if (code) return code;
    sqlite3_extended_result_codes(*out, 1);
    sqlite3_busy_timeout(*out, BUSY_MS);
    return sqlite_run(*out, "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;"
                            "PRAGMA temp_store = MEMORY");
}

static int on_check(void *user, int columns, char **values, char **names)
{
    (void)names;
    *(bool *)user = columns == 1 && values[0] && strcmp(values[0], "ok") == 0;
    return 0;
}

int server_sqlite_check(sqlite3 *connection)
{
    bool is_sound = false;
    int code = sqlite3_exec(connection, "PRAGMA integrity_check(1)", on_check, &is_sound, NULL);
    return code || is_sound ? code : SQLITE_CORRUPT;
}

static int sqlite_version(sqlite3 *connection, int *version)
{
    sqlite3_stmt *statement;
    int code = sqlite3_prepare_v2(connection, "PRAGMA user_version", -1, &statement, NULL);
    if (!code && (code = sqlite3_step(statement)) == SQLITE_ROW) {
        *version = sqlite3_column_int(statement, 0);
        code = SQLITE_OK;
    }
    sqlite3_finalize(statement);
    return code;
}

/* Copies to a new file, or to memory. The caller closes `*out` in any case. */
static int sqlite_copy(sqlite3 *connection, const char *path, sqlite3 **out)
{
    int code = sqlite3_open(path, out);
    sqlite3_backup *backup = code ? NULL : sqlite3_backup_init(*out, "main", connection, "main");
    if (backup) (void)sqlite3_backup_step(backup, -1);
    if (backup) (void)sqlite3_backup_finish(backup);
    return sqlite3_extended_errcode(*out);
}

static int run_steps(sqlite3 *connection, const char *const *steps, int from, int to)
{
    char mark[64];
    int code = sqlite_run(connection, "BEGIN IMMEDIATE");
    for (int i = from; !code && i < to; i++) code = sqlite_run(connection, steps[i]);
    snprintf(mark, sizeof mark, "PRAGMA user_version = %d; COMMIT", to);
    if (!code) code = sqlite_run(connection, mark);
    if (code) (void)sqlite_run(connection, "ROLLBACK");
    return code;
}

enum server_store_outcome server_sqlite_migrate(sqlite3 *connection, const char *const *steps,
                                                int version, const char *copy_path)
{
    int from = 0, code = sqlite_version(connection, &from);
    if (code || from == version) return server_sqlite_outcome(code);
    if (from < 0 || from > version) return SERVER_STORE_DAMAGED;
    if (from > 0) {
        sqlite3 *copy;
        code = sqlite_copy(connection, copy_path, &copy);
        sqlite3_close(copy);
    }
    return server_sqlite_outcome(code ? code : run_steps(connection, steps, from, version));
}

/* --- open and close --------------------------------------------------------------------------- */

static int on_commit(void *user, sqlite3 *connection, const char *name, int pages)
{
    (void)connection, (void)name;
    ((struct server_database *)user)->log_pages = pages;
    return SQLITE_OK;
}

static int prepare_all(struct server_database *database)
{
    int code = SQLITE_OK;
    for (int i = 0; !code && i < STATEMENTS; i++)
        code = sqlite3_prepare_v3(database->connection, sql[i], -1, SQLITE_PREPARE_PERSISTENT,
                                  &database->statements[i], NULL);
    return code;
}

static enum server_store_outcome open_to_write(struct server_database *database, const char *path)
{
    char copy[SERVER_DISK_PATH];
    int code =
        server_sqlite_open(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX,
                           &database->connection);
    if (!code)
        code = sqlite_run(database->connection,
                          "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
    if (code) return server_sqlite_outcome(code);
    /* replaces automatic checkpoints */
    sqlite3_wal_hook(database->connection, on_commit, database);
    snprintf(copy, sizeof copy, "%s.before-migration", path);
    enum server_store_outcome outcome =
        server_sqlite_outcome(server_sqlite_check(database->connection));
    if (!outcome)
        outcome = server_sqlite_migrate(database->connection, schema, SCHEMA_VERSION, copy);
    return outcome ? outcome : server_sqlite_outcome(prepare_all(database));
}

static void database_disconnect(struct server_database *database, bool is_sound)
{
    bool may_checkpoint = database->had_no_log || (is_sound && !database->cant_checkpoint);
    if (database->connection && !may_checkpoint)
        sqlite3_db_config(database->connection, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    sqlite3_close(database->connection);
}

/* Replaces a database of an earlier version by a copy in memory, which is migrated. */
static int migrate_in_memory(struct server_database *database, int version)
{
    sqlite3 *copy;
    int code = sqlite_copy(database->connection, ":memory:", &copy);
    if (!code) code = run_steps(copy, schema, version, SCHEMA_VERSION);
    if (code) {
        sqlite3_close(copy);
        return code;
    }
    database_disconnect(database, false);
    database->connection = copy;
    return SQLITE_OK;
}

static enum server_store_outcome open_to_read(struct server_database *database, const char *path,
                                              bool is_store)
{
    char log[SERVER_DISK_PATH + sizeof "-wal"];
    int version = 0;
    snprintf(log, sizeof log, "%s-wal", path);
    database->had_no_log = !server_disk_exists(log);
    if (!server_disk_exists(path)) return SERVER_STORE_ABSENT;
    int code = server_sqlite_open(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX,
                                  &database->connection);
    if (!code && is_store) code = sqlite_version(database->connection, &version);
    if (!code && is_store && version == 0) return SERVER_STORE_ABSENT;
    if (!code) code = server_sqlite_check(database->connection);
    if (!code && is_store && version < SCHEMA_VERSION) code = migrate_in_memory(database, version);
    if (!code && is_store) code = prepare_all(database);
    return server_sqlite_outcome(code);
}

enum server_store_outcome server_database_open(const char *path, enum server_database_use use,
                                               struct server_database **out)
{
    struct server_database *database = calloc(1, sizeof *database);
    if (!database) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome =
        use == SERVER_DATABASE_WRITE ? open_to_write(database, path)
                                     : open_to_read(database, path, use == SERVER_DATABASE_READ);
    if (outcome)
        server_database_close(database, false);
    else
        *out = database;
    return outcome;
}

void server_database_close(struct server_database *database, bool is_sound)
{
    if (!database) return;
    for (int i = 0; i < STATEMENTS; i++) sqlite3_finalize(database->statements[i]);
    database_disconnect(database, is_sound);
    free(database);
}

bool server_database_is_sound(const struct server_database *database)
{
    return !database->cant_checkpoint;
}

const char *server_database_error(struct server_database *database)
{
    return sqlite3_errmsg(database->connection);
}

/* --- statements ------------------------------------------------------------------------------- */

static sqlite3_stmt *bind_key(struct server_database *database, enum statement which,
                              const char *key)
{
    sqlite3_bind_text(database->statements[which], 1, key, -1, SQLITE_STATIC);
    return database->statements[which];
}

/* Moves the log into the database. A failure refuses the next write; the last one is durable. */
static void checkpoint(struct server_database *database, int mode)
{
    enum server_store_outcome outcome = server_sqlite_outcome(
        sqlite3_wal_checkpoint_v2(database->connection, NULL, mode, NULL, NULL));
    database->cant_checkpoint |=
        outcome == SERVER_STORE_READ_ONLY || outcome == SERVER_STORE_DAMAGED;
}

static void checkpoint_when_due(struct server_database *database)
{
    if (database->log_pages >= CHECKPOINT_PAGES) checkpoint(database, SQLITE_CHECKPOINT_PASSIVE);
}

static enum server_store_outcome run_write(struct server_database *database,
                                           sqlite3_stmt *statement)
{
    if (database->cant_checkpoint) return SERVER_STORE_READ_ONLY;
    (void)sqlite3_step(statement);
    int code = sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
    return server_sqlite_outcome(code);
}

enum server_store_outcome server_database_put(struct server_database *database,
                                              const struct server_record *record)
{
    size_t size;
    char *text = server_record_write(record, &size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    struct server_object objects[SERVER_PARTS];
    sqlite3_stmt *statement = bind_key(database, PUT, record->key);
    for (int part = 0; part < SERVER_PARTS; part++) /* unbound: NULL */
        if (server_record_object(record, part, &objects[part]))
            sqlite3_bind_text(statement, 2 + part, objects[part].id, -1, SQLITE_STATIC);
    sqlite3_bind_text64(statement, 2 + SERVER_PARTS, text, size, SQLITE_STATIC, SQLITE_UTF8);
    enum server_store_outcome outcome = run_write(database, statement);
    free(text);
    if (!outcome) checkpoint_when_due(database);
    return outcome;
}

/* Empties the log: damage can cut a log short without a trace. A manifest tells of a lost row, but
 * nothing would tell of a lost deletion. */
enum server_store_outcome server_database_remove(struct server_database *database, const char *key)
{
    enum server_store_outcome outcome = run_write(database, bind_key(database, REMOVE, key));
    if (!outcome) checkpoint(database, SQLITE_CHECKPOINT_TRUNCATE);
    return outcome;
}

enum server_store_outcome server_database_count(struct server_database *database,
                                                const char *object, int64_t *count)
{
    sqlite3_stmt *statement = bind_key(database, COUNT, object);
    if (sqlite3_step(statement) == SQLITE_ROW) *count = sqlite3_column_int64(statement, 0);
    return server_sqlite_outcome(sqlite3_reset(statement));
}

enum server_store_outcome server_database_find(struct server_database *database, const char *key,
                                               char objects[SERVER_PARTS][SERVER_OBJECT])
{
    sqlite3_stmt *statement = bind_key(database, FIND, key);
    int found = sqlite3_step(statement);
    for (int part = 0; found == SQLITE_ROW && part < SERVER_PARTS; part++) {
        const char *id = (const char *)sqlite3_column_text(statement, part);
        snprintf(objects[part], SERVER_OBJECT, "%s", id ? id : "");
    }
    enum server_store_outcome outcome = server_sqlite_outcome(sqlite3_reset(statement));
    return !outcome && found == SQLITE_DONE ? SERVER_STORE_ABSENT : outcome;
}

enum server_store_outcome server_database_note_uses(struct server_database *database,
                                                    const struct server_record *const *records,
                                                    const struct server_store_uses *uses,
                                                    uint32_t count)
{
    enum server_store_outcome outcome =
        server_sqlite_outcome(sqlite_run(database->connection, "BEGIN IMMEDIATE"));
    for (uint32_t i = 0; !outcome && i < count; i++) {
        sqlite3_stmt *statement = bind_key(database, NOTE, records[i]->key);
        sqlite3_bind_int64(statement, 2, (int64_t)uses[i].count);
        sqlite3_bind_int64(statement, 3, uses[i].last);
        outcome = run_write(database, statement);
    }
    if (!outcome) outcome = server_sqlite_outcome(sqlite_run(database->connection, "COMMIT"));
    if (!outcome)
        checkpoint_when_due(database);
    else if (!sqlite3_get_autocommit(database->connection))
        (void)sqlite_run(database->connection, "ROLLBACK");
    return outcome;
}

enum server_store_outcome
server_database_each(struct server_database *database,
                     bool (*visit)(void *user, const struct server_row *row), void *user)
{
    sqlite3_stmt *statement;
    bool go_on = true;
    int code = sqlite3_prepare_v2(database->connection,
                                  "SELECT key, record, uses, used FROM surfaces ORDER BY key", -1,
                                  &statement, NULL);
    while (!code && go_on && sqlite3_step(statement) == SQLITE_ROW) {
        const struct server_row row = {
            .key = (const char *)sqlite3_column_text(statement, 0),
            .text = sqlite3_column_blob(statement, 1),
            .size = (size_t)sqlite3_column_bytes(statement, 1),
            .uses = {.count = (uint64_t)sqlite3_column_int64(statement, 2),
                     .last = sqlite3_column_int64(statement, 3)}};
        if (row.key && row.text) go_on = visit(user, &row);
    }
    int end = sqlite3_finalize(statement);
    return server_sqlite_outcome(code ? code : end);
}

enum server_store_outcome server_database_copy(struct server_database *database, const char *path)
{
    sqlite3 *copy;
    int code = sqlite_copy(database->connection, path, &copy);
    sqlite3_close(copy);
    return server_sqlite_outcome(code);
}
