/* The parts of a local store: its files and its database. The data folder:
 *
 *     lock                          the process that uses the store locks this file and the folder
 *     unfinished                    exists while a copy by --backup or --restore is incomplete
 *     geodesicd.db, -wal, -shm      SQLite: the records as rows
 *     batches.db, -wal, -shm        SQLite: the batches; created for the first batch
 *     objects/ab/<object>           files and attachments, immutable, named by content (record.h)
 *     manifests/<key>.manifest      the record of each surface; the database can be made from them
 *     fields/                       landmarks and cached fields (field_store.h)
 *     ballast                       room for a delete when the disk is full
 *     temporary/                    files that are being written; emptied at the start
 *
 * INVARIANT. An object is durable before the manifest that names it, the manifest before the row,
 * the row before the answer. A delete removes them in the opposite order. So a readable manifest is
 * never older than its row. */
#pragma once

#include "server/store/sql.h"

#define SERVER_STORE_FOLDER   3500 /* bytes of the folder's path, with the NUL */
#define SERVER_STORE_DATABASE "geodesicd.db"
#define SERVER_MANIFEST       ".manifest"

struct server_files {
    char folder[SERVER_STORE_FOLDER];
    /* locked descriptors of the folder and of its file `lock`, or -1 if there is none */
    int held, lock;
    unsigned serial;          /* number of the next temporary file */
    char error[SERVER_ERROR]; /* a sentence with the reason why the folder could not be opened */
};

struct server_path {
    char text[SERVER_DISK_PATH];
};

