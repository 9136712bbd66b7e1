/* Database of a local store: the records as rows of SQLite, a fast index. Each row has a manifest
 * (record.h), from which it can be made again.
 *
 * One connection, used by one thread at a time, writes and makes all checkpoints: SQLite 3.40 can
 * reset its log wrongly when two connections do. READ_ONLY means that SQLite failed to write or
 * sync. */
#ifndef SERVER_STORE_LOCAL_DATABASE_H
#define SERVER_STORE_LOCAL_DATABASE_H

#include "server/store/sql.h"

struct sqlite3;
struct server_database;

enum server_database_use {
    /* Creates the file if need be, checks all of it and migrates it to the current schema. */
    SERVER_DATABASE_WRITE,
    /* For a short time, while another process may write; only creates the -shm of a log that a
     * crash left. ABSENT: no file, or no tables yet. */
    SERVER_DATABASE_READ,
    SERVER_DATABASE_COPY /* as READ, for any tables: only to check and copy it */
};

/* DAMAGED: rename the file and open a new one. */
enum server_store_outcome server_database_open(const char *path, enum server_database_use use,
                                               struct server_database **out);

/* `is_sound`: the log may be moved into the database. NULL is harmless. */
void server_database_close(struct server_database *database, bool is_sound);

/* Columns of a row: texts and integers. The record is unchecked. */
enum { SERVER_ROW_KEY, SERVER_ROW_RECORD, SERVER_ROW_USES, SERVER_ROW_USED };

/* Visits the rows in the order of keys, until `visit` returns false. */
enum server_store_outcome server_database_each(struct server_database *database,
                                               server_sql_visit *visit, void *user);

enum server_store_outcome server_database_put(struct server_database *database,
                                              const struct server_record *record);
enum server_store_outcome server_database_remove(struct server_database *database, const char *key);

/* Counts the rows that name this object, as file or attachment. */
enum server_store_outcome server_database_count(struct server_database *database,
                                                const char *object, int64_t *count);

/* The ids of the key's objects, empty where there is none; ABSENT. */
enum server_store_outcome server_database_find(struct server_database *database, const char *key,
                                               char objects[SERVER_PARTS][SERVER_OBJECT]);

enum server_store_outcome server_database_note_uses(struct server_database *database,
                                                    const struct server_record *const *records,
                                                    const struct server_store_uses *uses,
                                                    uint32_t count);

/* Copies the database, as it is at one moment, to a new file. */
enum server_store_outcome server_database_copy(struct server_database *database, const char *path);

/* False after a failed checkpoint: every write is refused. */
bool server_database_is_sound(const struct server_database *database);

/* SQLite's message of the last failure. */
const char *server_database_error(struct server_database *database);

/* --- for tests -------------------------------------------------------------------------------- */

/* The outcome that a result code means. */
enum server_store_outcome server_sqlite_outcome(int code);

/* Migrates a database from its user_version to `version` in one transaction. steps[i] makes version
 * i + 1 of version i; steps are added at the end and never changed. Copies a database that is not
 * new to `copy_path` first. DAMAGED: an impossible version, or a step fails. */
enum server_store_outcome server_sqlite_migrate(struct sqlite3 *connection,
                                                const char *const *steps, int version,
                                                const char *copy_path);

#endif
