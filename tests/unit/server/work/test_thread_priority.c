/* Tests the priority of a worker's thread, with and without the right to leave idle priority, in
 * child processes. */
#include "tests/unit/server/child.h"
#include "tests/unit/server/support.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include "server/work/thread_priority.h"

#define NOBODY 65534

static int nice_of_thread(void)
{
    return getpriority(PRIO_PROCESS, (id_t)syscall(SYS_gettid));
}

static void goes_and_comes_back(void)
{
    if (setpriority(PRIO_PROCESS, 0, -1) != 0) SKIP_CHILD("raising a priority needs CAP_SYS_NICE");
    server_worker_lower();
    int nice = nice_of_thread();
    INSIST(nice > 0 && sched_getscheduler(0) == SCHED_OTHER);
    for (int turn = 0; turn < 3; turn++) {
        server_worker_set_idle(true);
        INSIST(sched_getscheduler(0) == SCHED_IDLE);
        server_worker_set_idle(true);
        server_worker_set_idle(false);
        INSIST(sched_getscheduler(0) == SCHED_OTHER && nice_of_thread() == nice);
    }
}

static void stays_where_it_could_not_come_back(void)
{
    const struct rlimit none = {0, 0};
    if (setrlimit(RLIMIT_NICE, &none) != 0 || (geteuid() == 0 && setuid(NOBODY) != 0))
        SKIP_CHILD("the limit RLIMIT_NICE or the user cannot be changed");
    server_worker_lower();
    INSIST(nice_of_thread() > 0);
    server_worker_set_idle(true);
    INSIST(sched_getscheduler(0) == SCHED_OTHER);
}

/* Tests a thread that is not a worker, so that its rights are unknown. */
static void others_stay(void)
{
    server_worker_set_idle(true);
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

static void with_the_right_a_worker_returns(void **state)
{
    (void)state;
    try_in_child(goes_and_comes_back);
}

static void without_the_right_a_worker_stays(void **state)
{
    (void)state;
    try_in_child(stays_where_it_could_not_come_back);
}

static void other_threads_are_unchanged(void **state)
{
    (void)state;
    try_in_child(others_stay);
}

/* --- of a job --------------------------------------------------------------------------------- */

#define MS UINT64_C(1000000)

/* Updates the priority of a job every millisecond from `from` to `to`, for a thread that gets
 * 1/`part` of the processor's time. Returns the number of updates after which the job has idle
 * priority. */
static uint32_t look(struct server_priority *priority, uint64_t from, uint64_t to, uint64_t part)
{
    uint32_t behind = 0;
    for (uint64_t at = from; at < to; at++)
        behind += server_priority_update(priority, at * MS, at * MS / part);
    return behind;
}

static void long_work_gets_idle_priority(void **state)
{
    (void)state;
    struct server_priority priority;
    server_priority_begin(&priority, 7000 * MS);
    assert_int_equal(look(&priority, 7000, 7050, 1), 0);
    assert_int_equal(look(&priority, 7050, 9000, 1), 1950);
    server_priority_begin(&priority, 9000 * MS);
    assert_int_equal(look(&priority, 9000, 9050, 1), 0);
    assert_int_equal(look(&priority, 9050, 9100, 1), 50);
}

/* A thread at idle priority that gets half of the processor's time stays at idle priority. If the
 * thread gets only a twentieth for 0.1 s, it returns to normal priority. It keeps normal priority
 * for one second the first time, and for two seconds the next time. */
static void starving_work_returns_to_normal(void **state)
{
    (void)state;
    struct server_priority priority;
    server_priority_begin(&priority, 1000 * MS);
    assert_int_equal(look(&priority, 1050, 2050, 2), 1000);
    server_priority_begin(&priority, 3000 * MS);
    assert_int_equal(look(&priority, 3050, 3150, 20), 100);
    assert_int_equal(look(&priority, 3150, 4150, 20), 0);
    assert_int_equal(look(&priority, 4150, 4250, 20), 100);
    assert_int_equal(look(&priority, 4250, 6250, 20), 0);
    assert_int_equal(look(&priority, 6250, 6350, 20), 100);
}

/* A thread that did not run for a while detects this pause at its next update. */
static void a_long_pause_is_detected(void **state)
{
    (void)state;
    struct server_priority priority;
    server_priority_begin(&priority, 0);
    assert_true(server_priority_update(&priority, 60 * MS, 60 * MS));
    assert_false(server_priority_update(&priority, 900 * MS, 63 * MS));
    assert_false(server_priority_update(&priority, 1800 * MS, 963 * MS));
    assert_true(server_priority_update(&priority, 1901 * MS, 1064 * MS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(with_the_right_a_worker_returns),
                                       cmocka_unit_test(without_the_right_a_worker_stays),
                                       cmocka_unit_test(other_threads_are_unchanged),
                                       cmocka_unit_test(long_work_gets_idle_priority),
                                       cmocka_unit_test(starving_work_returns_to_normal),
                                       cmocka_unit_test(a_long_pause_is_detected)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
