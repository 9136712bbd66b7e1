/* See seccomp.h. The filter compares the call's number with one after the other: the kernel (5.11 and later) runs it
 * once for each number when it is installed, and keeps which are always allowed, so that the length of the list costs
 * a call nothing. */
#include "server/seccomp.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifndef ARCHITECTURE

const char *server_seccomp_seal(bool connects)
{
    (void)connects;
    return "there is no list of system calls for this machine's architecture";
}

#else

/* What a running daemon calls: its own code, libc, libmicrohttpd, SQLite, GnuTLS; but for those of answer_some. */
static const int allowed[] = {
#ifdef SYS_open /* the older calls that this architecture has beside those below */
    SYS_open, SYS_stat, SYS_lstat, SYS_access, SYS_unlink, SYS_rmdir, SYS_rename, SYS_link, SYS_mkdir, SYS_readlink,
    SYS_getdents, SYS_chmod, SYS_dup2, SYS_time, SYS_poll, SYS_select, SYS_epoll_wait,
#endif
    /* connections */
    SYS_epoll_pwait, SYS_epoll_ctl, SYS_recvfrom, SYS_recvmsg, SYS_sendto, SYS_sendmsg, SYS_accept4, SYS_accept,
    SYS_shutdown, SYS_setsockopt, SYS_getsockopt, SYS_getsockname, SYS_getpeername, SYS_ppoll, SYS_pselect6,
    SYS_eventfd2, SYS_sendfile, SYS_dup3,
    /* threads, time, signals */
    SYS_futex, SYS_sched_yield, SYS_sched_getaffinity, SYS_sched_setaffinity, SYS_sched_setscheduler, SYS_setpriority,
    SYS_getcpu, SYS_set_robust_list, SYS_rseq, SYS_membarrier, SYS_clock_gettime, SYS_clock_getres, SYS_clock_nanosleep,
    SYS_nanosleep, SYS_gettimeofday, SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_rt_sigtimedwait,
    SYS_sigaltstack, SYS_restart_syscall, SYS_tgkill, SYS_exit, SYS_exit_group,
    /* memory */
    SYS_munmap, SYS_mremap, SYS_madvise, SYS_brk,
    /* files */
    SYS_read, SYS_write, SYS_readv, SYS_writev, SYS_pread64, SYS_pwrite64, SYS_lseek, SYS_openat, SYS_close, SYS_fstat,
    SYS_newfstatat, SYS_statx, SYS_statfs, SYS_fstatfs, SYS_faccessat, SYS_faccessat2, SYS_getdents64, SYS_unlinkat,
    SYS_renameat, SYS_renameat2, SYS_linkat, SYS_mkdirat, SYS_readlinkat, SYS_getcwd, SYS_ftruncate, SYS_fsync,
    SYS_fdatasync, SYS_fallocate, SYS_fadvise64, SYS_fcntl, SYS_flock, SYS_fchmod, SYS_fchown, SYS_umask, SYS_utimensat,
    /* about the process and the machine */
    SYS_getrandom, SYS_getpid, SYS_gettid, SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid, SYS_getrlimit,
    SYS_prlimit64, SYS_getrusage, SYS_sysinfo, SYS_uname};

/* What a database wants beside that: connecting, and looking up the names of its hosts. */
static const int connecting[] = {SYS_socket, SYS_connect, SYS_sendmmsg};

/* What only an intruder would call. */
static const int fatal[] = {
    SYS_execve, SYS_execveat,    SYS_ptrace,          SYS_process_vm_readv, SYS_process_vm_writev,
    SYS_mount,  SYS_umount2,     SYS_pivot_root,      SYS_chroot,           SYS_unshare,
    SYS_setns,  SYS_init_module, SYS_finit_module,    SYS_delete_module,    SYS_kexec_load,
    SYS_bpf,    SYS_keyctl,      SYS_perf_event_open, SYS_userfaultfd,      SYS_reboot};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define MOST         (2 * (COUNT(allowed) + COUNT(connecting) + COUNT(fatal)) + 32) /* instructions */

struct program {
    struct sock_filter code[MOST];
    unsigned short size;
};

static void add(struct program *program, struct sock_filter instruction)
{
    program->code[program->size++] = instruction;
}

static void load(struct program *program, size_t offset)
{
    add(program, (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset));
}

static void answer(struct program *program, uint32_t verdict)
{
    add(program, (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, verdict));
}

/* What follows, `count` instructions, is for that number only. */
static void only_for(struct program *program, uint32_t number, uint8_t count)
{
    add(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number, 0, count));
}

static void answer_all(struct program *program, const int *numbers, size_t count, uint32_t verdict)
{
    for (size_t i = 0; i < count; i++) {
        only_for(program, (uint32_t)numbers[i], 1);
        answer(program, verdict);
    }
}

/* An argument's low half has all that counts of it. `jump`: BPF_JEQ (it is `value`) or BPF_JSET (it has such bits). */
static void answer_some(struct program *program, uint32_t number, int argument, uint16_t jump, uint32_t value,
                        const uint32_t verdicts[2]) /* of the others, and of what the jump is for */
{
    only_for(program, number, 4);
    load(program, offsetof(struct seccomp_data, args) + (size_t)argument * sizeof(uint64_t));
    add(program, (struct sock_filter)BPF_JUMP(BPF_JMP | jump | BPF_K, value, 0, 1));
    answer(program, verdicts[1]);
    answer(program, verdicts[0]);
}

static void write_program(struct program *program, bool connects)
{
    static const uint32_t unless[] = {SECCOMP_RET_ALLOW, SECCOMP_RET_ERRNO | EPERM};
    static const uint32_t only[] = {SECCOMP_RET_ERRNO | EPERM, SECCOMP_RET_ALLOW};
    load(program, offsetof(struct seccomp_data, arch));
    add(program, (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ARCHITECTURE, 1, 0));
    answer(program, SECCOMP_RET_KILL_PROCESS);
    load(program, offsetof(struct seccomp_data, nr));
    answer_all(program, allowed, COUNT(allowed), SECCOMP_RET_ALLOW);
    if (connects) answer_all(program, connecting, COUNT(connecting), SECCOMP_RET_ALLOW);
    if (connects) answer_some(program, SYS_ioctl, 1, BPF_JEQ, FIONREAD, only); /* how much a name server has sent */
    answer_some(program, SYS_mmap, 2, BPF_JSET, PROT_EXEC, unless);
    answer_some(program, SYS_mprotect, 2, BPF_JSET, PROT_EXEC, unless);
    answer_some(program, SYS_prctl, 0, BPF_JEQ, PR_SET_NAME, only);
    answer_all(program, fatal, COUNT(fatal), SECCOMP_RET_KILL_PROCESS);
    answer(program, SECCOMP_RET_ERRNO | ENOSYS);
}

const char *server_seccomp_seal(bool connects)
{
    struct program program = {.size = 0};
    write_program(&program, connects);
    const struct sock_fprog filter = {.len = program.size, .filter = program.code};
    long failed = syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &filter);
    if (failed > 0) return "a thread has a filter of its own";
    return failed ? strerror(errno) : NULL;
}

#endif
