/* Record: a preloaded library that logs every change that a process makes to the files under
 * RECORD_ROOT, in order, to RECORD_LOG. replay.py replays the log without changes that were not
 * synced.
 *
 * An entry is a line "KIND SIZE A B [PATH] [PATH]\n" followed by SIZE bytes of data. Kinds: C
 * create file, M make folder, W write at A, T truncate to A, S sync, R rename, L link, U unlink, D
 * remove folder. Failed calls are omitted. One mutex is held during the call and the writing of its
 * entry, so that the log has the changes in the order in which they happened.
 *
 * RECORD_KILL, if it is set, is a kind: the process is killed right after its first change of that
 * kind. */
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int log_file = -1;
static const char *root;

#define REAL(type, name, ...)                                                                      \
    static type (*real_##name)(__VA_ARGS__);                                                       \
    if (!real_##name) real_##name = (type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name)

static void ready(void)
{
    if (root) return;
    root = getenv("RECORD_ROOT");
    const char *path = getenv("RECORD_LOG");
    if (!root || !path) abort();
    REAL(int, open, const char *, int, ...);
    log_file = real_open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (log_file < 0) abort();
}

static int is_ours(const char *path)
{
    ready();
    size_t size = strlen(root);
    return strncmp(path, root, size) == 0 && (path[size] == '/' || !path[size]);
}

/* Gets the path of a descriptor. Returns false if the path is outside RECORD_ROOT. */
static int path_of(int file, char path[4096])
{
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t size = readlink(link, path, 4095);
    if (size < 0) return 0;
    path[size] = '\0';
    return is_ours(path);
}

static void entry(char kind, long long a, const char *first, const char *second, const void *data,
                  size_t size)
{
    REAL(ssize_t, write, int, const void *, size_t);
    char head[9000];
    int head_size = snprintf(head, sizeof head, "%c %zu %lld [%s] [%s]\n", kind, size, a, first,
                             second ? second : "");
    char *whole = malloc((size_t)head_size + size);
    if (!whole) abort();
    memcpy(whole, head, (size_t)head_size);
    if (size) memcpy(whole + head_size, data, size);
    if (real_write(log_file, whole, (size_t)head_size + size) != head_size + (ssize_t)size) abort();
    free(whole);
    const char *end = getenv("RECORD_KILL");
    if (end && *end == kind) raise(SIGKILL);
}

/* --- files are made --------------------------------------------------------------------------- */

#define OPEN(name)                                                                                 \
    int name(const char *path, int flags, ...)                                                     \
    {                                                                                              \
        REAL(int, name, const char *, int, ...);                                                   \
        va_list arguments;                                                                         \
        va_start(arguments, flags);                                                                \
        mode_t mode = (flags & O_CREAT) ? va_arg(arguments, mode_t) : 0;                           \
        va_end(arguments);                                                                         \
        if (!is_ours(path)) return real_##name(path, flags, mode);                                 \
        pthread_mutex_lock(&lock);                                                                 \
        int is_new = (flags & O_CREAT) && access(path, F_OK) != 0;                                 \
        int file = real_##name(path, flags, mode);                                                 \
        if (file >= 0 && is_new) entry('C', 0, path, NULL, NULL, 0);                               \
        if (file >= 0 && !is_new && (flags & O_TRUNC)) entry('T', 0, path, NULL, NULL, 0);         \
        pthread_mutex_unlock(&lock);                                                               \
        return file;                                                                               \
    }

OPEN(open)
OPEN(open64)

/* --- files change ----------------------------------------------------------------------------- */

ssize_t write(int file, const void *bytes, size_t size)
{
    REAL(ssize_t, write, int, const void *, size_t);
    char path[4096];
    if (!path_of(file, path)) return real_write(file, bytes, size);
    pthread_mutex_lock(&lock);
    long long at = lseek(file, 0, SEEK_CUR);
    ssize_t written = real_write(file, bytes, size);
    if (written > 0) entry('W', at, path, NULL, bytes, (size_t)written);
    pthread_mutex_unlock(&lock);
    return written;
}

#define PWRITE(name)                                                                               \
    ssize_t name(int file, const void *bytes, size_t size, off_t at)                               \
    {                                                                                              \
        REAL(ssize_t, name, int, const void *, size_t, off_t);                                     \
        char path[4096];                                                                           \
        if (!path_of(file, path)) return real_##name(file, bytes, size, at);                       \
        pthread_mutex_lock(&lock);                                                                 \
        ssize_t written = real_##name(file, bytes, size, at);                                      \
        if (written > 0) entry('W', at, path, NULL, bytes, (size_t)written);                       \
        pthread_mutex_unlock(&lock);                                                               \
        return written;                                                                            \
    }

PWRITE(pwrite)
PWRITE(pwrite64)

#define TRUNCATE(name)                                                                             \
    int name(int file, off_t size)                                                                 \
    {                                                                                              \
        REAL(int, name, int, off_t);                                                               \
        char path[4096];                                                                           \
        if (!path_of(file, path)) return real_##name(file, size);                                  \
        pthread_mutex_lock(&lock);                                                                 \
        int result = real_##name(file, size);                                                      \
        if (result == 0) entry('T', size, path, NULL, NULL, 0);                                    \
        pthread_mutex_unlock(&lock);                                                               \
        return result;                                                                             \
    }

TRUNCATE(ftruncate)
TRUNCATE(ftruncate64)

#define SYNC(name)                                                                                 \
    int name(int file)                                                                             \
    {                                                                                              \
        REAL(int, name, int);                                                                      \
        char path[4096];                                                                           \
        if (!path_of(file, path)) return real_##name(file);                                        \
        pthread_mutex_lock(&lock);                                                                 \
        int result = real_##name(file);                                                            \
        if (result == 0) entry('S', 0, path, NULL, NULL, 0);                                       \
        pthread_mutex_unlock(&lock);                                                               \
        return result;                                                                             \
    }

SYNC(fsync)
SYNC(fdatasync)

/* --- names change ----------------------------------------------------------------------------- */

#define PAIR(name, kind)                                                                           \
    int name(const char *first, const char *second)                                                \
    {                                                                                              \
        REAL(int, name, const char *, const char *);                                               \
        if (!is_ours(first)) return real_##name(first, second);                                    \
        pthread_mutex_lock(&lock);                                                                 \
        int result = real_##name(first, second);                                                   \
        if (result == 0) entry(kind, 0, first, second, NULL, 0);                                   \
        pthread_mutex_unlock(&lock);                                                               \
        return result;                                                                             \
    }

PAIR(rename, 'R')
PAIR(link, 'L')

#define SINGLE(name, kind)                                                                         \
    int name(const char *path)                                                                     \
    {                                                                                              \
        REAL(int, name, const char *);                                                             \
        if (!is_ours(path)) return real_##name(path);                                              \
        pthread_mutex_lock(&lock);                                                                 \
        int result = real_##name(path);                                                            \
        if (result == 0) entry(kind, 0, path, NULL, NULL, 0);                                      \
        pthread_mutex_unlock(&lock);                                                               \
        return result;                                                                             \
    }

SINGLE(unlink, 'U')
SINGLE(rmdir, 'D')

int mkdir(const char *path, mode_t mode)
{
    REAL(int, mkdir, const char *, mode_t);
    if (!is_ours(path)) return real_mkdir(path, mode);
    pthread_mutex_lock(&lock);
    int result = real_mkdir(path, mode);
    if (result == 0) entry('M', 0, path, NULL, NULL, 0);
    pthread_mutex_unlock(&lock);
    return result;
}
