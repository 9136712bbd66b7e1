/* Tests the system calls that a daemon in its sandbox can and can't make. A child process enters
 * the sandbox and makes the calls. */
#include "tests/unit/server/child.h"
#include "tests/unit/server/folder.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include "server/access/sandbox.h"
#include "server/base/disk.h"
#include "server/base/log.h"
#include "server/config/config.h"
#include "server/store/local/local.h"
#include "server/work/thread_priority.h"

#define REFUSED(call, why) (errno = 0, (call) == -1 && errno == (why))

struct fixture {
    char folder[FOLDER_PATH], outside[FOLDER_PATH];
    struct server_config config;
    int priority;  /* priority of the test itself */
    int listening; /* the listening socket of another program */
    struct sockaddr_in address;
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    socklen_t size = sizeof fixture->address;
    fixture->priority = getpriority(PRIO_PROCESS, 0);
    folder_make(fixture->folder);
    folder_make(fixture->outside);
    snprintf(fixture->config.data_dir, sizeof fixture->config.data_dir, "%s/data", fixture->folder);
    fixture->listening = socket(AF_INET, SOCK_STREAM, 0);
    fixture->address =
        (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    assert_int_equal(bind(fixture->listening, (struct sockaddr *)&fixture->address, size), 0);
    assert_int_equal(getsockname(fixture->listening, (struct sockaddr *)&fixture->address, &size),
                     0);
    assert_int_equal(listen(fixture->listening, 1), 0);
    char error[SERVER_ERROR];
    assert_true(server_address_parse("127.0.0.1:0", &fixture->config.listen, error));
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    close(fixture->listening);
    folder_remove(fixture->folder);
    folder_remove(fixture->outside);
    free(fixture);
    return 0;
}

/* Runs the function in a child process. Returns how the child ends. */
static int end_of(struct fixture *fixture, void (*in_child)(struct fixture *fixture))
{
    int status;
    pid_t child = fork();
    if (child == 0) {
        in_child(fixture);
        _exit(FINE);
    }
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

static void assert_fine(struct fixture *fixture, void (*in_child)(struct fixture *fixture))
{
    int status = end_of(fixture, in_child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == SKIPPED) skip();
    assert_int_equal(WEXITSTATUS(status), FINE);
}

/* Performs the first step of the sandbox as a daemon with that configuration does. */
static struct server_sandbox enter_whatever_is_there(const struct fixture *fixture)
{
    const struct server_config *config = &fixture->config;
    const struct server_sandbox_needs needs = {
        .folder = config->data_dir,
        .files = {config->keys, config->tls_cert, config->tls_key},
        .address = &config->listen};
    struct server_files files;
    INSIST(server_files_open(&files, config->data_dir));
    server_files_close(&files);
    return server_sandbox_enter(&needs);
}

static struct server_sandbox enter(const struct fixture *fixture)
{
    struct server_sandbox sandbox = enter_whatever_is_there(fixture);
    if (!sandbox.is_wanted) SKIP_CHILD("this build has a sanitizer, which needs more rights");
    if (sandbox.landlock) SKIP_CHILD("this kernel has no Landlock");
    return sandbox;
}

static void seal(const struct fixture *fixture)
{
    struct server_sandbox sandbox = enter(fixture);
    server_log_set_level(SERVER_LOG_ERROR);
    server_sandbox_seal(&sandbox);
    if (sandbox.seccomp) SKIP_CHILD("this kernel has no seccomp filters");
}

static int make_file(const char *folder, const char *name)
{
    char path[SERVER_DISK_PATH];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file >= 0) close(file);
    return file < 0 ? -1 : 0;
}

static void use_files(struct fixture *fixture)
{
    char from[SERVER_DISK_PATH], to[SERVER_DISK_PATH];
    (void)enter(fixture);
    snprintf(from, sizeof from, "%s/temporary/x", fixture->config.data_dir);
    snprintf(to, sizeof to, "%s/objects/x", fixture->config.data_dir);
    INSIST(make_file(fixture->config.data_dir, "temporary/x") == 0);
    INSIST(rename(from, to) == 0);
    INSIST(truncate(to, 0) == 0);
    INSIST(link(to, from) == 0);
    INSIST(unlink(to) == 0);
    INSIST(REFUSED(open("/etc/passwd", O_RDONLY), EACCES));
    INSIST(REFUSED(open(fixture->folder, O_RDONLY | O_DIRECTORY), EACCES));
    INSIST(REFUSED(make_file(fixture->outside, "x"), EACCES));
    INSIST(REFUSED(symlink("/etc/passwd", to), EACCES));
    INSIST(REFUSED(execl("/bin/true", "true", NULL), EACCES));
}

static void only_the_data_folder_is_accessible(void **state)
{
    assert_fine(*state, use_files);
}

/* The folder of the keys, and the folder of their link's target, can be read but not written. */
static void read_keys(struct fixture *fixture)
{
    char keys[SERVER_DISK_PATH];
    INSIST(make_file(fixture->outside, "real") == 0);
    snprintf(keys, sizeof keys, "%s/real", fixture->outside);
    snprintf(fixture->config.keys, sizeof fixture->config.keys, "%s/keys", fixture->folder);
    INSIST(symlink(keys, fixture->config.keys) == 0);
    (void)enter(fixture);
    INSIST(open(fixture->config.keys, O_RDONLY) >= 0);
    INSIST(REFUSED(open(fixture->config.keys, O_WRONLY), EACCES));
    INSIST(REFUSED(make_file(fixture->outside, "more"), EACCES));
    INSIST(REFUSED(unlink(keys), EACCES));
}

static void key_files_can_be_read_again(void **state)
{
    assert_fine(*state, read_keys);
}

static void reach_out(struct fixture *fixture)
{
    const struct sockaddr *address = (const struct sockaddr *)&fixture->address;
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    (void)enter(fixture);
    int outgoing = socket(AF_INET, SOCK_STREAM, 0), listening = socket(AF_INET, SOCK_STREAM, 0);
    if (!REFUSED(connect(outgoing, address, sizeof fixture->address), EACCES))
        SKIP_CHILD("Landlock of this kernel does not limit connections (before Linux 6.7)");
    own.sin_port = htons(1);
    INSIST(REFUSED(bind(listening, (struct sockaddr *)&own, sizeof own), EACCES));
    own.sin_port = 0; /* the address of --listen was bound before */
    INSIST(REFUSED(bind(listening, (struct sockaddr *)&own, sizeof own), EACCES));
}

static void connections_are_forbidden(void **state)
{
    assert_fine(*state, reach_out);
}

static void *try_sockets(void *user)
{
    int *pipes = user;
    char byte;
    if (read(pipes[0], &byte, 1) != 1) return NULL;
    return REFUSED(socket(AF_INET, SOCK_STREAM, 0), ENOSYS) ? user : NULL;
}

/* The filter applies to all threads, also to threads that started before it was installed. */
static void call_what_is_no_more(struct fixture *fixture)
{
    int pipes[2];
    pthread_t thread;
    void *refused;
    INSIST(pipe(pipes) == 0);
    struct server_sandbox sandbox = enter(fixture);
    INSIST(pthread_create(&thread, NULL, try_sockets, pipes) == 0);
    server_log_set_level(SERVER_LOG_ERROR);
    server_sandbox_seal(&sandbox);
    if (sandbox.seccomp) SKIP_CHILD("this kernel has no seccomp filters");
    INSIST(write(pipes[1], "", 1) == 1);
    INSIST(pthread_join(thread, &refused) == 0 && refused);
    INSIST(REFUSED(socket(AF_UNIX, SOCK_STREAM, 0), ENOSYS));
    INSIST(REFUSED(fork(), ENOSYS));
    INSIST(pthread_create(&thread, NULL, try_sockets, pipes) != 0);
    INSIST(REFUSED(kill(getppid(), 0), ENOSYS));
    char *page = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    INSIST(page != MAP_FAILED);
    INSIST(REFUSED(mprotect(page, 4096, PROT_READ | PROT_EXEC), ENOSYS));
    INSIST(mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) ==
               MAP_FAILED &&
           errno == ENOSYS);
    INSIST(make_file(fixture->config.data_dir, "still") == 0);
    free(malloc((size_t)64 << 20));
}

