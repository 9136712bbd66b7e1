/* What a daemon in its sandbox can and can't do, tried by a child that enters it. */
#include "child.h"
#include "folder.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include "server/config.h"

#define REFUSED(call, why) (errno = 0, (call) == -1 && errno == (why))

struct fixture {
    char folder[FOLDER_PATH], outside[FOLDER_PATH];
    struct server_config config;
    int listening; /* a socket of somebody else */
    struct sockaddr_in address;
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    socklen_t size = sizeof fixture->address;
    folder_make(fixture->folder);
    folder_make(fixture->outside);
    snprintf(fixture->config.data_dir, sizeof fixture->config.data_dir, "%s/data", fixture->folder);
    fixture->listening = socket(AF_INET, SOCK_STREAM, 0);
    fixture->address = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    assert_int_equal(bind(fixture->listening, (struct sockaddr *)&fixture->address, size), 0);
    assert_int_equal(getsockname(fixture->listening, (struct sockaddr *)&fixture->address, &size), 0);
    assert_int_equal(listen(fixture->listening, 1), 0);
    char error[256];
    assert_true(server_address_parse("127.0.0.1:0", &fixture->config.listen, error, sizeof error));
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

/* How a child that does that in the sandbox ends. */
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

static struct server_sandbox enter(const struct fixture *fixture)
{
    struct server_sandbox sandbox = server_sandbox_enter(&fixture->config);
    if (!sandbox.is_wanted || sandbox.landlock) _exit(SKIPPED); /* a sanitizer's build, or another kernel */
    return sandbox;
}

static void seal(const struct fixture *fixture)
{
    struct server_sandbox sandbox = enter(fixture);
    server_log_set_level(SERVER_LOG_ERROR);
    server_sandbox_seal(&sandbox);
    if (sandbox.seccomp) _exit(SKIPPED);
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

static void the_data_folder_is_all_there_is(void **state)
{
    assert_fine(*state, use_files);
}

/* The folder of the keys and the one that their link leads to can be read, and only read. */
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

static void keys_can_be_read_again(void **state)
{
    assert_fine(*state, read_keys);
}

static void reach_out(struct fixture *fixture)
{
    const struct sockaddr *address = (const struct sockaddr *)&fixture->address;
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    (void)enter(fixture);
    int outgoing = socket(AF_INET, SOCK_STREAM, 0), listening = socket(AF_INET, SOCK_STREAM, 0);
    if (!REFUSED(connect(outgoing, address, sizeof fixture->address), EACCES)) _exit(SKIPPED); /* before Linux 6.7 */
    own.sin_port = htons(1);
    INSIST(REFUSED(bind(listening, (struct sockaddr *)&own, sizeof own), EACCES));
    own.sin_port = 0; /* as --listen has it */
    INSIST(bind(listening, (struct sockaddr *)&own, sizeof own) == 0);
}

static void it_connects_to_nobody(void **state)
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

/* Of all threads, also those that were there before. */
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
    if (sandbox.seccomp) _exit(SKIPPED);
    INSIST(write(pipes[1], "", 1) == 1);
    INSIST(pthread_join(thread, &refused) == 0 && refused);
    INSIST(REFUSED(socket(AF_UNIX, SOCK_STREAM, 0), ENOSYS));
    INSIST(REFUSED(fork(), ENOSYS));
    INSIST(pthread_create(&thread, NULL, try_sockets, pipes) != 0);
    INSIST(REFUSED(kill(getppid(), 0), ENOSYS));
    char *page = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    INSIST(page != MAP_FAILED);
    INSIST(REFUSED(mprotect(page, 4096, PROT_READ | PROT_EXEC), EPERM));
    INSIST(mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED && errno == EPERM);
    INSIST(make_file(fixture->config.data_dir, "still") == 0);
    free(malloc((size_t)64 << 20));
}

static void what_is_not_needed_is_no_more(void **state)
{
    assert_fine(*state, call_what_is_no_more);
}

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

static void an_intruder_ends_the_process(void **state)
{
    void (*const attempts[])(struct fixture *) = {run_a_program, read_another_process};
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++) {
        int status = end_of(*state, attempts[i]);
        if (WIFEXITED(status) && WEXITSTATUS(status) == SKIPPED) skip();
        assert_true(WIFSIGNALED(status));
        assert_int_equal(WTERMSIG(status), SIGSYS);
    }
}

static void stay_free(struct fixture *fixture)
{
    fixture->config.sandbox = SERVER_SANDBOX_OFF;
    struct server_sandbox sandbox = server_sandbox_enter(&fixture->config);
    server_sandbox_seal(&sandbox);
    INSIST(!sandbox.is_wanted);
    INSIST(open("/etc/passwd", O_RDONLY) >= 0);
    INSIST(socket(AF_INET, SOCK_STREAM, 0) >= 0);
}

static void it_can_be_left_out(void **state)
{
    assert_fine(*state, stay_free);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {TEST(the_data_folder_is_all_there_is), TEST(keys_can_be_read_again),
                                       TEST(it_connects_to_nobody),           TEST(what_is_not_needed_is_no_more),
                                       TEST(an_intruder_ends_the_process),    TEST(it_can_be_left_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