/* Returns the path of a file in the folder; arguments as for printf. */
struct server_path server_files_path(const struct server_files *files, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
struct server_path server_files_manifest_path(const struct server_files *files, const char *key);

/* Lists one of the store's folders. */
struct server_listing server_files_list(const struct server_files *files, const char *folder);

/* Parses the file name of a manifest. Returns false if the name has another form. */
bool server_files_manifest_key(const char *file, char key[SERVER_KEY_TEXT]);

/* Returns true if the text has the form of an object's file name: a hash, and perhaps a tenant. */
bool server_files_object_check(const char *file);

/* Opens the folder and locks it; server_files_close unlocks it. Creates missing folders durably,
 * and restricts the permissions of files. On failure, and for an unfinished copy, returns false and
 * sets files->error. */
bool server_files_open(struct server_files *files, const char *folder);
/* Like server_files_open, but creates nothing. Also returns false if `objects` or `manifests` is
 * missing. Works on a read-only file system. */
bool server_files_open_existing(struct server_files *files, const char *folder);
/* Like server_files_open_existing, but does not lock the folder and needs no close. */
bool server_files_find(struct server_files *files, const char *folder);
/* Like server_files_open, but opens a new or an unfinished copy. The objects of an unfinished copy
 * are kept. The copy is unfinished until server_files_finish is called. */
bool server_files_open_copy(struct server_files *files, const char *folder);
enum server_outcome server_files_finish(const struct server_files *files);

/* Returns false if the folder, a folder in it, or the database was removed or replaced. */
bool server_files_are_there(const struct server_files *files);

/* May be called twice. */
void server_files_close(struct server_files *files);

/* --- objects ---------------------------------------------------------------------------------- */

/* Writes the object, unless it exists undamaged. */
enum server_outcome server_files_write_object(struct server_files *files,
                                              const struct server_object *object,
                                              const void *bytes);
/* Reads and verifies the object; `*bytes` is malloc'ed. */
enum server_outcome server_files_read_object(const struct server_files *files,
                                             const struct server_object *object, void **bytes);
/* Copies the object from another folder, unless it exists undamaged, and verifies it. */
enum server_outcome server_files_copy_object(const struct server_files *files,
                                             const struct server_files *from,
                                             const struct server_object *object,
                                             server_disk_copier *copy);
/* Verifies the object piece by piece, like the function `verify` of the store. */
enum server_outcome server_files_verify_object(const struct server_files *files,
                                               const struct server_object *object,
                                               server_pace *pace, void *user);
void server_files_remove_object(const struct server_files *files, const char *object);

/* --- manifests -------------------------------------------------------------------------------- */

/* Reads a manifest, and computes the SHA-256 of its text. Returns DAMAGED if the manifest is
 * damaged, is missing or has another key. */
enum server_record_reading server_files_read_manifest(const struct server_files *files,
                                                      const char *key, struct server_record **out,
                                                      char sha256[SERVER_SHA256_HEX]);

/* Writes the record's manifest, and keeps the old one until one of the next two functions is
 * called. */
enum server_outcome server_files_write_manifest(struct server_files *files,
                                                const struct server_record *record);
void server_files_settle_manifest(const struct server_files *files);
enum server_outcome server_files_undo_manifest(const struct server_files *files, const char *key);
enum server_outcome server_files_remove_manifest(const struct server_files *files, const char *key);

/* --- ballast ---------------------------------------------------------------------------------- */

enum server_outcome server_files_load_ballast(struct server_files *files);
/* returns true if there was a ballast */
bool server_files_drop_ballast(const struct server_files *files);

/* --- the database ----------------------------------------------------------------------------- */
/* The records as rows of SQLite, which are a fast index. Each row can be made again from its
 * manifest (record.h).
 *
 * Only one connection, used by one thread at a time, writes and makes checkpoints: with two such
 * connections, SQLite 3.40 can reset its log wrongly. READ_ONLY means that SQLite failed to write
 * or sync. */

struct sqlite3;
struct server_database;

enum server_database_use {
    /* Creates the file if it is missing, checks all of it, and migrates it to the current
       schema. */
    SERVER_DATABASE_WRITE,
    /* Reads for a short time, while another process may write. Creates nothing except the -shm file
       of a log that a crash left. The outcome is ABSENT if there is no file, or the file has no
       table yet. */
    SERVER_DATABASE_READ,
    SERVER_DATABASE_COPY /* like READ, but accepts any tables; used to check or copy a database */
};

/* Opens the database. If the outcome is DAMAGED, the caller renames the file and opens a new
 * one. */
enum server_outcome server_database_open(const char *path, enum server_database_use use,
                                         struct server_database **out);

/* Closes the database; NULL is allowed. If `is_sound`, a checkpoint may move the log into the
 * database. */
void server_database_close(struct server_database *database, bool is_sound);

/* The columns of a row. The record is not checked yet. */
enum { SERVER_ROW_KEY, SERVER_ROW_RECORD, SERVER_ROW_USES, SERVER_ROW_USED };

/* Visits the rows in the order of keys, until `visit` returns false. */
enum server_outcome server_database_each(struct server_database *database, server_sql_visit *visit,
                                         void *user);

enum server_outcome server_database_put(struct server_database *database,
                                        const struct server_record *record);
enum server_outcome server_database_remove(struct server_database *database, const char *key);

/* Counts the rows that name this object, as file or attachment. */
enum server_outcome server_database_count(struct server_database *database, const char *object,
                                          int64_t *count);

/* Finds the objects of a key. Returns ABSENT if there is no row with this key. */
enum server_outcome server_database_find(struct server_database *database, const char *key,
                                         struct server_sql_surface *out);

enum server_outcome server_database_note_uses(struct server_database *database,
                                              const struct server_record *const *records,
                                              const struct server_store_uses *uses, uint32_t count);

/* Copies the state of the database at one moment to a new file. */
enum server_outcome server_database_copy(struct server_database *database, const char *path);

/* Returns false after a failed checkpoint. Every write is then refused. */
bool server_database_is_sound(const struct server_database *database);

/* SQLite's message of the last failure. */
const char *server_database_error(struct server_database *database);

/* --- for tests -------------------------------------------------------------------------------- */

/* Returns the outcome of a result code. */
enum server_outcome server_sqlite_outcome(int code);

/* Migrates a database from its user_version to `version` in one transaction. steps[i] migrates
 * version i to version i + 1; steps are added at the end and never changed. A database that is not
 * new is first copied to `copy_path`. Returns DAMAGED if the version is impossible, or a step
 * fails. */
enum server_outcome server_sqlite_migrate(struct sqlite3 *connection, const char *const *steps,
                                          int version, const char *copy_path);
