/* The SQLite databases of the records (local.h) and of the batches (sql.h). */
#include "server/store/local/local.h"

#include <errno.h>
#include <pthread.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/log.h"

#define BUSY_MS          5000
#define CHECKPOINT_PAGES 500 /* pages of the log: 2 MB */

static const char *const schema[] = {
    "CREATE TABLE surfaces (name TEXT PRIMARY KEY, sha256 TEXT NOT NULL, record TEXT NOT NULL,"
    "  uses INTEGER NOT NULL DEFAULT 0, used INTEGER NOT NULL DEFAULT 0) WITHOUT ROWID;"
    "CREATE INDEX surfaces_by_sha256 ON surfaces (sha256);",
    /* step for kinds and attachments: a name becomes a key (kind.h), and a hash becomes an object's
       id (record.h) */
    "ALTER TABLE surfaces RENAME COLUMN name TO key;"
    "ALTER TABLE surfaces RENAME COLUMN sha256 TO file;"
    "ALTER TABLE surfaces ADD COLUMN attachment TEXT;"
    "CREATE INDEX surfaces_by_attachment ON surfaces (attachment);",
};
#define SCHEMA_VERSION ((int)(sizeof schema / sizeof *schema))

struct server_database {
    sqlite3 *connection;
    int log_pages;        /* pages in the log after the last commit */
    bool cant_checkpoint; /* true if a checkpoint failed, and all writes are refused */
    /* true if there was no log before the database was opened for reading, so closing may make a
       checkpoint */
    bool had_no_log;
};

/* --- SQLite ----------------------------------------------------------------------------------- */

enum server_outcome server_sqlite_outcome(int code)
{
    /* these two I/O errors mean a full disk, and an allocation that failed before any write */
    if (code == SQLITE_IOERR_SHMSIZE) return SERVER_STORE_FULL;
    if (code == SQLITE_IOERR_NOMEM) return SERVER_STORE_NO_MEMORY;
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

static struct server_sql_value column_read(sqlite3_stmt *statement, int column)
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
        return server_sql_text(NULL);
    }
}

/* Runs one statement. The statement runs to its end even if the visitor ends the visit. */
static int sqlite_run(sqlite3 *connection, const struct server_statement *what)
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
            row[i] = column_read(statement, i);
        visits = visits && what->visit(what->user, row);
        code = SQLITE_OK;
    }
    (void)sqlite3_finalize(statement);
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

static int sqlite_script(sqlite3 *connection, const char *text)
{
    return sqlite3_exec(connection, text, NULL, NULL, NULL);
}

/* Opens a connection, for writing if the flags contain SQLITE_OPEN_CREATE. The caller closes
 * `*out`. */
