/* Disk: files that are complete and durable, or absent.
 *
 * A file is written under a temporary name, fsync'ed and renamed; then its folder is fsync'ed, so
 * that the name is durable too. After a failed fsync or write the kernel may have dropped the data
 * and report success the next time. So READ_ONLY is never retried. Thread-safe. */
#ifndef SERVER_BASE_DISK_H
#define SERVER_BASE_DISK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* How storing ends: a file here, a surface or a row in server/store. */
enum server_store_outcome {
    SERVER_STORE_DONE,
    SERVER_STORE_CREATED,      /* of the registry: done, the name is new */
    SERVER_STORE_REPLACED,     /* of the registry: done, the name had a surface */
    SERVER_STORE_ABSENT,       /* there is no such file or surface */
    SERVER_STORE_PRECONDITION, /* of the registry: it fails; nothing changed */
    SERVER_STORE_NO_MEMORY,    /* nothing changed */
    SERVER_STORE_FULL,         /* no room, or over quota; nothing changed */
    SERVER_STORE_REFUSED,      /* rights, descriptors, no folder, see errno; nothing changed */
    SERVER_STORE_READ_ONLY,    /* this write or an earlier one is not durable: writing has ended */
    SERVER_STORE_DAMAGED,      /* the stored bytes are not those that were put */
    SERVER_STORE_STALE,        /* another daemon has changed the surface; nothing changed */
    SERVER_STORE_UNAVAILABLE   /* out of reach for now; a change may turn out to be done */
};

#define SERVER_DISK_PATH 4096

/* Whether something has that path. */
bool server_disk_exists(const char *path);

/* Creates the folder if it is absent, with a durable name. The name of a present one is not made
 * durable (the process that created it may have been killed). */
enum server_store_outcome server_disk_make_folder(const char *path);

/* Writes a file as `temporary` and renames it to `path`, which it replaces, durably. Both are in one
 * file system. */
enum server_store_outcome server_disk_write(const char *path, const char *temporary,
                                            const void *bytes, size_t size);

/* Opens a regular file to read it; never blocks on a FIFO or a device. NULL: see server_disk_why. */
FILE *server_disk_stream(const char *path);

/* Why this thread's last call failed, from errno. */
const char *server_disk_why(void);

/* Reads the file, with one NUL more. The caller frees `*bytes`. */
enum server_store_outcome server_disk_read(const char *path, void **bytes, size_t *size);

/* Shows a file in pieces, from the disk and not from the page cache where possible. `visit` returns
 * false to stop. */
enum server_store_outcome
server_disk_scan(const char *path, bool (*visit)(void *user, const void *bytes, size_t size),
                 void *user);

/* The files and folders in a folder, in no order, except names that begin with a dot:
 *
 *     struct server_listing listing = server_disk_list(folder);
 *     while (server_listing_next(&listing)) unlink(listing.path);
 *
 * next closes the listing when it returns false; the loop must not end before. */
struct server_listing {
    void *directory;
    size_t folder_size; /* of the path, with the slash */
    char path[SERVER_DISK_PATH], *name;
    bool is_readable; /* false: the folder can't be read */
};

struct server_listing server_disk_list(const char *folder);
bool server_listing_next(struct server_listing *listing);

enum server_store_outcome server_disk_remove(const char *path); /* a name, durably */

/* Make durable the bytes of a file, or the names in a folder. */
enum server_store_outcome server_disk_sync_file(const char *path);
enum server_store_outcome server_disk_sync_folder(const char *folder);

/* Copies a file. The bytes are durable; the caller makes the name durable. */
typedef enum server_store_outcome server_disk_copier(const char *path, const char *copy);
server_disk_copier server_disk_copy;
/* The same by a second name, or by a copy where links are impossible. */
server_disk_copier server_disk_link;

#define SERVER_DISK_ASIDE        ".damaged" /* part of the names of damaged files set aside */
#define SERVER_DISK_ASIDE_SUFFIX 64         /* most bytes added to a name */

/* Renames a damaged file, and the other files of a SQLite database of that name, so that a new one
 * can be made. Adds the unique `suffix` to each name. */
void server_disk_set_aside(const char *path, char suffix[SERVER_DISK_ASIDE_SUFFIX]);

#endif