static void unneeded_system_calls_fail(void **state)
{
    assert_fine(*state, call_what_is_no_more);
}

/* --- calls that reach beyond the daemon ------------------------------------------------------- */

#define SOME_MODE 0666

struct attempt {
    const char *name;
    long call, arguments[6];
};

#define AT       AT_FDCWD
#define TEXT(at) ((long)(intptr_t)(at))

/* Outside the sandbox none of these calls fails, and some are harmful. */
static void insist_on_refusals(const char *outside, const char *inside, int descriptor, pid_t other)
{
    static const char hidden[] = "/etc/shadow";
    static const struct timespec times[2];
    struct rlimit limit = {0, 0};
    const struct sched_param none = {0};
    long file = TEXT(outside), own = TEXT(inside), pid = other;
    unsigned long cores[16] = {1};
    char room[256];
    const struct attempt attempts[] = {
        /* changes modes, owners, times and attributes by path, and makes a setuid file inside the
           folder */
        {"fchmodat", SYS_fchmodat, {AT, file, SOME_MODE}},
        {"fchmodat setuid", SYS_fchmodat, {AT, own, 04755}},
        {"fchmodat inside", SYS_fchmodat, {AT, own, SOME_MODE}},
        {"fchmod", SYS_fchmod, {descriptor, 04755}},
        {"fchmod others", SYS_fchmod, {descriptor, SOME_MODE}},
        {"fchownat", SYS_fchownat, {AT, file, -1, -1, 0}},
        {"fchown", SYS_fchown, {descriptor, -1, -1}},
        {"umask", SYS_umask, {0}},
        {"openat setuid", SYS_openat, {AT, own, O_WRONLY | O_CREAT, 04755}},
        {"openat setgid", SYS_openat, {AT, own, O_WRONLY | O_CREAT, 02755}},
        {"mkdirat sticky", SYS_mkdirat, {AT, TEXT("x"), 01777}},
        {"utimensat", SYS_utimensat, {AT, file, TEXT(times), 0}},
        {"utimensat descriptor", SYS_utimensat, {descriptor, 0, TEXT(times), 0}},
        {"setxattr", SYS_setxattr, {file, TEXT("user.x"), TEXT("x"), 1, 0}},
        {"truncate", SYS_truncate, {file, 0}},
        {"mknodat", SYS_mknodat, {AT, own, S_IFIFO | 0600, 0}},
        {"symlinkat", SYS_symlinkat, {file, AT, own}},
        {"faccessat", SYS_faccessat, {AT, TEXT(hidden), F_OK}},
        {"faccessat2", 439, {AT, TEXT(hidden), F_OK, 0}},
        {"statfs", SYS_statfs, {file, TEXT(room)}},
        {"chdir", SYS_chdir, {TEXT("/")}},
        {"name_to_handle_at", SYS_name_to_handle_at, {AT, file, TEXT(room), TEXT(cores), 0}},
        {"inotify_init1", SYS_inotify_init1, {0}},
#ifdef SYS_chmod
        {"chmod", SYS_chmod, {file, SOME_MODE}},
        {"chmod setuid", SYS_chmod, {own, 04755}},
        {"open setuid", SYS_open, {own, O_WRONLY | O_CREAT, 04755}},
        {"creat", SYS_creat, {own, SOME_MODE}},
        {"mkdir sticky", SYS_mkdir, {TEXT("x"), 01777}},
        {"chown", SYS_chown, {file, -1, -1}},
        {"utimes", SYS_utimes, {file, 0}},
        {"utime", SYS_utime, {file, 0}},
        {"access", SYS_access, {TEXT(hidden), F_OK}},
        {"mknod", SYS_mknod, {own, S_IFIFO | 0600, 0}},
#endif
        /* affects other processes, and the limits of this process */
        {"prlimit64 other", SYS_prlimit64, {pid, RLIMIT_NOFILE, TEXT(&limit), 0}},
        {"prlimit64 look", SYS_prlimit64, {pid, RLIMIT_NOFILE, 0, TEXT(&limit)}},
        {"prlimit64 own", SYS_prlimit64, {0, RLIMIT_CORE, TEXT(&limit), 0}},
        {"setrlimit", SYS_setrlimit, {RLIMIT_CORE, TEXT(&limit)}},
        {"sched_setscheduler", SYS_sched_setscheduler, {pid, SCHED_IDLE, TEXT(&none)}},
        {"sched_setparam", SYS_sched_setparam, {pid, TEXT(&none)}},
        {"sched_setattr", SYS_sched_setattr, {pid, TEXT(room), 0}},
        {"sched_setaffinity", SYS_sched_setaffinity, {pid, sizeof cores, TEXT(cores)}},
        {"setpriority", SYS_setpriority, {PRIO_PROCESS, pid, 19}},
        {"setpriority group", SYS_setpriority, {PRIO_PGRP, 0, 19}},
        {"setpriority user", SYS_setpriority, {PRIO_USER, 0, 19}},
        {"ioprio_set", SYS_ioprio_set, {1, pid, 3 << 13}},
        {"kill", SYS_kill, {pid, 0}},
        {"kill group", SYS_kill, {0, 0}},
        {"tkill", SYS_tkill, {pid, 0}},
        {"tgkill", SYS_tgkill, {pid, pid, 0}},
        {"rt_sigqueueinfo", SYS_rt_sigqueueinfo, {pid, SIGUSR1, TEXT(room)}},
        {"fcntl F_SETOWN", SYS_fcntl, {descriptor, F_SETOWN, pid}},
        {"fcntl F_SETSIG", SYS_fcntl, {descriptor, F_SETSIG, SIGKILL}},
        {"fcntl F_SETOWN_EX", SYS_fcntl, {descriptor, F_SETOWN_EX, TEXT(room)}},
        {"pidfd_open", 434, {pid, 0}},
        {"pidfd_send_signal", 424, {descriptor, 0, 0, 0}},
        {"pidfd_getfd", 438, {descriptor, 0, 0}},
        {"process_madvise", 440, {descriptor, 0, 0, 0, 0}},
        {"kcmp", SYS_kcmp, {pid, pid, 0, 0, 0}},
        {"move_pages", SYS_move_pages, {pid, 0, 0, 0, 0, 0}},
        {"migrate_pages", SYS_migrate_pages, {pid, 1, TEXT(cores), TEXT(cores)}},
        {"setpgid", SYS_setpgid, {0, 0}},
        {"setuid", SYS_setuid, {0}},
        {"capset", SYS_capset, {TEXT(room), 0}},
        {"personality", SYS_personality, {0x0400000}},
        {"prctl dumpable", SYS_prctl, {PR_SET_DUMPABLE, 1}},
        {"prctl ptracer", SYS_prctl, {PR_SET_PTRACER, pid}},
        {"seccomp", SYS_seccomp, {2, 0, 0}},
        /* calls by which an attacker could exploit faults of the kernel */
        {"clone", SYS_clone, {SIGCHLD, 0, 0, 0, 0}},
        {"clone3", 435, {TEXT(room), sizeof room}},
        {"memfd_create", SYS_memfd_create, {TEXT("x"), 0}},
        {"io_uring_setup", 425, {1, TEXT(room)}},
        {"add_key", SYS_add_key, {TEXT("user"), TEXT("x"), TEXT("y"), 1, -4}},
        {"ioctl TIOCSTI", SYS_ioctl, {0, TIOCSTI, TEXT("x")}},
        {"ioctl TIOCLINUX", SYS_ioctl, {0, TIOCLINUX, TEXT(room)}},
        {"ioctl FIOSETOWN", SYS_ioctl, {descriptor, FIOSETOWN, TEXT(cores)}},
        {"shmget", SYS_shmget, {0, 4096, 01600}},
        {"pkey_mprotect", SYS_pkey_mprotect, {0, 4096, PROT_EXEC, -1}},
        {"fanotify_init", SYS_fanotify_init, {0, 0}},
        {"syslog", SYS_syslog, {3, TEXT(room), sizeof room}},
        {"sethostname", SYS_sethostname, {TEXT("x"), 1}},
        {"clock_settime", SYS_clock_settime, {CLOCK_REALTIME, TEXT(times)}},
        {"swapoff", SYS_swapoff, {file}},
        {"quotactl", SYS_quotactl, {0, 0, 0, 0}},
        {"splice", SYS_splice, {0, 0, 0, 0, 0, 0}},
        {"socketpair", SYS_socketpair, {AF_UNIX, SOCK_STREAM, 0, TEXT(room)}},
        {"bind", SYS_bind, {0, 0, 0}},
        {"listen", SYS_listen, {0, 1}},
    };
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++) {
        const long *a = attempts[i].arguments;
        if (REFUSED(syscall(attempts[i].call, a[0], a[1], a[2], a[3], a[4], a[5]), ENOSYS))
            continue;
        fprintf(stderr, "%s is not refused (%s)\n", attempts[i].name, strerror(errno));
        _exit(WRONG);
    }
}

