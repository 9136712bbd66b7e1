/* See sandbox.h. */
#include "server/access/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <linux/capability.h>
#include <linux/landlock.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/work/thread_priority.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define IS_SANITIZED true
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED true
#endif
#ifndef IS_SANITIZED
#define IS_SANITIZED false
#endif

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* --- Landlock: files and ports ---------------------------------------------------------------- */
/* Linux, Documentation/userspace-api/landlock.rst. Headers of Linux 6.1 lack what is defined
 * here. */

#define FS_TRUNCATE (UINT64_C(1) << 14) /* since version 3 of the interface */
#define FS_ALL_OF_2 ((UINT64_C(1) << 14) - 1)
#define FS_ALL_OF_3 ((UINT64_C(1) << 15) - 1)
#define FS_ALL_OF_5 ((UINT64_C(1) << 16) - 1)
#define RULE_PORT   2 /* since version 4, like the rights to ports */
#define BIND_TCP    UINT64_C(1)
#define CONNECT_TCP UINT64_C(2)
#define SCOPES_ALL  UINT64_C(3) /* since version 6: abstract unix sockets, signals */
#define FS_READ     (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)
#define FS_STORE                                                                                   \
    (FS_READ | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |                     \
     LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |  \
     LANDLOCK_ACCESS_FS_REFER | FS_TRUNCATE)

/* What is forbidden unless a rule allows it, as the kernel takes it. */
struct handled {
    uint64_t files, ports, scopes;
};

struct ruleset {
    int descriptor;
    struct handled handled;
};

/* Fills in what this version of the interface knows. Returns the bytes of it. */
static size_t handled_fill(struct handled *handled, long version)
{
    uint64_t files = version >= 5 ? FS_ALL_OF_5 : version >= 3 ? FS_ALL_OF_3 : FS_ALL_OF_2;
    *handled = (struct handled){files, BIND_TCP | CONNECT_TCP, SCOPES_ALL};
    if (version >= 6) return sizeof *handled;
    return version >= 4 ? offsetof(struct handled, scopes) : offsetof(struct handled, ports);
}

static bool ruleset_allow_path(const struct ruleset *ruleset, const char *path, int flags,
                               uint64_t rights)
{
    int descriptor = open(path, O_PATH | O_CLOEXEC | flags);
    if (descriptor < 0) return false;
    const struct landlock_path_beneath_attr rule = {
        .allowed_access = rights & ruleset->handled.files, .parent_fd = descriptor};
    bool is_added = syscall(SYS_landlock_add_rule, ruleset->descriptor, LANDLOCK_RULE_PATH_BENEATH,
                            &rule, 0) == 0;
    close(descriptor);
    return is_added;
}

static bool ruleset_allow_folder_of(const struct ruleset *ruleset, const char *file,
                                    uint64_t rights)
{
    char path[PATH_MAX];
    if (strlen(file) >= sizeof path) return false;
    strcpy(path, file);
    return ruleset_allow_path(ruleset, dirname(path), O_DIRECTORY, rights);
}

/* The folder of the file's name and, if the name is a link, that of the file. */
static bool ruleset_allow_rereading(const struct ruleset *ruleset, const char *file)
{
    char *real = realpath(file, NULL);
    bool is_allowed = real && ruleset_allow_folder_of(ruleset, file, FS_READ) &&
                      ruleset_allow_folder_of(ruleset, real, FS_READ);
    free(real);
    return is_allowed;
}

/* A file that is absent needs no rule. */
static void ruleset_allow_file(void *user, const char *file)
{
    (void)ruleset_allow_path(user, file, 0, LANDLOCK_ACCESS_FS_READ_FILE);
}

static bool ruleset_allow_port(void *user, uint16_t port)
{
    const struct ruleset *ruleset = user;
    const struct {
        uint64_t allowed, port;
    } rule = {CONNECT_TCP, port};
    return syscall(SYS_landlock_add_rule, ruleset->descriptor, RULE_PORT, &rule, 0) == 0;
}

