/* Disk: writes files so that each is complete and durable, or absent.
 *
 * A file is written under a temporary name, fsync'ed and renamed; then its folder is fsync'ed, so
 * that the name is durable too. After a failed write or fsync the kernel may drop the data and
 * report success the next time, so callers never retry after READ_ONLY. Thread-safe. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Outcome of a write or a read. In this header it concerns a file; in server/store, a surface or a
 * row. */
enum server_outcome {
    SERVER_STORE_DONE,
    SERVER_STORE_CREATED,      /* done; the name was free (only returned by the registry) */
    SERVER_STORE_REPLACED,     /* done; the name had a surface (only returned by the registry) */
    SERVER_STORE_ABSENT,       /* there is no such file or surface */
    SERVER_STORE_PRECONDITION, /* the precondition does not hold; nothing changed */
    SERVER_STORE_NO_MEMORY,    /* nothing changed */
    SERVER_STORE_FULL,         /* no room on the disk, or over quota; nothing changed */
    /* missing rights, descriptors or folder, see errno; nothing changed */
    SERVER_STORE_REFUSED,
    /* this or an earlier write is not durable, so all writes are refused */
    SERVER_STORE_READ_ONLY,
    SERVER_STORE_DAMAGED,    /* the stored bytes have changed */
    SERVER_STORE_STALE,      /* another daemon has changed the surface; nothing changed */
    SERVER_STORE_UNAVAILABLE /* the store can't be reached; a change may have been made */
};

#define SERVER_DISK_PATH 4096

/* Returns true if a file or folder has that path. */
bool server_disk_exists(const char *path);

/* Creates the folder and makes its name durable, unless the folder exists. The name of an existing
 * folder may not be durable, if the process that created the folder was killed. */
enum server_outcome server_disk_make_folder(const char *path);

/* Durably writes the file `temporary`, then renames it to `path` on the same file system. */
enum server_outcome server_disk_write(const char *path, const char *temporary, const void *bytes,
                                      size_t size);

/* Opens a regular file for reading. Never blocks on a FIFO or a device. If the result is NULL,
 * server_disk_why gives the reason. */
FILE *server_disk_stream(const char *path);

/* Describes errno after a function of this header has failed. */
const char *server_disk_why(void);

/* Reads the file and appends a NUL. The caller frees `*bytes`. */
enum server_outcome server_disk_read(const char *path, void **bytes, size_t *size);

/* Reads a file in pieces, from the disk instead of the page cache if possible. `visit` returns
 * false to stop. */
enum server_outcome server_disk_scan(const char *path,
                                     bool (*visit)(void *user, const void *bytes, size_t size),
                                     void *user);

/* Lists the files and folders in a folder, in any order, without names that begin with a dot:
 *
 *     struct server_listing listing = server_disk_list(folder);
 *     while (server_listing_next(&listing)) unlink(listing.path);
 *
 * server_listing_next closes the listing when it returns false, so a loop must not end earlier. */
struct server_listing {
    void *directory;
    size_t folder_size; /* bytes of the folder's path, with the slash */
    char path[SERVER_DISK_PATH], *name;
    bool is_readable; /* false if the folder can't be read */
};

struct server_listing server_disk_list(const char *folder);
bool server_listing_next(struct server_listing *listing);

enum server_outcome server_disk_remove(const char *path); /* removes a name, durably */

/* Make durable the bytes of a file, or the names in a folder. */
enum server_outcome server_disk_sync_file(const char *path);
enum server_outcome server_disk_sync_folder(const char *folder);

/* Copies a file. The bytes are durable; the caller makes the name durable. */
typedef enum server_outcome server_disk_copier(const char *path, const char *copy);
server_disk_copier server_disk_copy;
/* Makes a hard link, or a copy if links are impossible. */
server_disk_copier server_disk_link;

#define SERVER_DISK_ASIDE        ".damaged" /* part of the names of renamed damaged files */
#define SERVER_DISK_ASIDE_SUFFIX 64         /* largest number of bytes added to a name */

/* Renames a damaged file: appends a unique suffix to its name, and to the names of the -wal and
 * -shm files of a database. Writes the suffix to `suffix`. */
void server_disk_set_aside(const char *path, char suffix[SERVER_DISK_ASIDE_SUFFIX]);