/* Enters the sandbox and calls insist_on_refusals. If `connects`, the daemon has a database and may
 * create sockets of certain families. */
static void reach_beyond(struct fixture *fixture, bool connects)
{
    char outside[SERVER_DISK_PATH], inside[SERVER_DISK_PATH];
    struct rlimit limit;
    struct stat facts;
    struct server_sandbox sandbox = enter(fixture);
    snprintf(outside, sizeof outside, "%s/file", fixture->outside);
    snprintf(inside, sizeof inside, "%s/file", fixture->config.data_dir);
    INSIST(make_file(fixture->config.data_dir, "file") == 0);
    int descriptor = open(inside, O_RDWR);
    server_log_set_level(SERVER_LOG_ERROR);
    sandbox.connects = connects;
    server_sandbox_seal(&sandbox);
    if (sandbox.seccomp) SKIP_CHILD("this kernel has no seccomp filters");
    insist_on_refusals(outside, inside, descriptor, getppid());
    INSIST(stat(inside, &facts) == 0 && (facts.st_mode & 07777) == 0600);
    INSIST(setpriority(PRIO_PROCESS, 0, 19) == 0); /* the daemon does this to its own threads */
    INSIST(getrlimit(RLIMIT_NOFILE, &limit) == 0);
    INSIST(fcntl(descriptor, F_SETLK, &(struct flock){.l_type = F_WRLCK}) == 0);
    INSIST(prctl(PR_SET_NAME, "x") == 0);
    INSIST(raise(0) == 0);
    const int strange[] = {AF_NETLINK, AF_PACKET, AF_ALG, AF_VSOCK, AF_BLUETOOTH, AF_XDP};
    for (size_t i = 0; i < sizeof strange / sizeof *strange; i++)
        INSIST(REFUSED(socket(strange[i], SOCK_DGRAM, 0), ENOSYS));
    if (!connects) return;
    int client = socket(AF_INET, SOCK_STREAM, 0);
    const struct sockaddr *address = (const struct sockaddr *)&fixture->address;
    INSIST(client >= 0);
    INSIST(REFUSED(sendto(client, "x", 1, MSG_FASTOPEN, address, sizeof fixture->address), ENOSYS));
}