static int sqlite_connect(const char *path, int flags, sqlite3 **out)
{
    int code = sqlite3_open_v2(path, out, flags, NULL);
    if (code) return code;
    sqlite3_extended_result_codes(*out, 1);
    sqlite3_busy_timeout(*out, BUSY_MS);
    code = sqlite_script(*out, "PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;"
                               "PRAGMA temp_store = MEMORY");
    if (code || !(flags & SQLITE_OPEN_CREATE)) return code;
    return sqlite_script(*out, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
}

static int sqlite_check(sqlite3 *connection)
{
    struct server_sql_integers faults = {0};
    /* the function has no argument here, because SQLite 3.46 regards an argument as the name of a
       table */
    int code = sqlite_run(connection, SERVER_SQL("SELECT count(*) FROM pragma_integrity_check"
                                                 " WHERE integrity_check <> 'ok'",
                                                 NULL, 0, server_sql_on_integers, &faults));
    return code || !faults.at[0] ? code : SQLITE_CORRUPT;
}

static int read_version(sqlite3 *connection, int64_t *version)
{
    struct server_sql_integers found = {0};
    int code = sqlite_run(
        connection, SERVER_SQL("PRAGMA user_version", NULL, 0, server_sql_on_integers, &found));
    *version = found.at[0];
    return code;
}

/* Copies the database to a new file or to memory. The caller closes `*out` in any case. */
static int sqlite_copy(sqlite3 *connection, const char *path, sqlite3 **out)
{
    int code = sqlite3_open(path, out);
    sqlite3_backup *backup = code ? NULL : sqlite3_backup_init(*out, "main", connection, "main");
    if (backup) (void)sqlite3_backup_step(backup, -1);
    if (backup) (void)sqlite3_backup_finish(backup);
    return sqlite3_extended_errcode(*out);
}

static int run_steps(sqlite3 *connection, const char *const *steps, int64_t from, int to)
{
    char mark[64];
    int code = sqlite_script(connection, "BEGIN IMMEDIATE");
    for (int64_t i = from; !code && i < to; i++) code = sqlite_script(connection, steps[i]);
    snprintf(mark, sizeof mark, "PRAGMA user_version = %d; COMMIT", to);
    if (!code) code = sqlite_script(connection, mark);
    if (code) (void)sqlite_script(connection, "ROLLBACK");
    return code;
}

enum server_outcome server_sqlite_migrate(sqlite3 *connection, const char *const *steps,
                                          int version, const char *copy_path)
{
    int64_t from;
    int code = read_version(connection, &from);
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

static int open_to_write(struct server_database *database, const char *path)
{
    int code =
        sqlite_connect(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX,
                       &database->connection);
    if (code) return code;
    /* replaces automatic checkpoints */
    sqlite3_wal_hook(database->connection, on_commit, database);
    return sqlite_check(database->connection);
}

static void database_disconnect(struct server_database *database, bool is_sound)
{
    bool may_checkpoint = database->had_no_log || (is_sound && !database->cant_checkpoint);
    if (database->connection && !may_checkpoint)
        sqlite3_db_config(database->connection, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    sqlite3_close(database->connection);
}

/* Replaces a database of an earlier version by a copy in memory, which is migrated. */
static int migrate_in_memory(struct server_database *database, int64_t version)
{
    sqlite3 *copy;
    int code = sqlite_copy(database->connection, ":memory:", &copy);
    if (!code) code = run_steps(copy, schema, version, SCHEMA_VERSION);
    if (!code) database_disconnect(database, false);
    if (code)
        sqlite3_close(copy);
    else
        database->connection = copy;
    return code;
}

/* Opens a database on a read-only file system, where SQLite can't create the files beside it. So
 * the database must have no log. Returns a code of SQLite. */
static int sqlite_connect_immutable(const char *path, sqlite3 **out)
{
    static const char end[] = "?immutable=1";
    char *uri = malloc(strlen("file:") + 3 * strlen(path) + sizeof end);
    if (!uri) return SQLITE_NOMEM;
    char *at = stpcpy(uri, "file:");
    for (; *path; path++) at += sprintf(at, strchr("%?#", *path) ? "%%%02X" : "%c", *path);
    strcpy(at, end);
    int code =
        sqlite_connect(uri, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI, out);
    free(uri);
    return code;
}

static int connect_to_read(struct server_database *database, const char *path)
{
    bool is_immutable = database->had_no_log && access(path, W_OK) != 0 && errno == EROFS;
    return is_immutable ? sqlite_connect_immutable(path, &database->connection)
                        : sqlite_connect(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX,
                                         &database->connection);
}

static enum server_outcome open_to_read(struct server_database *database, const char *path,
                                        bool is_store)
{
    char log[SERVER_DISK_PATH + sizeof "-wal"];
    int64_t version = SCHEMA_VERSION;
    snprintf(log, sizeof log, "%s-wal", path);
    database->had_no_log = !server_disk_exists(log);
    if (!server_disk_exists(path)) return SERVER_STORE_ABSENT;
    int code = connect_to_read(database, path);
    if (!code && is_store) code = read_version(database->connection, &version);
    if (!code && version == 0) return SERVER_STORE_ABSENT;
    if (!code) code = sqlite_check(database->connection);
    if (!code && version < SCHEMA_VERSION) code = migrate_in_memory(database, version);
    return server_sqlite_outcome(code);
}

enum server_outcome server_database_open(const char *path, enum server_database_use use,
                                         struct server_database **out)
{
    char copy[SERVER_DISK_PATH + sizeof ".before-migration"];
    struct server_database *database = calloc(1, sizeof *database);
    if (!database) return SERVER_STORE_NO_MEMORY;
    snprintf(copy, sizeof copy, "%s.before-migration", path);
    enum server_outcome outcome = use == SERVER_DATABASE_WRITE
                                      ? server_sqlite_outcome(open_to_write(database, path))
                                      : open_to_read(database, path, use == SERVER_DATABASE_READ);
    if (!outcome && use == SERVER_DATABASE_WRITE)
        outcome = server_sqlite_migrate(database->connection, schema, SCHEMA_VERSION, copy);
    if (outcome)
        server_database_close(database, false);
    else
        *out = database;
    return outcome;
}

void server_database_close(struct server_database *database, bool is_sound)
{
    if (database) database_disconnect(database, is_sound);
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

/* Moves the log into the database (a checkpoint). After a failure all later writes are refused;
 * earlier writes are durable. */
static void database_checkpoint(struct server_database *database, int mode)
{
    enum server_outcome outcome = server_sqlite_outcome(
        sqlite3_wal_checkpoint_v2(database->connection, NULL, mode, NULL, NULL));
    database->cant_checkpoint |=
        outcome == SERVER_STORE_READ_ONLY || outcome == SERVER_STORE_DAMAGED;
}

static void checkpoint_when_due(struct server_database *database)
{
    if (database->log_pages >= CHECKPOINT_PAGES)
        database_checkpoint(database, SQLITE_CHECKPOINT_PASSIVE);
}

static enum server_outcome database_write(struct server_database *database,
                                          const struct server_statement *statement)
{
    if (database->cant_checkpoint) return SERVER_STORE_READ_ONLY;
    return server_sqlite_outcome(sqlite_run(database->connection, statement));
}

enum server_outcome server_database_put(struct server_database *database,
                                        const struct server_record *record)
{
    size_t size;
    char *text = server_record_write(record, &size);
    if (!text) return SERVER_STORE_NO_MEMORY;
    const char *attachment = record->objects[SERVER_PART_ATTACHMENT].id;
    enum server_outcome outcome = database_write(
        database,
        SERVER_SQL("INSERT INTO surfaces (key, record, file, attachment) VALUES ($1, $2, $3, $4)"
                   " ON CONFLICT (key) DO UPDATE SET record = $2, file = $3, attachment = $4",
                   SERVER_VALUES(server_sql_text(record->key), server_sql_text(text),
                                 server_sql_text(record->objects[SERVER_PART_FILE].id),
                                 server_sql_text(*attachment ? attachment : NULL))));
    free(text);
    if (!outcome) checkpoint_when_due(database);
    return outcome;
}

/* Deletes the row and empties the log, because damage can truncate a log without being detected. A
 * lost insertion is repaired from the manifest, but a lost deletion would not be detected. */
enum server_outcome server_database_remove(struct server_database *database, const char *key)
{
    enum server_outcome outcome =
        database_write(database, SERVER_SQL("DELETE FROM surfaces WHERE key = $1",
                                            SERVER_VALUES(server_sql_text(key))));
    if (!outcome) database_checkpoint(database, SQLITE_CHECKPOINT_TRUNCATE);
    return outcome;
}

enum server_outcome server_database_count(struct server_database *database, const char *object,
                                          int64_t *count)
{
    struct server_sql_integers found = {0};
    int code = sqlite_run(database->connection,
                          SERVER_SQL("SELECT (SELECT count(*) FROM surfaces WHERE file = $1)"
                                     " + (SELECT count(*) FROM surfaces WHERE attachment = $1)",
                                     SERVER_VALUES(server_sql_text(object)), server_sql_on_integers,
                                     &found));
    *count = found.at[0];
    return server_sqlite_outcome(code);
}

enum server_outcome server_database_find(struct server_database *database, const char *key,
                                         struct server_sql_surface *out)
{
    *out = (struct server_sql_surface){0};
    int code =
        sqlite_run(database->connection,
                   SERVER_SQL("SELECT 0, file, attachment FROM surfaces WHERE key = $1",
                              SERVER_VALUES(server_sql_text(key)), server_sql_on_surface, out));
    return code || out->rows ? server_sqlite_outcome(code) : SERVER_STORE_ABSENT;
}

enum server_outcome server_database_note_uses(struct server_database *database,
                                              const struct server_record *const *records,
                                              const struct server_store_uses *uses, uint32_t count)
{
    enum server_outcome outcome = database_write(database, SERVER_SQL("BEGIN IMMEDIATE"));
    for (uint32_t i = 0; !outcome && i < count; i++)
        outcome = database_write(
            database, SERVER_SQL("UPDATE surfaces SET uses = $2, used = $3 WHERE key = $1",
                                 SERVER_VALUES(server_sql_text(records[i]->key),
                                               server_sql_integer((int64_t)uses[i].count),
                                               server_sql_integer(uses[i].last))));
    if (!outcome) outcome = database_write(database, SERVER_SQL("COMMIT"));
    if (!outcome)
        checkpoint_when_due(database);
    else if (!sqlite3_get_autocommit(database->connection))
        (void)sqlite_script(database->connection, "ROLLBACK");
    return outcome;
}

enum server_outcome server_database_each(struct server_database *database, server_sql_visit *visit,
                                         void *user)
{
    return server_sqlite_outcome(sqlite_run(
        database->connection,
        SERVER_SQL("SELECT key, record, uses, used FROM surfaces"
                   " WHERE typeof(key) = 'text' AND typeof(record) = 'text' ORDER BY key",
                   NULL, 0, visit, user)));
}

enum server_outcome server_database_copy(struct server_database *database, const char *path)
{
    sqlite3 *copy;
    int code = sqlite_copy(database->connection, path, &copy);
    sqlite3_close(copy);
    return server_sqlite_outcome(code);
}

/* --- the batches (sql.h) ---------------------------------------------------------------------- */

struct batches {
    struct server_store_sql sql; /* must be the first member */
    pthread_mutex_t lock;
    /* NULL means that the database is damaged, and no new one could be made yet */
    sqlite3 *connection;
    char path[SERVER_DISK_PATH];
    const char *const *steps;
};

static int batches_connect(struct batches *own)
{
    int code =
        sqlite_connect(own->path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, &own->connection);
    int64_t version = 0;
    int count = 0;
    while (own->steps[count]) count++;
    if (!code) code = sqlite_check(own->connection);
    if (!code) code = read_version(own->connection, &version);
    /* a later version of the daemon made the file */
    if (!code && version > count) code = SQLITE_CANTOPEN;
    if (!code && version < count) code = run_steps(own->connection, own->steps, version, count);
    if (code) sqlite3_close(own->connection);
    if (code) own->connection = NULL;
    return code;
}

/* Replaces a damaged database by a new one. Returns `code`, or the result code of opening the new
 * database. */
static int batches_judge(struct batches *own, int code)
{
    char suffix[SERVER_DISK_ASIDE_SUFFIX];
    if ((code & 0xff) != SQLITE_CORRUPT && (code & 0xff) != SQLITE_NOTADB) return code;
    sqlite3_close(own->connection);
    server_disk_set_aside(own->path, suffix);
    server_log_message(SERVER_LOG_ERROR, "batches_damaged",
                       "the database of batches is damaged: it was renamed to %s%s, and a new one "
                       "replaces it; send earlier batches again: they are lost",
                       own->path, suffix);
    return batches_connect(own);
}

static int batches_ensure(struct batches *own)
{
    return own->connection ? SQLITE_OK : batches_judge(own, batches_connect(own));
}

/* Does not repeat a statement that finds damage, because its visitor may already have received
 * rows. */
static enum server_outcome batches_run(struct server_store_sql *sql,
                                       const struct server_statement *statement)
{
    struct batches *own = (struct batches *)sql;
    pthread_mutex_lock(&own->lock);
    int code = batches_ensure(own);
    if (!code) code = sqlite_run(own->connection, statement);
    (void)batches_judge(own, code);
    pthread_mutex_unlock(&own->lock);
    enum server_outcome outcome = server_sqlite_outcome(code);
    return outcome == SERVER_STORE_DAMAGED ? SERVER_STORE_READ_ONLY : outcome;
}

static void batches_close(struct server_store_sql *sql)
{
    struct batches *own = (struct batches *)sql;
    sqlite3_close(own->connection);
    pthread_mutex_destroy(&own->lock);
    free(own);
}

struct server_store_sql *server_store_sql_local_open(const char *path, const char *const *steps,
                                                     char error[SERVER_ERROR])
{
    struct batches *own = calloc(1, sizeof *own);
    snprintf(error, SERVER_ERROR, "out of memory");
    if (!own) return NULL;
    own->sql =
        (struct server_store_sql){.run = batches_run, .skip_locked = "", .close = batches_close};
    own->steps = steps;
    snprintf(own->path, sizeof own->path, "%s", path);
    pthread_mutex_init(&own->lock, NULL);
    int code = batches_ensure(own);
    if (!code) return &own->sql;
    snprintf(error, SERVER_ERROR, "the database %s can't be used: %s", path, sqlite3_errstr(code));
    batches_close(&own->sql);
    return NULL;
}
