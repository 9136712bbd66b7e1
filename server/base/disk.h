/* Disk: files that are wholly there, and stay there, or are not there at all.
 *
 * Written under a temporary name, fsync'ed, renamed; the folder is fsync'ed so that the name stays
 * too. After a failed fsync the kernel may have dropped the data and call the next one a success:
 * so LOST is never tried again, by anyone. */
#ifndef SERVER_BASE_DISK_H
#define SERVER_BASE_DISK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum server_disk_result {
    SERVER_DISK_DONE,
    SERVER_DISK_ABSENT, /* no such file */
    SERVER_DISK_FULL,   /* no room (or quota); nothing changed */
    /* the system refuses it (rights, descriptors); nothing changed. errno tells */
    SERVER_DISK_REFUSED,
    /* an fsync or a write failed: what is on the disk is not known. errno tells */
    SERVER_DISK_LOST,
    SERVER_DISK_NO_MEMORY, /* nothing changed */
};

#define SERVER_DISK_PATH 4096

/* True when something has that path. */
bool server_disk_exists(const char *path);

/* Creates the folder if it is not there, and makes its name durable then: that of one which is
 * there already is not (who made it may have been killed before). */
enum server_disk_result server_disk_make_folder(const char *path);

/* Writes a file, whole and durable but for its name, as `temporary`, and gives it the name `path`
 * in place of what was there. `folder`: of `path`, is made durable. All three are in one file
 * system. */
enum server_disk_result server_disk_write(const char *folder, const char *path,
                                          const char *temporary, const void *bytes, size_t size);

/* Opens a regular file to read it, and never waits for it: a FIFO or a device is refused. A
 * descriptor, or -1: server_disk_why says why. */
int server_disk_open(const char *path);

/* Why the last call of this thread on a file failed, in words: that of errno, or that it is no
 * regular file. */
const char *server_disk_why(void);

/* The file's bytes and one NUL more, malloc'ed. */
enum server_disk_result server_disk_read(const char *path, void **bytes, size_t *size);

/* Shows a file piece by piece, as it is on the disk and not as the system remembers it, where that
 * can be had; `visit` returns false to end it. */
enum server_disk_result server_disk_scan(const char *path,
                                         bool (*visit)(void *user, const void *bytes, size_t size),
                                         void *user);

/* Bytes of a file. */
enum server_disk_result server_disk_size(const char *path, size_t *size);

/* Calls `visit` with the path of each file and folder in a folder, and its own name, in no order;
 * it may remove them. Names that begin with a dot are left out. False: the folder can't be read. */
bool server_disk_each(const char *folder,
                      void (*visit)(void *user, const char *path, const char *name), void *user);

/* Removes a name; the folder (NULL: it doesn't matter) is made durable. */
enum server_disk_result server_disk_remove(const char *folder, const char *path);

/* Makes a file's bytes durable. */
enum server_disk_result server_disk_sync_file(const char *path);

/* Makes the names in a folder durable. */
enum server_disk_result server_disk_sync_folder(const char *folder);

/* Copies a file, durably but for the new name, whose folder is for the caller to make durable. */
enum server_disk_result server_disk_copy(const char *path, const char *copy);

#define SERVER_DISK_ASIDE        ".damaged" /* in the names of damaged files that were set aside */
#define SERVER_DISK_ASIDE_SUFFIX 64         /* most bytes of what is added to a name */

/* Renames a damaged file, and those whose names are its own and one of `parts` (NULL-terminated),
 * so that a new one can be made: `suffix`, which no other has, is added to each name. */
void server_disk_set_aside(const char *path, const char *const *parts,
                           char suffix[SERVER_DISK_ASIDE_SUFFIX]);

/* The parts of a SQLite database. */
extern const char *const server_disk_database_parts[];

/* Gives a file a second name: a link, or a copy where links can't be made. */
enum server_disk_result server_disk_link(const char *path, const char *second);

#endif
