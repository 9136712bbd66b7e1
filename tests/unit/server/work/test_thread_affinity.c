/* What becomes of a worker's thread, with the right to come back and without: tried by children. */
#include "tests/unit/server/child.h"
#include "tests/unit/server/support.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include "server/work/thread_affinity.h"

#define NOBODY 65534

static int nice_of_thread(void)
{
    return getpriority(PRIO_PROCESS, (id_t)syscall(SYS_gettid));
}

static void goes_and_comes_back(void)
{
    if (setpriority(PRIO_PROCESS, 0, -1) != 0) _exit(SKIPPED);
    server_place_worker();
    int nice = nice_of_thread();
    INSIST(nice > 0 && sched_getscheduler(0) == SCHED_OTHER);
    for (int turn = 0; turn < 3; turn++) {
        server_place_behind(true);
        INSIST(sched_getscheduler(0) == SCHED_IDLE);
        server_place_behind(true);
        server_place_behind(false);
        INSIST(sched_getscheduler(0) == SCHED_OTHER && nice_of_thread() == nice);
    }
}

static void stays_where_it_could_not_come_back(void)
{
    const struct rlimit none = {0, 0};
    if (setrlimit(RLIMIT_NICE, &none) != 0 || (geteuid() == 0 && setuid(NOBODY) != 0))
        _exit(SKIPPED);
    server_place_worker();
    INSIST(nice_of_thread() > 0);
    server_place_behind(true);
    INSIST(sched_getscheduler(0) == SCHED_OTHER);
}

/* A thread that is no worker: nothing is known of its rights. */
static void others_stay(void)
{
    server_place_behind(true);
    INSIST(sched_getscheduler(0) == SCHED_OTHER);
}

static void try_in_child(void (*try)(void))
{
    int status;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        try();
        _exit(FINE);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    if (WIFEXITED(status) && WEXITSTATUS(status) == SKIPPED) skip();
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == FINE);
}

static void with_the_right(void **state)
{
    (void)state;
    try_in_child(goes_and_comes_back);
}

static void without_the_right(void **state)
{
    (void)state;
    try_in_child(stays_where_it_could_not_come_back);
}

static void no_worker(void **state)
{
    (void)state;
    try_in_child(others_stay);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(with_the_right),
                                       cmocka_unit_test(without_the_right),
                                       cmocka_unit_test(no_worker)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