/* A connection may be made at any time: its ports, libpq's files, and the files by which libc
 * resolves hosts and users. */
static bool ruleset_allow_database(struct ruleset *ruleset,
                                   const struct server_sandbox_needs *needs, bool has_ports)
{
    static const char *const lookups[] = {
        "/etc/hosts",    "/etc/resolv.conf", "/etc/nsswitch.conf", "/etc/host.conf",
        "/etc/gai.conf", "/etc/services",    "/etc/passwd",        "/etc/ssl/openssl.cnf"};
    for (size_t i = 0; i < COUNT(lookups); i++) ruleset_allow_file(ruleset, lookups[i]);
    return (!has_ports || needs->each_port(needs->database, ruleset_allow_port, ruleset)) &&
           needs->each_file(needs->database, ruleset_allow_file, ruleset);
}

static bool ruleset_allow(struct ruleset *ruleset, const struct server_sandbox_needs *needs,
                          bool has_ports)
{
    const struct sockaddr_un *address = (const struct sockaddr_un *)&needs->address->socket;
    for (size_t i = 0; i < COUNT(needs->files); i++)
        if (needs->files[i] && *needs->files[i] &&
            !ruleset_allow_rereading(ruleset, needs->files[i]))
            return false;
    if (address->sun_family == AF_UNIX &&
        !ruleset_allow_folder_of(ruleset, address->sun_path,
                                 LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_REMOVE_FILE))
        return false;
    if (needs->folder && !ruleset_allow_path(ruleset, needs->folder, O_DIRECTORY, FS_STORE))
        return false;
    return !needs->database || ruleset_allow_database(ruleset, needs, has_ports);
}

/* Restricts the calling thread and the threads that it starts. NULL, or why nothing is
 * restricted. */
static const char *landlock_enter(const struct server_sandbox_needs *needs)
{
    struct ruleset ruleset;
    long version = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 0) return "this kernel has no Landlock, or it is not enabled";
    if (version < 2)
        return "this kernel's Landlock forbids renames from folder to folder: it wants Linux 5.19";
    size_t size = handled_fill(&ruleset.handled, version);
    ruleset.descriptor = (int)syscall(SYS_landlock_create_ruleset, &ruleset.handled, size, 0);
    if (ruleset.descriptor < 0) return strerror(errno);
    const char *missing = NULL;
    if (!ruleset_allow(&ruleset, needs, version >= 4))
        missing = "a file or folder that the daemon needs is not there";
    else if (syscall(SYS_landlock_restrict_self, ruleset.descriptor, 0) != 0)
        missing = strerror(errno);
    close(ruleset.descriptor);
    return missing;
}

/* --- seccomp: system calls -------------------------------------------------------------------- */

/* Calls of a running daemon: its own code, libc, libmicrohttpd, SQLite, GnuTLS. The kernel (since
 * 5.11) caches which calls a filter always allows, so this list costs nothing. Calls that change a
 * file's mode, owner or times by path are left out: Landlock does not cover them. */
