/* The parts of a local store: its files and its database. The data folder:
 *
 *     lock                          locked by the process that has the store, as is the folder
 *     unfinished                    marks a copy that --backup or --restore has not finished
 *     geodesicd.db, -wal, -shm      SQLite: the records as rows
 *     batches.db, -wal, -shm        SQLite: the batches; made by the first
 *     objects/ab/<object>           files and attachments, immutable, named by content (record.h)
 *     manifests/<key>.manifest      the record of each surface; the database can be made from them
 *     fields/                       landmarks and cached fields (field_store.h)
 *     ballast                       room for a delete when the disk is full
 *     temporary/                    files that are being written; emptied at the start
 *
 * INVARIANT. An object is durable before the manifest that names it, the manifest before the row,
 * the row before the answer; a delete goes the other way. So a readable manifest is never older
 * than its row. */
#ifndef SERVER_STORE_LOCAL_LOCAL_H
#define SERVER_STORE_LOCAL_LOCAL_H

#include "server/store/sql.h"

#define SERVER_STORE_FOLDER   3500 /* bytes of the folder's path, with the NUL */
#define SERVER_STORE_DATABASE "geodesicd.db"
#define SERVER_MANIFEST       ".manifest"

struct server_files {
    char folder[SERVER_STORE_FOLDER];
    int held, lock;  /* locked descriptors of the folder and of its file; -1: none */
    unsigned serial; /* of temporary files */
    char error[512]; /* why it could not be opened, a sentence */
};

struct server_path {
    char text[SERVER_DISK_PATH];
};

/* The path of a file in the folder; arguments as for printf. */
struct server_path server_files_path(const struct server_files *files, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
struct server_path server_files_object_path(const struct server_files *files, const char *object);
struct server_path server_files_manifest_path(const struct server_files *files, const char *key);

/* Lists one of the store's folders. */
struct server_listing server_files_list(const struct server_files *files, const char *folder);

/* Parses a manifest's file name; false: it is none. */
bool server_files_manifest_key(const char *file, char key[SERVER_KEY_TEXT]);

/* Returns whether this can be the file name of an object: a hash, with a tenant or without. */
bool server_files_object_check(const char *file);

/* Opens the folder and locks it; server_files_close unlocks it. Creates what is missing, durably,
 * and restricts the rights of its files. False with files->error, also for an unfinished copy. */
bool server_files_open(struct server_files *files, const char *folder);
/* Likewise, but creates nothing: without `objects` and `manifests` it is no data folder. */
bool server_files_open_existing(struct server_files *files, const char *folder);
/* Likewise for a new copy, or an unfinished one, whose objects are kept. The folder is unfinished
 * until server_files_finish. */
bool server_files_open_copy(struct server_files *files, const char *folder);
enum server_store_outcome server_files_finish(const struct server_files *files);

/* True with files->error: the folder is an unfinished copy. */
bool server_files_is_unfinished(struct server_files *files);

/* False: the folder, a folder in it, or the database was removed or replaced. */
bool server_files_are_there(const struct server_files *files);

/* May be called twice. */
void server_files_close(struct server_files *files);

/* --- objects ---------------------------------------------------------------------------------- */

/* Writes the object, unless it exists and is sound. */
enum server_store_outcome server_files_write_object(struct server_files *files,
                                                    const struct server_object *object,
                                                    const void *bytes);
/* Reads and verifies the object; `*bytes` is malloc'ed. */
enum server_store_outcome server_files_read_object(const struct server_files *files,
                                                   const struct server_object *object,
                                                   void **bytes);
/* Copies the object from another folder, unless it exists and is sound, and verifies it. */
enum server_store_outcome server_files_copy_object(const struct server_files *files,
                                                   const struct server_files *from,
                                                   const struct server_object *object,
                                                   server_disk_copier *copy);
/* Verifies the object from the disk, piece by piece; as the store's verify. */
enum server_store_outcome server_files_verify_object(const struct server_files *files,
                                                     const struct server_object *object,
                                                     server_pace *pace, void *user);
void server_files_remove_object(const struct server_files *files, const char *object);

/* --- manifests -------------------------------------------------------------------------------- */

/* Reads a manifest, and the SHA-256 of its text. DAMAGED also if it is missing or has another
 * key. */
enum server_record_reading server_files_read_manifest(const struct server_files *files,
                                                      const char *key, struct server_record **out,
                                                      char sha256[SERVER_SHA256_HEX]);

/* Writes the record's manifest and keeps the old one until the change is settled or undone. */
enum server_store_outcome server_files_write_manifest(struct server_files *files,
                                                      const struct server_record *record);
void server_files_settle_manifest(const struct server_files *files);
enum server_store_outcome server_files_undo_manifest(const struct server_files *files,
                                                     const char *key);
enum server_store_outcome server_files_remove_manifest(const struct server_files *files,
                                                       const char *key);

/* --- ballast ---------------------------------------------------------------------------------- */

enum server_store_outcome server_files_load_ballast(struct server_files *files);
bool server_files_drop_ballast(const struct server_files *files); /* true: it made room */

/* --- the database -------------------------------------------------------------------------------- */
/* The records as rows of SQLite, a fast index. Each row has a manifest
 * (record.h), from which it can be made again.
 *
 * One connection, used by one thread at a time, writes and makes all checkpoints: SQLite 3.40 can
 * reset its log wrongly when two connections do. READ_ONLY means that SQLite failed to write or
 * sync. */

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

/* The key's objects; ABSENT. */
enum server_store_outcome server_database_find(struct server_database *database, const char *key,
                                               struct server_sql_surface *out);

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
