/* Store files: the folder of a local store.
 *
 *     lock                        held by the process that has the store open
 *     geodesicd.db, -wal, -shm    SQLite: the records as rows
 *     objects/ab/<sha256>         uploaded bytes, immutable, shared by all names that have them
 *     manifests/<name>.manifest   the record of each name (record.h): what the database is made from when it is damaged
 *     fields/                     landmarks and cached fields (field_store.h)
 *     ballast                     room that a delete can have when the disk is full
 *     temporary/                  files that are being written; emptied at the start
 *
 * An object is durable before the manifest that names it, the manifest before the row, the row before the answer. A
 * delete goes the other way. So a manifest that can be read is never older than its row. */
#ifndef SERVER_STORE_FILES_H
#define SERVER_STORE_FILES_H

#include "server/disk.h"
#include "server/store.h"

#define SERVER_STORE_FOLDER 3500       /* most bytes of the folder's path */
#define SERVER_STORE_ASIDE  ".damaged" /* in the names of damaged files that were put aside */

struct server_store_files {
    char folder[SERVER_STORE_FOLDER];
    int lock;        /* descriptor */
    unsigned serial; /* of temporary files */
};

enum server_store_outcome server_files_outcome(enum server_disk_result result);

/* Path of a file in the folder. */
void server_files_path(const struct server_store_files *files, char path[SERVER_DISK_PATH], const char *name);
void server_files_object_path(const struct server_store_files *files, char path[SERVER_DISK_PATH], const char *sha256);
void server_files_manifest_path(const struct server_store_files *files, char path[SERVER_DISK_PATH], const char *name);

/* The name that a manifest's file name stands for; false: it is none. */
bool server_files_manifest_name(const char *file, char name[PROTO_MESH_NAME + 1]);

/* Makes the folders, with durable names, and takes the lock; false with a sentence. server_files_close gives the
 * lock back. */
bool server_files_open(struct server_store_files *files, const char *folder, char *error, size_t error_size);
/* The same of a data folder as it is there: nothing is made, and one without `objects` and `manifests` is none. */
bool server_files_open_existing(struct server_store_files *files, const char *folder, char *error, size_t error_size);
void server_files_close(struct server_store_files *files);

/* --- objects --- */

/* Writes the object, unless it is there already, whole. */
enum server_store_outcome server_files_write_object(struct server_store_files *files, const char *sha256,
                                                    const void *bytes, size_t size);
/* Reads and verifies it. */
enum server_store_outcome server_files_read_object(const struct server_store_files *files, const char *sha256,
                                                   size_t size, void **bytes);
void server_files_remove_object(const struct server_store_files *files, const char *sha256);

/* --- manifests --- */

/* Reads the manifest of that name, and the SHA-256 of its text. DAMAGED also when it can't be read or is another
 * name's. */
enum server_record_reading server_files_read_manifest(const struct server_store_files *files, const char *name,
                                                      struct server_record **out, char sha256[SERVER_SHA256_HEX]);

/* Writes the record's manifest, and keeps the older one aside until the change is settled. */
enum server_store_outcome server_files_write_manifest(struct server_store_files *files,
                                                      const struct server_record *record);
/* Settles the change, or undoes it. */
void server_files_settle_manifest(const struct server_store_files *files);
enum server_store_outcome server_files_undo_manifest(const struct server_store_files *files, const char *name);
enum server_store_outcome server_files_remove_manifest(const struct server_store_files *files, const char *name);

/* --- ballast --- */

enum server_store_outcome server_files_load_ballast(struct server_store_files *files);
bool server_files_drop_ballast(const struct server_store_files *files); /* true: it made room */

#endif
