/* Inject: a library to preload, which makes the disk under INJECT_ROOT fail as the file INJECT_ORDER says:
 *
 *     fsync N     the N-th fsync from now on fails, with EIO; those after it succeed, as Linux has it
 *     full N      from the N-th write from now on there is no room: what would make a file larger fails with ENOSPC, until
 *                 removed files have made room
 *     slow N      each fsync, and each removal of a file, takes N milliseconds longer
 *     fine        nothing fails
 *
 * "From now on" begins when the order changes. The first failure of an order leaves a file INJECT_ORDER.fired. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static char order[64];
static long countdown; /* calls until the failure begins */
static long long room; /* bytes, once the disk is full */

#define REAL(type, name, ...)                                                                                          \
    static type (*real_##name)(__VA_ARGS__);                                                                           \
    if (!real_##name) real_##name = (type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name)

static int is_ours(const char *path)
{
    const char *root = getenv("INJECT_ROOT");
    size_t size = root ? strlen(root) : 0;
    return size && strncmp(path, root, size) == 0 && path[size] == '/';
}

static int is_our_file(int file)
{
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t size = readlink(link, path, sizeof path - 1);
    if (size < 0) return 0;
    path[size] = '\0';
    const char *root = getenv("INJECT_ROOT");
    return is_ours(path) || (root && strcmp(path, root) == 0);
}

/* Reads the order; under the lock. Is it of that kind? */
static int is_ordered(const char *kind)
{
    char now[sizeof order] = "";
    const char *path = getenv("INJECT_ORDER");
    int file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0) return 0;
    ssize_t size = read(file, now, sizeof now - 1);
    close(file);
    if (size >= 0 && strcmp(now, order) != 0) {
        strcpy(order, now);
        countdown = strtol(order + strcspn(order, " "), NULL, 10);
        room = 0;
    }
    return strncmp(order, kind, strlen(kind)) == 0;
}

/* Marks that the order was carried out. */
static void fire(void)
{
    char path[4096];
    snprintf(path, sizeof path, "%s.fired", getenv("INJECT_ORDER"));
    close(open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
}

/* If that is the order. */
static void dawdle(void)
{
    pthread_mutex_lock(&lock);
    long milliseconds = is_ordered("slow") ? countdown : 0;
    pthread_mutex_unlock(&lock);
    if (milliseconds) usleep((useconds_t)milliseconds * 1000);
}

/* --- fsync -------------------------------------------------------------------------------------------------------- */

static int fails(int file)
{
    if (!is_our_file(file)) return 0;
    pthread_mutex_lock(&lock);
    int failed = is_ordered("fsync") && --countdown == 0;
    pthread_mutex_unlock(&lock);
    if (failed) fire();
    if (failed) errno = EIO;
    if (!failed) dawdle();
    return failed;
}

#define SYNC(name)                                                                                                     \
    int name(int file)                                                                                                 \
    {                                                                                                                  \
        REAL(int, name, int);                                                                                          \
        return fails(file) ? -1 : real_##name(file);                                                                   \
    }

SYNC(fsync)
SYNC(fdatasync)

/* --- room --------------------------------------------------------------------------------------------------------- */

/* Is there no room for a write that ends at `end`? */
static int is_full(int file, long long end)
{
    struct stat facts;
    if (!is_our_file(file) || fstat(file, &facts) != 0) return 0;
    pthread_mutex_lock(&lock);
    int full = 0;
    if (is_ordered("full") && (countdown <= 1 || --countdown < 1)) {
        long long growth = end > facts.st_size ? end - facts.st_size : 0;
        full = growth > room;
        if (!full) room -= growth;
    }
    pthread_mutex_unlock(&lock);
    if (full) fire();
    if (full) errno = ENOSPC;
    return full;
}

ssize_t write(int file, const void *bytes, size_t size)
{
    REAL(ssize_t, write, int, const void *, size_t);
    off_t at = lseek(file, 0, SEEK_CUR);
    return at >= 0 && is_full(file, (long long)at + (long long)size) ? -1 : real_write(file, bytes, size);
}

#define PWRITE(name)                                                                                                   \
    ssize_t name(int file, const void *bytes, size_t size, off_t at)                                                   \
    {                                                                                                                  \
        REAL(ssize_t, name, int, const void *, size_t, off_t);                                                         \
        return is_full(file, (long long)at + (long long)size) ? -1 : real_##name(file, bytes, size, at);               \
    }

PWRITE(pwrite)
PWRITE(pwrite64)

int unlink(const char *path)
{
    REAL(int, unlink, const char *);
    struct stat facts;
    int is_last = is_ours(path) && stat(path, &facts) == 0 && facts.st_nlink == 1;
    int result = real_unlink(path);
    if (is_ours(path)) dawdle();
    if (result == 0 && is_last) {
        pthread_mutex_lock(&lock);
        if (is_ordered("full")) room += facts.st_size;
        pthread_mutex_unlock(&lock);
    }
    return result;
}
