/* Store files: the folder of a local store.
 *
 *     lock                        locked, as the folder itself, by the process that has the store
 * open unfinished                  the marker of a copy that --backup or --restore has not
 * finished: written first, removed last geodesicd.db, -wal, -shm    SQLite: the records as rows
 *     batches.db, -wal, -shm      SQLite: the batches (batch_queue.h); made by the first
 *     objects/ab/<object>         files and attachments, immutable, named by their content
 * (record.h), shared by all surfaces that have them manifests/<key>.manifest    the record of each
 * surface (record.h), by the text of its key (key.h): what the database is made from when it is
 * damaged fields/                     landmarks and cached fields (field_store.h) ballast room that
 * a delete can have when the disk is full temporary/                  files that are being written;
 * emptied at the start
 *
 * An object is durable before the manifest that names it, the manifest before the row, the row
 * before the answer. A delete goes the other way. So a manifest that can be read is never older
 * than its row. */
#ifndef SERVER_STORE_LOCAL_FILES_H
#define SERVER_STORE_LOCAL_FILES_H

#include "server/base/disk.h"
#include "server/store/store.h"

#define SERVER_STORE_FOLDER 3500 /* most bytes of the folder's path */

struct server_store_files {
    char folder[SERVER_STORE_FOLDER];
    int held, lock;  /* descriptors of the folder and of its file, both locked; -1: none */
    unsigned serial; /* of temporary files */
};

enum server_store_outcome server_files_outcome(enum server_disk_result result);

/* Path of a file in the folder. */
void server_files_path(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                       const char *name);
void server_files_object_path(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                              const char *object);
void server_files_manifest_path(const struct server_store_files *files, char path[SERVER_DISK_PATH],
                                const char *key);

/* The key that a manifest's file name stands for; false: it is none. */
bool server_files_manifest_key(const char *file, char key[SERVER_KEY_TEXT]);

/* Can this be the file name of an object? */
bool server_files_object_check(const char *file);

/* Makes the folders, with durable names, makes its files private, and takes the lock; false with a
 * sentence, also for an unfinished copy. server_files_close gives the lock back. */
bool server_files_open(struct server_store_files *files, const char *folder, char *error,
                       size_t error_size);
/* The same of a data folder as it is there: nothing is made, and one without `objects` and
 * `manifests` is none. */
bool server_files_open_existing(struct server_store_files *files, const char *folder, char *error,
                                size_t error_size);
/* The same of a new folder that is to become a copy of another, or of an unfinished one: of that,
 * objects alone are kept. The folder is unfinished until server_files_finish; then no copy is
 * refused any more. */
bool server_files_open_copy(struct server_store_files *files, const char *folder, char *error,
                            size_t error_size);
enum server_store_outcome server_files_finish(const struct server_store_files *files);

/* Is that folder an unfinished copy? If so, `error` says what to do. */
bool server_files_is_unfinished(const char *folder, char *error, size_t error_size);

/* Are the folder, its folders and its database where they were? */
bool server_files_are_there(const struct server_store_files *files);

void server_files_close(struct server_store_files *files);

/* --- objects ---------------------------------------------------------------------------------- */

/* Writes the object, unless it is there already, whole. */
enum server_store_outcome server_files_write_object(struct server_store_files *files,
                                                    const struct server_object *object,
                                                    const void *bytes);
/* Reads and verifies it. */
enum server_store_outcome server_files_read_object(const struct server_store_files *files,
                                                   const struct server_object *object,
                                                   void **bytes);
/* Reads it piece by piece, as it is on the disk, and compares. */
enum server_store_verdict server_files_verify_object(const struct server_store_files *files,
                                                     const struct server_object *object,
                                                     bool (*pace)(void *user, size_t bytes),
                                                     void *user);
void server_files_remove_object(const struct server_store_files *files, const char *object);

/* --- manifests -------------------------------------------------------------------------------- */

/* Reads the manifest of that key, and the SHA-256 of its text. DAMAGED also when it can't be read
 * or is another key's. */
enum server_record_reading server_files_read_manifest(const struct server_store_files *files,
                                                      const char *key, struct server_record **out,
                                                      char sha256[SERVER_SHA256_HEX]);

/* Writes the record's manifest, and keeps the older one aside until the change is settled. */
enum server_store_outcome server_files_write_manifest(struct server_store_files *files,
                                                      const struct server_record *record);
/* Settles the change, or undoes it. */
void server_files_settle_manifest(const struct server_store_files *files);
enum server_store_outcome server_files_undo_manifest(const struct server_store_files *files,
                                                     const char *key);
enum server_store_outcome server_files_remove_manifest(const struct server_store_files *files,
                                                       const char *key);

/* --- ballast ---------------------------------------------------------------------------------- */

enum server_store_outcome server_files_load_ballast(struct server_store_files *files);
bool server_files_drop_ballast(const struct server_store_files *files); /* true: it made room */

#endif