static void reach_beyond_alone(struct fixture *fixture)
{
    reach_beyond(fixture, false);
}

static void reach_beyond_beside_a_database(struct fixture *fixture)
{
    reach_beyond(fixture, true);
}

static void assert_that_others_are_as_they_were(struct fixture *fixture)
{
    char path[SERVER_DISK_PATH];
    struct stat facts;
    snprintf(path, sizeof path, "%s/file", fixture->outside);
    assert_int_equal(stat(path, &facts), 0);
    assert_int_equal(facts.st_mode & 07777, 0600);
    assert_int_equal(getpriority(PRIO_PROCESS, 0), fixture->priority);
    assert_int_equal(sched_getscheduler(0), SCHED_OTHER);
}

static void files_and_processes_of_others_are_protected(void **state)
{
    struct fixture *fixture = *state;
    assert_int_equal(make_file(fixture->outside, "file"), 0);
    assert_fine(fixture, reach_beyond_alone);
    assert_that_others_are_as_they_were(fixture);
    assert_fine(fixture, reach_beyond_beside_a_database);
    assert_that_others_are_as_they_were(fixture);
}

/* --- capabilities ----------------------------------------------------------------------------- */

static void look_at_capabilities(struct fixture *fixture)
{
    struct __user_cap_header_struct header = {.version = _LINUX_CAPABILITY_VERSION_3};
    struct __user_cap_data_struct held[_LINUX_CAPABILITY_U32S_3];
    bool was_root = geteuid() == 0,
         could_come_first = setpriority(PRIO_PROCESS, 0, SERVER_HTTP_NICE) == 0;
    INSIST(setpriority(PRIO_PROCESS, 0, 0) == 0);
    struct server_sandbox sandbox = enter_whatever_is_there(fixture);
    if (!sandbox.is_wanted) SKIP_CHILD("this build has a sanitizer, which needs more rights");
    INSIST(!sandbox.capabilities);
    INSIST(syscall(SYS_capget, &header, held) == 0);
    for (int i = 0; i < _LINUX_CAPABILITY_U32S_3; i++)
        INSIST(!held[i].effective && !held[i].permitted && !held[i].inheritable);
    INSIST(!was_root || prctl(PR_CAPBSET_READ, 0, 0, 0, 0) == 0);
    /* without CAP_SYS_NICE */
    INSIST(!could_come_first || setpriority(PRIO_PROCESS, 0, SERVER_HTTP_NICE) == 0);
}

