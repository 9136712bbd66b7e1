/* See disk.h. */
#include "server/base/disk.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define FOLDER_MODE 0700
#define FILE_MODE   0600
#define WRITE_MOST  ((size_t)1 << 30)

/* The result of a failed operation that changed nothing. */
static enum server_disk_result errno_result(void)
{
    if (errno == ENOENT) return SERVER_DISK_ABSENT;
    if (errno == ENOSPC || errno == EDQUOT) return SERVER_DISK_FULL;
    return errno == ENOMEM ? SERVER_DISK_NO_MEMORY : SERVER_DISK_REFUSED;
}

/* These two keep errno. */
static void close_quietly(int file)
{
    int kept = errno;
    close(file);
    errno = kept;
}

static void unlink_quietly(const char *path)
{
    int kept = errno;
    unlink(path);
    errno = kept;
}

/* Opens a folder before something in it changes: without a descriptor nothing has changed. */
static int folder_open(const char *folder)
{
    return open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/* Makes the changes of a folder or a file durable, and closes it. */
static enum server_disk_result sync_and_close(int file)
{
    int failed = fsync(file);
    close_quietly(file);
    return failed ? SERVER_DISK_LOST : SERVER_DISK_DONE;
}

bool server_disk_exists(const char *path)
{
    struct stat facts;
    return stat(path, &facts) == 0;
}

enum server_disk_result server_disk_sync_folder(const char *folder)
{
    int file = folder_open(folder);
    if (file < 0)
        return errno_result() == SERVER_DISK_ABSENT ? SERVER_DISK_ABSENT : SERVER_DISK_LOST;
    return sync_and_close(file);
}

enum server_disk_result server_disk_sync_file(const char *path)
{
    int file = server_disk_open(path);
    return file < 0 ? errno_result() : sync_and_close(file);
}

enum server_disk_result server_disk_make_folder(const char *path)
{
    char text[SERVER_DISK_PATH];
    if (server_disk_exists(path)) return SERVER_DISK_DONE;
    snprintf(text, sizeof text, "%s", path);
    int parent = folder_open(dirname(text));
    if (parent < 0) return errno_result();
    if (mkdir(path, FOLDER_MODE) == 0) return sync_and_close(parent);
    enum server_disk_result result = errno == EEXIST ? SERVER_DISK_DONE : errno_result();
    close_quietly(parent);
    return result;
}

/* --- writing ---------------------------------------------------------------------------------- */

static enum server_disk_result file_write(int file, const char *bytes, size_t size)
{
    while (size) {
        ssize_t written = write(file, bytes, size < WRITE_MOST ? size : WRITE_MOST);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0)
            return errno_result() == SERVER_DISK_FULL ? SERVER_DISK_FULL : SERVER_DISK_LOST;
        bytes += written;
        size -= (size_t)written;
    }
    return fsync(file) ? SERVER_DISK_LOST : SERVER_DISK_DONE;
}

static enum server_disk_result file_create(const char *path, const void *bytes, size_t size)
{
    int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, FILE_MODE);
    if (file < 0) return errno_result();
    enum server_disk_result result = file_write(file, bytes, size);
    close_quietly(file);
    if (result) unlink_quietly(path);
    return result;
}

enum server_disk_result server_disk_write(const char *folder, const char *path,
                                          const char *temporary, const void *bytes, size_t size)
{
    int parent = folder_open(folder);
    if (parent < 0) return errno_result();
    enum server_disk_result result = file_create(temporary, bytes, size);
    if (!result && rename(temporary, path) != 0) {
        unlink_quietly(temporary);
        result = errno_result();
    }
    if (!result) return sync_and_close(parent);
    close_quietly(parent);
    return result;
}

/* --- reading ---------------------------------------------------------------------------------- */

#define IRREGULAR ENOTSUP /* errno of a file that is not regular */

int server_disk_open(const char *path)
{
    struct stat facts;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0) return -1;
    if (fstat(file, &facts) == 0 && S_ISREG(facts.st_mode)) return file;
    close(file);
    errno = IRREGULAR;
    return -1;
}

const char *server_disk_why(void)
{
    return errno == IRREGULAR ? "it is no regular file" : strerror(errno);
}

static enum server_disk_result file_read(int file, void **bytes, size_t *size)
{
    struct stat facts;
    if (fstat(file, &facts) != 0) return errno_result();
    const size_t total = (size_t)facts.st_size;
    char *buffer = malloc(total + 1);
    if (!buffer) return SERVER_DISK_NO_MEMORY;
    for (size_t at = 0; at < total;) {
        ssize_t got = read(file, buffer + at, total - at);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) {
            free(buffer);
            return SERVER_DISK_REFUSED;
        }
        at += (size_t)got;
    }
    buffer[total] = '\0';
    *bytes = buffer;
    *size = total;
    return SERVER_DISK_DONE;
}

enum server_disk_result server_disk_read(const char *path, void **bytes, size_t *size)
{
    int file = server_disk_open(path);
    if (file < 0) return errno_result();
    enum server_disk_result result = file_read(file, bytes, size);
    close_quietly(file);
    return result;
}