static const int allowed_calls[] = {
    /* connections */
    SCMP_SYS(epoll_wait), SCMP_SYS(epoll_pwait), SCMP_SYS(epoll_ctl), SCMP_SYS(recvfrom),
    SCMP_SYS(recvmsg), SCMP_SYS(accept4), SCMP_SYS(accept), SCMP_SYS(shutdown),
    SCMP_SYS(setsockopt), SCMP_SYS(getsockopt), SCMP_SYS(getsockname), SCMP_SYS(getpeername),
    SCMP_SYS(poll), SCMP_SYS(ppoll), SCMP_SYS(select), SCMP_SYS(pselect6), SCMP_SYS(eventfd2),
    SCMP_SYS(sendfile), SCMP_SYS(dup2), SCMP_SYS(dup3),
    /* threads, time, signals */
    SCMP_SYS(futex), SCMP_SYS(sched_yield), SCMP_SYS(getcpu), SCMP_SYS(set_robust_list),
    SCMP_SYS(rseq), SCMP_SYS(membarrier), SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres),
    SCMP_SYS(clock_nanosleep), SCMP_SYS(nanosleep), SCMP_SYS(gettimeofday), SCMP_SYS(time),
    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn),
    SCMP_SYS(rt_sigtimedwait), SCMP_SYS(sigaltstack), SCMP_SYS(restart_syscall), SCMP_SYS(exit),
    SCMP_SYS(exit_group),
    /* memory */
    SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(brk),
    /* files */
    SCMP_SYS(read), SCMP_SYS(write), SCMP_SYS(readv), SCMP_SYS(writev), SCMP_SYS(pread64),
    SCMP_SYS(pwrite64), SCMP_SYS(lseek), SCMP_SYS(close), SCMP_SYS(stat), SCMP_SYS(lstat),
    SCMP_SYS(fstat), SCMP_SYS(newfstatat), SCMP_SYS(statx), SCMP_SYS(getdents),
    SCMP_SYS(getdents64), SCMP_SYS(unlink), SCMP_SYS(unlinkat), SCMP_SYS(rmdir), SCMP_SYS(rename),
    SCMP_SYS(renameat), SCMP_SYS(renameat2), SCMP_SYS(link), SCMP_SYS(linkat), SCMP_SYS(readlink),
    SCMP_SYS(readlinkat), SCMP_SYS(getcwd), SCMP_SYS(ftruncate), SCMP_SYS(fsync),
    SCMP_SYS(fdatasync), SCMP_SYS(fallocate), SCMP_SYS(fadvise64), SCMP_SYS(flock),
    /* about the process and the machine */
    SCMP_SYS(getrandom), SCMP_SYS(getpid), SCMP_SYS(gettid), SCMP_SYS(getuid), SCMP_SYS(geteuid),
    SCMP_SYS(getgid), SCMP_SYS(getegid), SCMP_SYS(getrlimit), SCMP_SYS(getrusage),
    SCMP_SYS(sysinfo), SCMP_SYS(uname)};

/* Calls that only an attacker makes. */
static const int fatal_calls[] = {
    /* programs and other processes */
    SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(ptrace), SCMP_SYS(process_vm_readv),
    SCMP_SYS(process_vm_writev),
    /* file systems and namespaces */
    SCMP_SYS(mount), SCMP_SYS(umount2), SCMP_SYS(pivot_root), SCMP_SYS(chroot), SCMP_SYS(unshare),
    SCMP_SYS(setns),
    /* the kernel */
    SCMP_SYS(init_module), SCMP_SYS(finit_module), SCMP_SYS(delete_module), SCMP_SYS(kexec_load),
    SCMP_SYS(bpf), SCMP_SYS(keyctl), SCMP_SYS(perf_event_open), SCMP_SYS(userfaultfd),
    SCMP_SYS(reboot)};

/* A call that is allowed if all its conditions hold. The filter runs for these calls; none of them
 * is made by an answer that comes from memory, without a database. */
struct rule {
    int call;
    unsigned count;
    struct scmp_arg_cmp conditions[2]; /* argument, EQUAL, value; or argument, WITHOUT, bits, 0 */
};

#define EQUAL        SCMP_CMP_EQ
#define WITHOUT      SCMP_CMP_MASKED_EQ
#define SPECIAL_BITS (S_ISUID | S_ISGID | S_ISVTX)
#define FCNTL_LOCKS  UINT64_C(7) /* F_DUPFD to F_SETLKW. Not F_SETOWN, which sends signals */

