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

/* Returns the outcome for errno, after an operation that changed nothing. */
static enum server_outcome errno_outcome(void)
{
    if (errno == ENOENT) return SERVER_STORE_ABSENT;
    if (errno == ENOSPC || errno == EDQUOT) return SERVER_STORE_FULL;
    return errno == ENOMEM ? SERVER_STORE_NO_MEMORY : SERVER_STORE_REFUSED;
}

/* Closes the file and preserves errno. */
static void close_quietly(int file)
{
    int kept = errno;
    if (file >= 0) close(file);
    errno = kept;
}

static enum server_outcome sync_and_close(int file)
{
    int failed = fsync(file);
    close_quietly(file);
    return failed ? SERVER_STORE_READ_ONLY : SERVER_STORE_DONE;
}

static int folder_open(const char *folder)
{
    return open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/* Opens the folder of a file. Callers call this function first, so that nothing has changed if it
 * fails. */
static int parent_open(const char *path)
{
    char text[SERVER_DISK_PATH];
    snprintf(text, sizeof text, "%s", path);
    return folder_open(dirname(text));
}

/* Closes the folder. If `outcome` is DONE, first makes the change in the folder durable. */
static enum server_outcome parent_close(int parent, enum server_outcome outcome)
{
    if (!outcome) return sync_and_close(parent);
    close_quietly(parent);
    return outcome;
}

bool server_disk_exists(const char *path)
{
    struct stat facts;
    return stat(path, &facts) == 0;
}

enum server_outcome server_disk_sync_folder(const char *folder)
{
    int file = folder_open(folder);
    if (file >= 0) return sync_and_close(file);
    return errno == ENOENT ? SERVER_STORE_ABSENT : SERVER_STORE_READ_ONLY;
}

enum server_outcome server_disk_make_folder(const char *path)
{
    if (server_disk_exists(path)) return SERVER_STORE_DONE;
    int parent = parent_open(path);
    if (parent < 0) return SERVER_STORE_REFUSED;
    if (mkdir(path, FOLDER_MODE) == 0) return sync_and_close(parent);
    close_quietly(parent);
    return errno == EEXIST ? SERVER_STORE_DONE : errno_outcome();
}

enum server_outcome server_disk_remove(const char *path)
{
    int parent = parent_open(path);
    if (parent < 0) return errno_outcome();
    return parent_close(parent, unlink(path) ? errno_outcome() : SERVER_STORE_DONE);
}

/* --- writing ---------------------------------------------------------------------------------- */

static enum server_outcome descriptor_write(int file, const char *bytes, size_t size)
{
    while (size) {
        ssize_t written = write(file, bytes, size < WRITE_MOST ? size : WRITE_MOST);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0)
            return errno_outcome() == SERVER_STORE_FULL ? SERVER_STORE_FULL
                                                        : SERVER_STORE_READ_ONLY;
        bytes += written;
        size -= (size_t)written;
    }
    return fsync(file) ? SERVER_STORE_READ_ONLY : SERVER_STORE_DONE;
}

static enum server_outcome file_create(const char *path, const void *bytes, size_t size)
{
    int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, FILE_MODE);
    if (file < 0) return errno == ENOENT ? SERVER_STORE_REFUSED : errno_outcome();
    enum server_outcome outcome = descriptor_write(file, bytes, size);
    int why = errno;
    close(file);
    if (outcome) unlink(path);
    errno = why;
    return outcome;
}

enum server_outcome server_disk_write(const char *path, const char *temporary, const void *bytes,
                                      size_t size)
{
    int parent = parent_open(path);
    if (parent < 0) return errno == ENOENT ? SERVER_STORE_REFUSED : errno_outcome();
    enum server_outcome outcome = file_create(temporary, bytes, size);
    if (!outcome && rename(temporary, path) != 0) {
        outcome = errno == ENOENT ? SERVER_STORE_REFUSED : errno_outcome();
        int why = errno;
        unlink(temporary);
        errno = why;
    }
    return parent_close(parent, outcome);
}

