#include "server/access/sandbox.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <linux/capability.h>
#include <linux/landlock.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdio.h>
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
/* Linux, Documentation/userspace-api/landlock.rst. The headers of Linux 6.1 lack these
 * constants. */

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

struct ruleset {
    int descriptor;
    struct handled { /* actions that need a rule, in the kernel's layout */
        uint64_t files, ports, scopes;
    } handled;
};

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

/* Allows the folder of the file and, if the file is a symbolic link, the folder of its target. */
static bool ruleset_allow_rereading(const struct ruleset *ruleset, const char *file)
{
    char *real = realpath(file, NULL);
    bool is_allowed = real && ruleset_allow_folder_of(ruleset, file, FS_READ) &&
                      ruleset_allow_folder_of(ruleset, real, FS_READ);
    free(real);
    return is_allowed;
}

/* Allows a file to be read. An absent file needs no rule. */
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

/* Allows connections to the database: its ports, the files that libpq reads, and the files by which
 * libc resolves hosts and users. */
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

/* Restricts this thread and the threads that it starts. Returns NULL, or the reason why nothing is
 * restricted. */
static const char *landlock_enter(const struct server_sandbox_needs *needs)
{
    struct ruleset ruleset;
    long version = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 0) return "this kernel has no Landlock, or it is not enabled";
    if (version < 2)
        return "this kernel's Landlock forbids renames from folder to folder: Linux 5.19 is needed";
    size_t size = version >= 6   ? sizeof ruleset.handled
                  : version >= 4 ? offsetof(struct handled, scopes)
                                 : offsetof(struct handled, ports);
    ruleset.handled.files = version >= 5 ? FS_ALL_OF_5 : version >= 3 ? FS_ALL_OF_3 : FS_ALL_OF_2;
    ruleset.handled.ports = BIND_TCP | CONNECT_TCP;
    ruleset.handled.scopes = SCOPES_ALL;
    ruleset.descriptor = (int)syscall(SYS_landlock_create_ruleset, &ruleset.handled, size, 0);
    if (ruleset.descriptor < 0) return strerror(errno);
    const char *missing = NULL;
    if (!ruleset_allow(&ruleset, needs, version >= 4))
        missing = "a file or folder that the daemon needs is missing";
    else if (syscall(SYS_landlock_restrict_self, ruleset.descriptor, 0) != 0)
        missing = strerror(errno);
    close(ruleset.descriptor);
    return missing;
}

/* --- seccomp: system calls -------------------------------------------------------------------- */

/* Calls of a running daemon: its own code, libc, libmicrohttpd, SQLite, GnuTLS. The kernel (since
 * 5.11) caches which calls a filter always allows, so this list costs nothing. Calls that change a
 * file's mode, owner or times by path are left out: Landlock does not cover them. */
static const char *const allowed_calls[] = {
    /* connections */
    "epoll_wait epoll_pwait epoll_ctl recvfrom recvmsg accept4 accept shutdown setsockopt",
    "getsockopt getsockname getpeername poll ppoll select pselect6 eventfd2 sendfile dup2 dup3",
    /* threads, time, signals */
    "futex sched_yield getcpu set_robust_list rseq membarrier clock_gettime clock_getres",
    "clock_nanosleep nanosleep gettimeofday time rt_sigaction rt_sigprocmask rt_sigreturn",
    "rt_sigtimedwait sigaltstack restart_syscall exit exit_group",
    /* memory */
    "munmap mremap madvise brk",
    /* files */
    "read write readv writev pread64 pwrite64 lseek close stat lstat fstat newfstatat statx",
    "getdents getdents64 unlink unlinkat rmdir rename renameat renameat2 link linkat readlink",
    "readlinkat getcwd ftruncate fsync fdatasync fallocate fadvise64 flock",
    /* about the process and the machine */
    "getrandom getpid gettid getuid geteuid getgid getegid getrlimit getrusage sysinfo uname",
    NULL};

/* Calls that only an attacker makes: programs, other processes, file systems, the kernel. */
static const char *const fatal_calls[] = {
    "execve execveat ptrace process_vm_readv process_vm_writev",
    "mount umount2 pivot_root chroot unshare setns",
    "init_module finit_module delete_module kexec_load bpf keyctl perf_event_open userfaultfd",
    "reboot", NULL};

/* A call that is allowed if all its conditions hold. The kernel runs the filter only for these
 * calls. If the daemon has no database, requests that are answered from memory make none of these
 * calls. */
struct rule {
    int call;
    enum { ALWAYS, ALONE, CONNECTING } when; /* ALONE: without a database; CONNECTING: with one */
    unsigned count;
    struct scmp_arg_cmp conditions[2]; /* argument, EQUAL, value; or argument, WITHOUT, bits, 0 */
};

#define EQUAL        SCMP_CMP_EQ
#define WITHOUT      SCMP_CMP_MASKED_EQ
#define SPECIAL_BITS (S_ISUID | S_ISGID | S_ISVTX)
#define FCNTL_LOCKS  UINT64_C(7) /* F_DUPFD to F_SETLKW. Not F_SETOWN, which sends signals */

