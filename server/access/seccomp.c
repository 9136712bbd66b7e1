/* See seccomp.h. The kernel (5.11 and later) caches which calls a filter always allows, so the
 * length of the list costs such a call nothing. Calls that are allowed for some arguments only run
 * the filter; none of them is on the way of an answer that comes from memory, without a database.
 */
#include "server/access/seccomp.h"

#include <errno.h>
#include <fcntl.h>
#include <seccomp.h>
#include <stdint.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

/* Calls of a running daemon: its own code, libc, libmicrohttpd, SQLite, GnuTLS. Calls that change
 * the mode, the owner or the times of a file by its path are not among them, since Landlock does
 * not cover these. */
static const int allowed[] = {
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

/* No program needs these but an intruder's. */
static const int fatal[] = {SCMP_SYS(execve),
                            SCMP_SYS(execveat),
                            SCMP_SYS(ptrace),
                            SCMP_SYS(process_vm_readv),
                            SCMP_SYS(process_vm_writev),
                            SCMP_SYS(mount),
                            SCMP_SYS(umount2),
                            SCMP_SYS(pivot_root),
                            SCMP_SYS(chroot),
                            SCMP_SYS(unshare),
                            SCMP_SYS(setns),
                            SCMP_SYS(init_module),
                            SCMP_SYS(finit_module),
                            SCMP_SYS(delete_module),
                            SCMP_SYS(kexec_load),
                            SCMP_SYS(bpf),
                            SCMP_SYS(keyctl),
                            SCMP_SYS(perf_event_open),
                            SCMP_SYS(userfaultfd),
                            SCMP_SYS(reboot)};

/* A call that is allowed only if all its conditions hold; without a condition, always. */
struct rule {
    int call;
    unsigned count;
    struct scmp_arg_cmp conditions[2];
};

#define EQUAL(argument, value)                                                                     \
    {                                                                                              \
        argument, SCMP_CMP_EQ, value, 0                                                            \
    }
#define WITHOUT(argument, bits)                                                                    \
    {                                                                                              \
        argument, SCMP_CMP_MASKED_EQ, bits, 0                                                      \
    }
#define SPECIAL_BITS (S_ISUID | S_ISGID | S_ISVTX)
#define ONE(name, condition)                                                                       \
    {                                                                                              \
        SCMP_SYS(name), 1,                                                                         \
        {                                                                                          \
            condition                                                                              \
        }                                                                                          \
    }
#define BOTH(name, condition, and_that)                                                            \
    {                                                                                              \
        SCMP_SYS(name), 2,                                                                         \
        {                                                                                          \
            condition, and_that                                                                    \
        }                                                                                          \
    }

static const struct rule conditional[] = {
    /* memory is not executable, files are not setuid (umask(2) takes the bits of others; it can't
       be changed any more) */
    ONE(mmap, WITHOUT(2, PROT_EXEC)), ONE(mprotect, WITHOUT(2, PROT_EXEC)),
    ONE(open, WITHOUT(2, SPECIAL_BITS)), ONE(openat, WITHOUT(3, SPECIAL_BITS)),
    ONE(mkdir, WITHOUT(1, SPECIAL_BITS)), ONE(mkdirat, WITHOUT(2, SPECIAL_BITS)),
    /* the calling thread, no other process */
    ONE(sched_getaffinity, EQUAL(0, 0)), ONE(sched_setaffinity, EQUAL(0, 0)),
    ONE(sched_setscheduler, EQUAL(0, 0)), BOTH(setpriority, EQUAL(0, PRIO_PROCESS), EQUAL(1, 0)),
    BOTH(prlimit64, EQUAL(0, 0), EQUAL(2, 0)),
    /* F_DUPFD to F_SETLKW: a lock, but no owner (F_SETOWN), to whom the kernel would send signals
     */
    ONE(fcntl, WITHOUT(1, ~UINT64_C(7))), ONE(fcntl, EQUAL(1, F_DUPFD_CLOEXEC)),
    ONE(prctl, EQUAL(0, PR_SET_NAME))};

/* Without a database there is no socket that could connect. */
static const struct rule alone[] = {{SCMP_SYS(sendto), 0, {{0}}}, {SCMP_SYS(sendmsg), 0, {{0}}}};

/* With one: connecting, and looking up the names of its hosts. A send must not connect behind
 * Landlock's back. */
static const struct rule connecting[] = {ONE(sendto, WITHOUT(3, MSG_FASTOPEN)),
                                         ONE(sendmsg, WITHOUT(2, MSG_FASTOPEN)),
                                         ONE(socket, EQUAL(0, AF_UNIX)),
                                         ONE(socket, EQUAL(0, AF_INET)),
                                         /* how much a name server has sent */
                                         ONE(socket, EQUAL(0, AF_INET6)),
                                         ONE(ioctl, EQUAL(1, FIONREAD)),
                                         {SCMP_SYS(connect), 0, {{0}}},
                                         ONE(sendmmsg, WITHOUT(3, MSG_FASTOPEN))};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* 0 or a negative errno, as all of these. */
static int add_calls(scmp_filter_ctx filter, uint32_t action, const int *calls, size_t count)
{
    int failed = 0;
    for (size_t i = 0; !failed && i < count; i++)
        failed = seccomp_rule_add(filter, action, calls[i], 0);
    return failed;
}

static int add_rules(scmp_filter_ctx filter, const struct rule *rules, size_t count)
{
    int failed = 0;
    for (size_t i = 0; !failed && i < count; i++)
        failed = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, rules[i].call, rules[i].count,
                                        rules[i].conditions);
    return failed;
}

static int add_own_signals(scmp_filter_ctx filter)
{
    const struct rule rule = ONE(tgkill, EQUAL(0, (uint64_t)getpid()));
    return add_rules(filter, &rule, 1);
}

static int load(scmp_filter_ctx filter, bool connects)
{
    int failed = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
    if (!failed) failed = seccomp_attr_set(filter, SCMP_FLTATR_CTL_NNP, 0); /* it is set */
    if (!failed) failed = seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1);
    if (!failed) failed = seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, 2); /* a binary tree */
    if (!failed) failed = add_calls(filter, SCMP_ACT_ALLOW, allowed, COUNT(allowed));
    if (!failed) failed = add_rules(filter, conditional, COUNT(conditional));
    if (!failed && connects) failed = add_rules(filter, connecting, COUNT(connecting));
    if (!failed && !connects) failed = add_rules(filter, alone, COUNT(alone));
    if (!failed) failed = add_own_signals(filter);
    if (!failed) failed = add_calls(filter, SCMP_ACT_KILL_PROCESS, fatal, COUNT(fatal));
    return failed ? failed : seccomp_load(filter);
}

const char *server_seccomp_seal(bool connects)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(ENOSYS));
    int failed = filter ? load(filter, connects) : -ENOMEM;
    seccomp_release(filter);
    return failed ? strerror(-failed) : NULL;
}
