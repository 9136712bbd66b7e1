/* Files of a local store. The data folder:
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
#ifndef SERVER_STORE_LOCAL_FILES_H
#define SERVER_STORE_LOCAL_FILES_H

#include "server/store/store.h"

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
enum server_store_outcome server_files_make_object_folder(const struct server_files *files,
                                                          const struct server_object *object);
enum server_store_outcome server_files_sync_object_folder(const struct server_files *files,
                                                          const struct server_object *object);
/* Reads the object and forgets it. */
bool server_files_has_object(const struct server_files *files, const struct server_object *object);
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

#endif