static void all_capabilities_are_dropped(void **state)
{
    assert_fine(*state, look_at_capabilities);
}

/* --- calls that end the process --------------------------------------------------------------- */

static void run_a_program(struct fixture *fixture)
{
    seal(fixture);
    execl("/bin/true", "true", NULL);
}

static void read_another_process(struct fixture *fixture)
{
    seal(fixture);
    syscall(SYS_process_vm_readv, getppid(), NULL, 0, NULL, 0, 0);
}

static void write_another_process(struct fixture *fixture)
{
    seal(fixture);
    syscall(SYS_process_vm_writev, getppid(), NULL, 0, NULL, 0, 0);
}

static void trace(struct fixture *fixture)
{
    seal(fixture);
    ptrace(PTRACE_TRACEME, 0, NULL, NULL);
}

static void leave_the_namespace(struct fixture *fixture)
{
    seal(fixture);
    unshare(CLONE_NEWUSER);
}

static void enter_a_namespace(struct fixture *fixture)
{
    seal(fixture);
    setns(0, CLONE_NEWNET);
}

static void load_a_filter(struct fixture *fixture)
{
    seal(fixture);
    syscall(SYS_bpf, 0, NULL, 0);
}

static void watch_events(struct fixture *fixture)
{
    seal(fixture);
    syscall(SYS_perf_event_open, NULL, 0, -1, -1, 0);
}