#define PIECE ((size_t)256 << 10)

/* Drops the file's first bytes (0: all) from the page cache, which hides the disk's state, and
 * where a file that is only checked has no place. */
static void pages_drop(int file, off_t bytes)
{
    (void)posix_fadvise(file, 0, bytes, POSIX_FADV_DONTNEED);
}

enum server_disk_result server_disk_scan(const char *path,
                                         bool (*visit)(void *user, const void *bytes, size_t size),
                                         void *user)
{
    int file = server_disk_open(path);
    if (file < 0) return errno_result();
    char *piece = malloc(PIECE);
    enum server_disk_result result = piece ? SERVER_DISK_DONE : SERVER_DISK_NO_MEMORY;
    pages_drop(file, 0);
    for (off_t at = 0; piece;) {
        ssize_t got = read(file, piece, PIECE);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) result = SERVER_DISK_REFUSED;
        if (got <= 0 || !visit(user, piece, (size_t)got)) break;
        at += got;
        pages_drop(file, at);
    }
    free(piece);
    close_quietly(file);
    return result;
}

enum server_disk_result server_disk_size(const char *path, size_t *size)
{
    struct stat facts;
    if (stat(path, &facts) != 0) return errno_result();
    *size = (size_t)facts.st_size;
    return SERVER_DISK_DONE;
}

struct server_listing server_disk_list(const char *folder)
{
    struct server_listing listing = {.directory = opendir(folder)};
    listing.is_readable = listing.directory != NULL;
    int size = snprintf(listing.path, sizeof listing.path, "%s/", folder);
    listing.folder_size = size < (int)sizeof listing.path ? (size_t)size : sizeof listing.path;
    return listing;
}

bool server_listing_next(struct server_listing *listing)
{
    size_t room = sizeof listing->path - listing->folder_size;
    listing->name = listing->path + listing->folder_size;
    for (struct dirent *entry; listing->directory && (entry = readdir(listing->directory));)
        if (entry->d_name[0] != '.' && strlen(entry->d_name) < room) {
            strcpy(listing->name, entry->d_name);
            return true;
        }
    if (listing->directory) closedir(listing->directory);
    listing->directory = NULL;
    return false;
}

bool server_disk_each(const char *folder,
                      void (*visit)(void *user, const char *path, const char *name), void *user)
{
    struct server_listing listing = server_disk_list(folder);
    while (server_listing_next(&listing)) visit(user, listing.path, listing.name);
    return listing.is_readable;
}

/* --- names ------------------------------------------------------------------------------------ */

enum server_disk_result server_disk_remove(const char *folder, const char *path)
{
    int parent = folder ? folder_open(folder) : -1;
    if (folder && parent < 0) return errno_result();
    enum server_disk_result result = unlink(path) != 0 ? errno_result() : SERVER_DISK_DONE;
    if (!result && folder) return sync_and_close(parent);
    if (folder) close_quietly(parent);
    return result;
}

enum server_disk_result server_disk_copy(const char *path, const char *copy)
{
    void *bytes;
    size_t size;
    enum server_disk_result result = server_disk_read(path, &bytes, &size);
    if (result) return result;
    result = file_create(copy, bytes, size);
    free(bytes);
    return result;
}

enum server_disk_result server_disk_link(const char *path, const char *second)
{
    if (link(path, second) == 0) return SERVER_DISK_DONE;
    if (errno != EXDEV && errno != EPERM && errno != EMLINK && errno != EOPNOTSUPP)
        return errno_result();
    return server_disk_copy(path, second);
}

/* --- damaged files ---------------------------------------------------------------------------- */

const char *const server_disk_database_parts[] = {"", "-wal", "-shm", NULL};

static bool path_join(char path[SERVER_DISK_PATH], const char *file, const char *part,
                      const char *suffix)
{
    int size = snprintf(path, SERVER_DISK_PATH, "%s%s%s", file, part, suffix);
    return size > 0 && size < SERVER_DISK_PATH;
}

static bool suffix_is_taken(const char *path, const char *const *parts, const char *suffix)
{
    char aside[SERVER_DISK_PATH];
    for (; *parts; parts++)
        if (path_join(aside, path, *parts, suffix) && server_disk_exists(aside)) return true;
    return false;
}

void server_disk_set_aside(const char *path, const char *const *parts,
                           char suffix[SERVER_DISK_ASIDE_SUFFIX])
{
    char from[SERVER_DISK_PATH], aside[SERVER_DISK_PATH];
    unsigned number = 1;
    do
        snprintf(suffix, SERVER_DISK_ASIDE_SUFFIX, SERVER_DISK_ASIDE "-%lld-%u",
                 (long long)time(NULL), number++);
    while (suffix_is_taken(path, parts, suffix));
    for (; *parts; parts++)
        if (path_join(from, path, *parts, "") && path_join(aside, path, *parts, suffix))
            (void)rename(from, aside);
    snprintf(aside, sizeof aside, "%s", path);
    (void)server_disk_sync_folder(dirname(aside));
}