static const struct rule rules[] = {
    /* memory is not executable */
    {SCMP_SYS(mmap), ALWAYS, 1, {{2, WITHOUT, PROT_EXEC, 0}}},
    {SCMP_SYS(mprotect), ALWAYS, 1, {{2, WITHOUT, PROT_EXEC, 0}}},
    /* no setuid files; the umask, which can't be changed any more, clears further mode bits */
    {SCMP_SYS(open), ALWAYS, 1, {{2, WITHOUT, SPECIAL_BITS, 0}}},
    {SCMP_SYS(openat), ALWAYS, 1, {{3, WITHOUT, SPECIAL_BITS, 0}}},
    {SCMP_SYS(mkdir), ALWAYS, 1, {{1, WITHOUT, SPECIAL_BITS, 0}}},
    {SCMP_SYS(mkdirat), ALWAYS, 1, {{2, WITHOUT, SPECIAL_BITS, 0}}},
    /* allowed for the calling thread, not for other processes */
    {SCMP_SYS(sched_getaffinity), ALWAYS, 1, {{0, EQUAL, 0, 0}}},
    {SCMP_SYS(sched_setaffinity), ALWAYS, 1, {{0, EQUAL, 0, 0}}},
    {SCMP_SYS(sched_setscheduler), ALWAYS, 1, {{0, EQUAL, 0, 0}}},
    {SCMP_SYS(setpriority), ALWAYS, 2, {{0, EQUAL, PRIO_PROCESS, 0}, {1, EQUAL, 0, 0}}},
    {SCMP_SYS(prlimit64), ALWAYS, 2, {{0, EQUAL, 0, 0}, {2, EQUAL, 0, 0}}},
    {SCMP_SYS(fcntl), ALWAYS, 1, {{1, WITHOUT, ~FCNTL_LOCKS, 0}}},
    {SCMP_SYS(fcntl), ALWAYS, 1, {{1, EQUAL, F_DUPFD_CLOEXEC, 0}}},
    {SCMP_SYS(prctl), ALWAYS, 1, {{0, EQUAL, PR_SET_NAME, 0}}},
    /* without a database no socket can connect */
    {SCMP_SYS(sendto), ALONE, 0, {{0}}},
    {SCMP_SYS(sendmsg), ALONE, 0, {{0}}},
    /* needed to connect and to resolve host names. A send must not connect (TCP Fast Open), because
       Landlock does not check such connections */
    {SCMP_SYS(sendto), CONNECTING, 1, {{3, WITHOUT, MSG_FASTOPEN, 0}}},
    {SCMP_SYS(sendmsg), CONNECTING, 1, {{2, WITHOUT, MSG_FASTOPEN, 0}}},
    {SCMP_SYS(sendmmsg), CONNECTING, 1, {{3, WITHOUT, MSG_FASTOPEN, 0}}},
    {SCMP_SYS(socket), CONNECTING, 1, {{0, EQUAL, AF_UNIX, 0}}},
    {SCMP_SYS(socket), CONNECTING, 1, {{0, EQUAL, AF_INET, 0}}},
    {SCMP_SYS(socket), CONNECTING, 1, {{0, EQUAL, AF_INET6, 0}}},
    /* needed to read the size of a DNS answer */
    {SCMP_SYS(ioctl), CONNECTING, 1, {{1, EQUAL, FIONREAD, 0}}},
    {SCMP_SYS(connect), CONNECTING, 0, {{0}}},
};

/* Adds lists of names. Returns 0 or a negative errno. */
static int filter_add_calls(scmp_filter_ctx filter, uint32_t action, const char *const *lists)
{
    int failed = 0;
    char name[32];
    for (; !failed && *lists; lists++)
        for (const char *at = *lists; !failed && *at; at += strspn(at, " ")) {
            size_t size = strcspn(at, " ");
            snprintf(name, sizeof name, "%.*s", (int)size, at);
            failed = seccomp_rule_add(filter, action, seccomp_syscall_resolve_name(name), 0);
            at += size;
        }
    return failed;
}

static int filter_load(scmp_filter_ctx filter, bool connects)
{
    static const struct {
        enum scmp_filter_attr name;
        uint32_t value;
    } attributes[] = {{SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS},
                      {SCMP_FLTATR_CTL_NNP, 0}, /* no_new_privs is already set */
                      {SCMP_FLTATR_CTL_TSYNC, 1},
                      {SCMP_FLTATR_CTL_OPTIMIZE, 2}}; /* the filter is a binary tree */
    const struct scmp_arg_cmp own_signals = {0, EQUAL, (uint64_t)getpid(), 0};
    int failed = filter ? 0 : -ENOMEM;
    for (size_t i = 0; !failed && i < COUNT(attributes); i++)
        failed = seccomp_attr_set(filter, attributes[i].name, attributes[i].value);
    for (size_t i = 0; !failed && i < COUNT(rules); i++)
        if (rules[i].when != (connects ? ALONE : CONNECTING))
            failed = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, rules[i].call, rules[i].count,
                                            rules[i].conditions);
    if (!failed) failed = filter_add_calls(filter, SCMP_ACT_ALLOW, allowed_calls);
    if (!failed)
        failed = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1, own_signals);
    if (!failed) failed = filter_add_calls(filter, SCMP_ACT_KILL_PROCESS, fatal_calls);
    return failed ? failed : seccomp_load(filter);
}

/* --- the two steps ---------------------------------------------------------------------------- */

/* Keeps the right to raise a thread's priority by RLIMIT_NICE, which works without CAP_SYS_NICE. If
 * the limit can't be raised (this needs CAP_SYS_RESOURCE), sets the priority of HTTP threads now:
 * all later threads inherit it, and workers lower theirs. */
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
        (void)prctl(PR_CAPBSET_DROP, capability, 0, 0, 0); /* needs CAP_SETPCAP */
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
    int failed = filter_load(filter, sandbox->connects);
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
