/* Inject: a preloaded library that makes the disk under INJECT_ROOT, the sockets and the clock fail
 * as the file INJECT_ORDER says:
 *
 *     fsync N     the N-th fsync from now on fails, with EIO; later ones succeed, as on Linux
 *     full N      from the N-th write from now on the disk is full: writes that enlarge a file fail
 *                 with ENOSPC, until enough files have been removed
 *     eio N       the N-th call that opens, reads, writes, renames, links, removes, creates or
 *                 truncates a file fails, with EIO
 *     short N     every N-th read or write is interrupted (EINTR), and the others transfer half
 *                 of the bytes
 *     reset N     the N-th call of a socket function reports that the client has disconnected:
 *                 send and receive by ECONNRESET, accept by ECONNABORTED
 *     clock N     the time of day is N seconds later, or earlier
 *     slow N      each fsync, and each removal of a file, takes N milliseconds longer
 *     fine        nothing fails
 *
 * "From now on" means after the last change of the order. The first failure of an order leaves a
 * file INJECT_ORDER.fired. */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static char order[64];
static long countdown; /* number of calls until the failure begins */
static long long room; /* remaining room in bytes after the disk has become full */

#define REAL(type, name, ...)                                                                      \
    static type (*real_##name)(__VA_ARGS__);                                                       \
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

/* Reads the order file while the lock is held. Returns whether the order has that kind. */
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

/* Sleeps if the order is `slow`. */
static void dawdle(void)
{
    pthread_mutex_lock(&lock);
    long milliseconds = is_ordered("slow") ? countdown : 0;
    pthread_mutex_unlock(&lock);
    if (milliseconds) usleep((useconds_t)milliseconds * 1000);
}

/* --- fsync ------------------------------------------------------------------------------------ */

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

#define SYNC(name)                                                                                 \
    int name(int file)                                                                             \
    {                                                                                              \
        REAL(int, name, int);                                                                      \
        return fails(file) ? -1 : real_##name(file);                                               \
    }

SYNC(fsync)
SYNC(fdatasync)

/* --- single calls ----------------------------------------------------------------------------- */

/* Returns whether the current call must fail by an order of that kind. */
static int is_due(const char *kind)
{
    pthread_mutex_lock(&lock);
    int due = is_ordered(kind) && --countdown == 0;
    pthread_mutex_unlock(&lock);
    if (due) fire();
    return due;
}

static int breaks(int ours)
{
    if (!ours || !is_due("eio")) return 0;
    errno = EIO;
    return 1;
}

/* Returns how many of `size` bytes a read or write transfers. 0 means that the call is
 * interrupted. */
static size_t part_of(int file, size_t size)
{
    if (size < 2 || !is_our_file(file)) return size;
    pthread_mutex_lock(&lock);
    int is_short = is_ordered("short");
    static long calls;
    int interrupted = is_short && countdown > 0 && ++calls % countdown == 0;
    pthread_mutex_unlock(&lock);
    if (is_short) fire();
    if (interrupted) errno = EINTR;
    return interrupted ? 0 : is_short ? size / 2 : size;
}

#define BY_PATH(name)                                                                              \
    int name(const char *path)                                                                     \
    {                                                                                              \
        REAL(int, name, const char *);                                                             \
        return breaks(is_ours(path)) ? -1 : real_##name(path);                                     \
    }

#define BY_TWO_PATHS(name)                                                                         \
    int name(const char *from, const char *to)                                                     \
    {                                                                                              \
        REAL(int, name, const char *, const char *);                                               \
        return breaks(is_ours(to)) ? -1 : real_##name(from, to);                                   \
    }

#define CUT(name)                                                                                  \
    int name(int file, off_t size)                                                                 \
    {                                                                                              \
        REAL(int, name, int, off_t);                                                               \
        return breaks(is_our_file(file)) ? -1 : real_##name(file, size);                           \
    }

#define OPEN(name)                                                                                 \
    int name(const char *path, int flags, ...)                                                     \
    {                                                                                              \
        REAL(int, name, const char *, int, ...);                                                   \
        va_list arguments;                                                                         \
        va_start(arguments, flags);                                                                \
        mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;                             \
        va_end(arguments);                                                                         \
        return breaks(is_ours(path)) ? -1 : real_##name(path, flags, mode);                        \
    }

#define PREAD(name)                                                                                \
    ssize_t name(int file, void *bytes, size_t size, off_t at)                                     \
    {                                                                                              \
        REAL(ssize_t, name, int, void *, size_t, off_t);                                           \
        size_t part = breaks(is_our_file(file)) ? 0 : part_of(file, size);                         \
        return part || !size ? real_##name(file, bytes, part, at) : -1;                            \
    }

BY_PATH(rmdir)
BY_TWO_PATHS(rename)
BY_TWO_PATHS(link)
CUT(ftruncate)
CUT(ftruncate64)
OPEN(open)
OPEN(open64)
PREAD(pread)
PREAD(pread64)

int mkdir(const char *path, mode_t mode)
{
    REAL(int, mkdir, const char *, mode_t);
    return breaks(is_ours(path)) ? -1 : real_mkdir(path, mode);
}

DIR *opendir(const char *path)
{
    REAL(DIR *, opendir, const char *);
    return breaks(is_ours(path)) ? NULL : real_opendir(path);
}

ssize_t read(int file, void *bytes, size_t size)
{
    REAL(ssize_t, read, int, void *, size_t);
    size_t part = breaks(is_our_file(file)) ? 0 : part_of(file, size);
    return part || !size ? real_read(file, bytes, part) : -1;
}

/* --- sockets and the clock -------------------------------------------------------------------- */

static int resets(int error)
{
    if (!is_due("reset")) return 0;
    errno = error;
    return 1;
}

ssize_t recv(int socket, void *bytes, size_t size, int flags)
{
    REAL(ssize_t, recv, int, void *, size_t, int);
    return resets(ECONNRESET) ? -1 : real_recv(socket, bytes, size, flags);
}

ssize_t send(int socket, const void *bytes, size_t size, int flags)
{
    REAL(ssize_t, send, int, const void *, size_t, int);
    return resets(ECONNRESET) ? -1 : real_send(socket, bytes, size, flags);
}

ssize_t recvfrom(int socket, void *restrict bytes, size_t size, int flags,
                 struct sockaddr *restrict address, socklen_t *restrict address_size)
{
    REAL(ssize_t, recvfrom, int, void *, size_t, int, struct sockaddr *, socklen_t *);
    return resets(ECONNRESET) ? -1
                              : real_recvfrom(socket, bytes, size, flags, address, address_size);
}

ssize_t sendmsg(int socket, const struct msghdr *message, int flags)
{
    REAL(ssize_t, sendmsg, int, const struct msghdr *, int);
    return resets(ECONNRESET) ? -1 : real_sendmsg(socket, message, flags);
}

ssize_t sendfile64(int socket, int file, off_t *at, size_t size)
{
    REAL(ssize_t, sendfile64, int, int, off_t *, size_t);
    return resets(ECONNRESET) ? -1 : real_sendfile64(socket, file, at, size);
}

int accept4(int socket, struct sockaddr *restrict address, socklen_t *restrict size, int flags)
{
    REAL(int, accept4, int, struct sockaddr *, socklen_t *, int);
    int accepted = real_accept4(socket, address, size, flags);
    if (accepted < 0 || !resets(ECONNABORTED)) return accepted;
    close(accepted);
    errno = ECONNABORTED;
    return -1;
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
    REAL(int, clock_gettime, clockid_t, struct timespec *);
    int result = real_clock_gettime(clock, now);
    if (result == 0 && clock == CLOCK_REALTIME) {
        pthread_mutex_lock(&lock);
        int ordered = is_ordered("clock");
        if (ordered) now->tv_sec += countdown;
        pthread_mutex_unlock(&lock);
        if (ordered) fire();
    }
    return result;
}

time_t time(time_t *out)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (out) *out = now.tv_sec;
    return now.tv_sec;
}

/* --- room ------------------------------------------------------------------------------------- */

/* Returns whether the disk has no room for a write that ends at `end`. */
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
    if (at >= 0 && is_full(file, (long long)at + (long long)size)) return -1;
    size_t part = breaks(is_our_file(file)) ? 0 : part_of(file, size);
    return part || !size ? real_write(file, bytes, part) : -1;
}

#define PWRITE(name)                                                                               \
    ssize_t name(int file, const void *bytes, size_t size, off_t at)                               \
    {                                                                                              \
        REAL(ssize_t, name, int, const void *, size_t, off_t);                                     \
        if (is_full(file, (long long)at + (long long)size)) return -1;                             \
        size_t part = breaks(is_our_file(file)) ? 0 : part_of(file, size);                         \
        return part || !size ? real_##name(file, bytes, part, at) : -1;                            \
    }

PWRITE(pwrite)
PWRITE(pwrite64)

int unlink(const char *path)
{
    REAL(int, unlink, const char *);
    struct stat facts;
    if (breaks(is_ours(path))) return -1;
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
