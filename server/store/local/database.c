/* See store_database.h. */
#include "server/store/local/database.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/disk.h"
#include "server/store/local/schema.h"

#define BUSY_MS          5000
#define CHECKPOINT_PAGES 500 /* of the log: 2 MB */

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
    /* opened to be read, when it was closed: then the log that this makes goes with it */
    bool had_no_log;
};

/* --- open and close --------------------------------------------------------------------------- */

static int on_commit(void *user, sqlite3 *connection, const char *name, int pages)
{
    struct server_database *database = user;
    (void)connection, (void)name;
    database->log_pages = pages;
    return SQLITE_OK;
}

static enum server_store_outcome run(struct server_database *database, const char *text)
{
    (void)sqlite3_exec(database->connection, text, NULL, NULL, NULL);
    return server_store_outcome_of(sqlite3_extended_errcode(database->connection));
}

/* The first line of the check's answer is "ok" when there is nothing to complain of. */
static int on_check(void *user, int columns, char **values, char **names)
{
    bool *is_sound = user;
    (void)names;
    *is_sound = columns == 1 && values[0] && strcmp(values[0], "ok") == 0;
    return 0;
}

static enum server_store_outcome check_all(struct server_database *database)
{
    bool is_sound = false;
    int code =
        sqlite3_exec(database->connection, "PRAGMA integrity_check(1)", on_check, &is_sound, NULL);
    if (code) return server_store_outcome_of(code);
    return is_sound ? SERVER_STORE_DONE : SERVER_STORE_DAMAGED;
}

static enum server_store_outcome prepare(struct server_database *database)
{
    for (int i = 0; i < STATEMENTS; i++) {
        int code = sqlite3_prepare_v3(database->connection, sql[i], -1, SQLITE_PREPARE_PERSISTENT,
                                      &database->statements[i], NULL);
        if (code) return server_store_outcome_of(code);
    }
    return SERVER_STORE_DONE;
}

static enum server_store_outcome connect_to(struct server_database *database, const char *path,
                                            int flags)
{
    int code = sqlite3_open_v2(path, &database->connection, flags | SQLITE_OPEN_NOMUTEX, NULL);
    if (code) return server_store_outcome_of(code);
    sqlite3_extended_result_codes(database->connection, 1);
    sqlite3_busy_timeout(database->connection, BUSY_MS);
    return run(
        database,
        "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY");
}