static const struct rule conditional[] = {
    /* memory is not executable */
    {SCMP_SYS(mmap), 1, {{2, WITHOUT, PROT_EXEC, 0}}},
    {SCMP_SYS(mprotect), 1, {{2, WITHOUT, PROT_EXEC, 0}}},
    /* files are not setuid; umask(2), which can't be changed any more, clears other bits */
    {SCMP_SYS(open), 1, {{2, WITHOUT, SPECIAL_BITS, 0}}},
    {SCMP_SYS(openat), 1, {{3, WITHOUT, SPECIAL_BITS, 0}}},
    {SCMP_SYS(mkdir), 1, {{1, WITHOUT, SPECIAL_BITS, 0}}},
    {SCMP_SYS(mkdirat), 1, {{2, WITHOUT, SPECIAL_BITS, 0}}},
    /* the calling thread, no other process */
    {SCMP_SYS(sched_getaffinity), 1, {{0, EQUAL, 0, 0}}},
    {SCMP_SYS(sched_setaffinity), 1, {{0, EQUAL, 0, 0}}},
    {SCMP_SYS(sched_setscheduler), 1, {{0, EQUAL, 0, 0}}},
    {SCMP_SYS(setpriority), 2, {{0, EQUAL, PRIO_PROCESS, 0}, {1, EQUAL, 0, 0}}},
    {SCMP_SYS(prlimit64), 2, {{0, EQUAL, 0, 0}, {2, EQUAL, 0, 0}}},
    {SCMP_SYS(fcntl), 1, {{1, WITHOUT, ~FCNTL_LOCKS, 0}}},
    {SCMP_SYS(fcntl), 1, {{1, EQUAL, F_DUPFD_CLOEXEC, 0}}},
    {SCMP_SYS(prctl), 1, {{0, EQUAL, PR_SET_NAME, 0}}},
};

/* Without a database no socket can connect. */
static const struct rule alone[] = {
    {SCMP_SYS(sendto), 0, {{0}}},
    {SCMP_SYS(sendmsg), 0, {{0}}},
};

/* With a database: connect, and resolve the names of its hosts. A send must not connect, because
 * Landlock does not see it. */
static const struct rule connecting[] = {
    {SCMP_SYS(sendto), 1, {{3, WITHOUT, MSG_FASTOPEN, 0}}},
    {SCMP_SYS(sendmsg), 1, {{2, WITHOUT, MSG_FASTOPEN, 0}}},
    {SCMP_SYS(sendmmsg), 1, {{3, WITHOUT, MSG_FASTOPEN, 0}}},
    {SCMP_SYS(socket), 1, {{0, EQUAL, AF_UNIX, 0}}},
    {SCMP_SYS(socket), 1, {{0, EQUAL, AF_INET, 0}}},
    {SCMP_SYS(socket), 1, {{0, EQUAL, AF_INET6, 0}}},
    {SCMP_SYS(ioctl), 1, {{1, EQUAL, FIONREAD, 0}}}, /* how much a name server has sent */
    {SCMP_SYS(connect), 0, {{0}}},
};

/* These return 0 or a negative errno. */
static int filter_add_calls(scmp_filter_ctx filter, uint32_t action, const int *calls, size_t count)
{
    int failed = 0;
    for (size_t i = 0; !failed && i < count; i++)
        failed = seccomp_rule_add(filter, action, calls[i], 0);
    return failed;
}

static int filter_add_rules(scmp_filter_ctx filter, const struct rule *rules, size_t count)
{
    int failed = 0;
    for (size_t i = 0; !failed && i < count; i++)
        failed = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, rules[i].call, rules[i].count,
                                        rules[i].conditions);
    return failed;
}