static void handle_faults(struct fixture *fixture)
{
    seal(fixture);
    syscall(SYS_userfaultfd, 0);
}

static void calls_of_attackers_end_the_process(void **state)
{
    void (*const attempts[])(struct fixture *) = {
        run_a_program, read_another_process, write_another_process,
        trace,         leave_the_namespace,  enter_a_namespace,
        load_a_filter, watch_events,         handle_faults};
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++) {
        int status = end_of(*state, attempts[i]);
        if (WIFEXITED(status) && WEXITSTATUS(status) == SKIPPED) skip();
        assert_true(WIFSIGNALED(status));
        assert_int_equal(WTERMSIG(status), SIGSYS);
    }
}

static void stay_free(struct fixture *fixture)
{
    (void)fixture;
    struct server_sandbox sandbox = server_sandbox_enter(NULL);
    server_sandbox_seal(&sandbox);
    INSIST(!sandbox.is_wanted);
    INSIST(open("/etc/passwd", O_RDONLY) >= 0);
    INSIST(socket(AF_INET, SOCK_STREAM, 0) >= 0);
}

static void the_sandbox_can_be_switched_off(void **state)
{
    assert_fine(*state, stay_free);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {TEST(only_the_data_folder_is_accessible),
                                       TEST(key_files_can_be_read_again),
                                       TEST(connections_are_forbidden),
                                       TEST(unneeded_system_calls_fail),
                                       TEST(files_and_processes_of_others_are_protected),
                                       TEST(all_capabilities_are_dropped),
                                       TEST(calls_of_attackers_end_the_process),
                                       TEST(the_sandbox_can_be_switched_off)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