static enum server_store_outcome make_ready(struct server_database *database, const char *path)
{
    char copy[SERVER_DISK_PATH];
    snprintf(copy, sizeof copy, "%s.before-migration", path);
    enum server_store_outcome outcome =
        connect_to(database, path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    if (!outcome) outcome = run(database, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
    if (outcome) return outcome;
    /* takes the place of automatic checkpoints */
    sqlite3_wal_hook(database->connection, on_commit, database);
    outcome = check_all(database);
    if (!outcome)
        outcome = server_store_migrate(database->connection, server_store_schema,
                                       server_store_schema_version, copy);
    return outcome ? outcome : prepare(database);
}

enum server_store_outcome server_database_open(const char *path, struct server_database **out)
{
    struct server_database *database = calloc(1, sizeof *database);
    if (!database) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome = make_ready(database, path);
    if (outcome)
        server_database_close(database, false);
    else
        *out = database;
    return outcome;
}

static bool has_log(const char *path)
{
    char log[SERVER_DISK_PATH];
    return snprintf(log, sizeof log, "%s-wal", path) < (int)sizeof log && server_disk_exists(log);
}

static void disconnect(struct server_database *database, bool is_sound)
{
    bool may_checkpoint = database->had_no_log || (is_sound && !database->cant_checkpoint);
    if (database->connection && !may_checkpoint)
        sqlite3_db_config(database->connection, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    sqlite3_close(database->connection);
}

/* One of an earlier version is read as it would be after the next start. */
static enum server_store_outcome lift(struct server_database *database)
{
    sqlite3 *copy;
    enum server_store_outcome outcome = server_store_lift(database->connection, &copy);
    if (outcome) return outcome;
    disconnect(database, false);
    database->connection = copy;
    return SERVER_STORE_DONE;
}

/* To one that there is already. */
static enum server_store_outcome connect_to_read(struct server_database *database, const char *path)
{
    database->had_no_log = !has_log(path);
    return server_disk_exists(path) ? connect_to(database, path, SQLITE_OPEN_READWRITE)
                                    : SERVER_STORE_ABSENT;
}

enum server_store_outcome server_database_open_to_copy(const char *path,
                                                       struct server_database **out)
{
    struct server_database *database = calloc(1, sizeof *database);
    if (!database) return SERVER_STORE_NO_MEMORY;
    enum server_store_outcome outcome = connect_to_read(database, path);
    if (!outcome) outcome = check_all(database);
    if (outcome)
        server_database_close(database, false);
    else
        *out = database;
    return outcome;
}

enum server_store_outcome server_database_open_to_read(const char *path,
                                                       struct server_database **out)
{
    struct server_database *database = calloc(1, sizeof *database);
    if (!database) return SERVER_STORE_NO_MEMORY;
    int version = 0;
    enum server_store_outcome outcome = connect_to_read(database, path);
    if (!outcome) outcome = server_store_version(database->connection, &version);
    if (!outcome && version == 0) outcome = SERVER_STORE_ABSENT;
    if (!outcome) outcome = check_all(database);
    if (!outcome && version < server_store_schema_version) outcome = lift(database);
    if (!outcome) outcome = prepare(database);
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
    disconnect(database, is_sound);
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
    sqlite3_stmt *statement = database->statements[which];
    sqlite3_bind_text(statement, 1, key, -1, SQLITE_STATIC);
    return statement;
}

/* Moves what is in the log into the database. What was committed is durable already: so a failure
 * fails the next write, not this one. */
static void checkpoint(struct server_database *database, int mode)
{
    int code = sqlite3_wal_checkpoint_v2(database->connection, NULL, mode, NULL, NULL);
    enum server_store_outcome outcome = server_store_outcome_of(code);
    database->cant_checkpoint |=
        outcome == SERVER_STORE_READ_ONLY || outcome == SERVER_STORE_DAMAGED;
}

/* Once there is enough of it. */
static void checkpoint_when_due(struct server_database *database)
{
    if (database->log_pages >= CHECKPOINT_PAGES) checkpoint(database, SQLITE_CHECKPOINT_PASSIVE);
}

/* Runs a statement that writes. */
static enum server_store_outcome run_write(struct server_database *database,
                                           sqlite3_stmt *statement)
{
    if (database->cant_checkpoint) return SERVER_STORE_READ_ONLY;
    (void)sqlite3_step(statement);
    int code = sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
    return server_store_outcome_of(code);
}

enum server_store_outcome server_database_put(struct server_database *database,
                                              const struct server_record *record)
{
    size_t size;
    char *text = server_record_write(record, &size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    struct server_object objects[SERVER_PARTS];
    sqlite3_stmt *statement = bind_key(database, PUT, record->key);
    for (int part = 0; part < SERVER_PARTS; part++) /* what is not bound is NULL */
        if (server_record_object(record, part, &objects[part]))
            sqlite3_bind_text(statement, 2 + part, objects[part].id, -1, SQLITE_STATIC);
    sqlite3_bind_text64(statement, 2 + SERVER_PARTS, text, size, SQLITE_STATIC, SQLITE_UTF8);
    enum server_store_outcome outcome = run_write(database, statement);
    free(text);
    if (!outcome) checkpoint_when_due(database);
    return outcome;
}

/* The log is emptied: damage can end a log early without a trace, and while a manifest tells of a
 * row that was lost so, nothing would tell of a deletion that was. */
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
    return server_store_outcome_of(sqlite3_reset(statement));
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
    enum server_store_outcome outcome = server_store_outcome_of(sqlite3_reset(statement));
    return !outcome && found == SQLITE_DONE ? SERVER_STORE_ABSENT : outcome;
}

enum server_store_outcome server_database_note_uses(struct server_database *database,
                                                    const struct server_record *const *records,
                                                    const struct server_store_uses *uses,
                                                    uint32_t count)
{
    enum server_store_outcome outcome = run(database, "BEGIN IMMEDIATE");
    for (uint32_t i = 0; !outcome && i < count; i++) {
        sqlite3_stmt *statement = bind_key(database, NOTE, records[i]->key);
        sqlite3_bind_int64(statement, 2, (int64_t)uses[i].count);
        sqlite3_bind_int64(statement, 3, uses[i].last);
        outcome = run_write(database, statement);
    }
    if (!outcome) outcome = run(database, "COMMIT");
    if (!outcome)
        checkpoint_when_due(database);
    else if (!sqlite3_get_autocommit(database->connection))
        (void)run(database, "ROLLBACK");
    return outcome;
}

/* --- as a whole ------------------------------------------------------------------------------- */

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
    return server_store_outcome_of(code ? code : end);
}

enum server_store_outcome server_database_copy(struct server_database *database, const char *path)
{
    return server_store_copy(database->connection, path);
}