static int filter_load(scmp_filter_ctx filter, bool connects)
{
    const struct rule own_signals = {SCMP_SYS(tgkill), 1, {{0, EQUAL, (uint64_t)getpid(), 0}}};
    int failed = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
    if (!failed) failed = seccomp_attr_set(filter, SCMP_FLTATR_CTL_NNP, 0); /* it is set */
    if (!failed) failed = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
    if (!failed) failed = seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, 2); /* a binary tree */
    if (!failed)
        failed = filter_add_calls(filter, SCMP_ACT_ALLOW, allowed_calls, COUNT(allowed_calls));
    if (!failed) failed = filter_add_rules(filter, conditional, COUNT(conditional));
    if (!failed && connects) failed = filter_add_rules(filter, connecting, COUNT(connecting));
    if (!failed && !connects) failed = filter_add_rules(filter, alone, COUNT(alone));
    if (!failed) failed = filter_add_rules(filter, &own_signals, 1);
    if (!failed)
        failed = filter_add_calls(filter, SCMP_ACT_KILL_PROCESS, fatal_calls, COUNT(fatal_calls));
    return failed ? failed : seccomp_load(filter);
}

/* --- the two steps ---------------------------------------------------------------------------- */

/* Without CAP_SYS_NICE this limit lets a thread raise its priority. Where the limit can't be raised
 * (CAP_SYS_RESOURCE), all threads inherit the priority, and workers lower theirs. */
static void keep_priorities(void)
{
    const rlim_t most = 20 - SERVER_HTTP_NICE;
    struct rlimit limit;
    if (getrlimit(RLIMIT_NICE, &limit) != 0 || limit.rlim_cur >= most) return;
    limit = (struct rlimit){most, limit.rlim_max > most ? limit.rlim_max : most};
    if (setrlimit(RLIMIT_NICE, &limit) != 0) (void)setpriority(PRIO_PROCESS, 0, SERVER_HTTP_NICE);
}

static const char *drop_capabilities(void)
{
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    const struct __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3] = {0};
    struct __user_cap_data_struct held[_LINUX_CAPABILITY_U32S_3] = {0};
    if (syscall(SYS_capget, &header, held) == 0 && memcmp(held, none, sizeof none) == 0)
        return NULL;
    for (unsigned capability = 0; prctl(PR_CAPBSET_READ, capability, 0, 0, 0) >= 0; capability++)
        (void)prctl(PR_CAPBSET_DROP, capability, 0, 0, 0); /* takes CAP_SETPCAP */
    (void)prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
    return syscall(SYS_capset, &header, none) == 0 ? NULL : strerror(errno);
}

struct server_sandbox server_sandbox_enter(const struct server_sandbox_needs *needs)
{
    struct server_sandbox sandbox = {.is_wanted = needs && !IS_SANITIZED};
    if (!sandbox.is_wanted) return sandbox;
    sandbox.connects = needs->database != NULL;
    sandbox.new_privileges = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 ? NULL : strerror(errno);
    sandbox.landlock = landlock_enter(needs);
    keep_priorities();
    sandbox.capabilities = drop_capabilities();
    return sandbox;
}

void server_sandbox_seal(struct server_sandbox *sandbox)
{
    struct server_log_line line;
    if (!sandbox->is_wanted) return;
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(ENOSYS));
    int failed = filter ? filter_load(filter, sandbox->connects) : -ENOMEM;
    seccomp_release(filter);
    sandbox->seccomp = failed ? strerror(-failed) : NULL;
    const struct {
        const char *name, *missing;
    } parts[] = {{"no_new_privileges", sandbox->new_privileges},
                 {"no_capabilities", sandbox->capabilities},
                 {"landlock", sandbox->landlock},
                 {"seccomp", sandbox->seccomp}};
    enum server_log_level level = SERVER_LOG_INFO;
    for (size_t i = 0; i < COUNT(parts); i++)
        if (parts[i].missing) level = SERVER_LOG_WARN;
    if (!server_log_begin(&line, level, "sandbox")) return;
    for (size_t i = 0; i < COUNT(parts); i++)
        server_log_text(&line, parts[i].name, parts[i].missing ? parts[i].missing : "on");
    server_log_end(&line);
}