enum server_outcome server_disk_copy(const char *path, const char *copy)
{
    void *bytes;
    size_t size;
    enum server_outcome outcome = server_disk_read(path, &bytes, &size);
    if (outcome) return outcome;
    outcome = file_create(copy, bytes, size);
    free(bytes);
    return outcome;
}

enum server_outcome server_disk_link(const char *path, const char *second)
{
    if (link(path, second) == 0) return SERVER_STORE_DONE;
    bool can_copy = errno == EXDEV || errno == EPERM || errno == EMLINK || errno == EOPNOTSUPP;
    return can_copy ? server_disk_copy(path, second) : errno_outcome();
}

/* --- reading ---------------------------------------------------------------------------------- */

#define IRREGULAR ENOTSUP /* errno for a file that is not regular */

static int file_open(const char *path, size_t *size)
{
    struct stat facts = {0};
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0) return -1;
    bool is_regular = fstat(file, &facts) == 0 && S_ISREG(facts.st_mode);
    *size = (size_t)facts.st_size;
    if (is_regular) return file;
    close(file);
    errno = IRREGULAR;
    return -1;
}

FILE *server_disk_stream(const char *path)
{
    size_t size;
    int file = file_open(path, &size);
    FILE *stream = file < 0 ? NULL : fdopen(file, "r");
    if (!stream) close_quietly(file);
    return stream;
}

const char *server_disk_why(void)
{
    return errno == IRREGULAR ? "it is not a regular file" : strerror(errno);
}

enum server_outcome server_disk_sync_file(const char *path)
{
    size_t size;
    int file = file_open(path, &size);
    return file < 0 ? errno_outcome() : sync_and_close(file);
}

enum server_outcome server_disk_read(const char *path, void **bytes, size_t *size)
{
    ssize_t got = 1;
    int file = file_open(path, size);
    if (file < 0) return errno_outcome();
    char *buffer = malloc(*size + 1);
    for (size_t at = 0; buffer && got > 0 && at < *size; at += (size_t)got)
        while ((got = read(file, buffer + at, *size - at)) < 0 && errno == EINTR) continue;
    close_quietly(file);
    if (!buffer) return SERVER_STORE_NO_MEMORY;
    if (got <= 0) {
        free(buffer);
        return SERVER_STORE_REFUSED;
    }
    buffer[*size] = '\0';
    *bytes = buffer;
    return SERVER_STORE_DONE;
}

#define PIECE ((size_t)256 << 10)

enum server_outcome server_disk_scan(const char *path,
                                     bool (*visit)(void *user, const void *bytes, size_t size),
                                     void *user)
{
    size_t size;
    int file = file_open(path, &size);
    if (file < 0) return errno_outcome();
    char *piece = malloc(PIECE);
    enum server_outcome outcome = piece ? SERVER_STORE_DONE : SERVER_STORE_NO_MEMORY;
    for (off_t at = 0; piece;) {
        /* The page cache hides damage of the disk. So this call drops the pages that were read; the
           first call drops all pages of the file. */
        (void)posix_fadvise(file, 0, at, POSIX_FADV_DONTNEED);
        ssize_t got = read(file, piece, PIECE);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) outcome = SERVER_STORE_REFUSED;
        if (got <= 0 || !visit(user, piece, (size_t)got)) break;
        at += got;
    }
    free(piece);
    close_quietly(file);
    return outcome;
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

void server_disk_set_aside(const char *path, char suffix[SERVER_DISK_ASIDE_SUFFIX])
{
    static const char *const parts[] = {"", "-wal", "-shm"};
    char from[SERVER_DISK_PATH], aside[SERVER_DISK_PATH];
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    snprintf(suffix, SERVER_DISK_ASIDE_SUFFIX, SERVER_DISK_ASIDE "-%lld-%09ld",
             (long long)now.tv_sec, now.tv_nsec);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        snprintf(from, sizeof from, "%s%s", path, parts[i]);
        int size = snprintf(aside, sizeof aside, "%s%s", from, suffix);
        if (size < SERVER_DISK_PATH) (void)rename(from, aside);
    }
    int parent = parent_open(path);
    if (parent >= 0) (void)sync_and_close(parent);
}
