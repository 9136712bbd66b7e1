#include "tests/unit/server/support.h"

#include "gd/control.h"
#include "server/base/thread.h"

#define MS UINT64_C(1000000)

struct fixture {
    sem_t go, done; /* each step of the thread waits for `go` and posts `done` */
    bool (*rest)(struct server_thread *thread, uint64_t ns);
    uint64_t ns;
    int steps;
};

static void run(void *user, struct server_thread *thread)
{
    struct fixture *fixture = user;
    do {
        sem_wait(&fixture->go);
        fixture->steps++;
        sem_post(&fixture->done);
    } while (fixture->rest(thread, fixture->ns));
}

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    sem_init(&fixture->go, 0, 1);
    sem_init(&fixture->done, 0, 0);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    free(*state);
    return 0;
}

static struct server_thread *
start(struct fixture *fixture, bool (*rest)(struct server_thread *thread, uint64_t ns), uint64_t ns)
{
    fixture->rest = rest;
    fixture->ns = ns;
    struct server_thread *thread = server_thread_start(run, fixture);
    assert_non_null(thread);
    return thread;
}

static void a_wake_during_work_ends_the_next_pause(void **state)
{
    struct fixture *fixture = *state;
    struct server_thread *thread = start(fixture, server_thread_pause, SERVER_THREAD_FOREVER);
    server_thread_wake(thread); /* the thread may not have started yet */
    sem_wait(&fixture->done);
    for (int i = 0; i < 100; i++) {
        sem_post(&fixture->go);
        sem_wait(&fixture->done);
        server_thread_wake(thread); /* the thread works or pauses */
    }
    sem_post(&fixture->go);
    sem_wait(&fixture->done);
    server_thread_stop(thread);
    assert_int_equal(fixture->steps, 102);
}

static void a_pause_ends_by_itself(void **state)
{
    struct fixture *fixture = *state;
    uint64_t begun = gd_now_ns();
    struct server_thread *thread = start(fixture, server_thread_pause, 20 * MS);
    sem_post(&fixture->go);
    sem_wait(&fixture->done);
    sem_wait(&fixture->done);
    assert_true(gd_now_ns() - begun >= 20 * MS);
    sem_post(&fixture->go);
    server_thread_stop(thread);
}

static void a_wake_does_not_end_a_sleep(void **state)
{
    struct fixture *fixture = *state;
    uint64_t begun = gd_now_ns();
    struct server_thread *thread = start(fixture, server_thread_sleep, 20 * MS);
    sem_wait(&fixture->done);
    server_thread_wake(thread);
    sem_post(&fixture->go);
    sem_wait(&fixture->done);
    assert_true(gd_now_ns() - begun >= 20 * MS);
    sem_post(&fixture->go);
    server_thread_stop(thread);
}

static void a_stop_ends_pauses_and_sleeps(void **state)
{
    struct fixture *fixture = *state;
    struct server_thread *thread = start(fixture, server_thread_pause, SERVER_THREAD_FOREVER);
    sem_wait(&fixture->done);
    server_thread_stop(thread);
    sem_post(&fixture->go);
    thread = start(fixture, server_thread_sleep, SERVER_THREAD_FOREVER - 1);
    sem_wait(&fixture->done);
    server_thread_stop(thread);
    assert_int_equal(fixture->steps, 2);
    server_thread_stop(NULL);
}

/* Static, because the thread may outlive the test. */
static sem_t late_go, late_done;

static void run_late(void *user, struct server_thread *thread)
{
    (void)user, (void)thread;
    sem_wait(&late_go);
    sem_post(&late_done);
}

static void a_stop_can_abandon_a_thread(void **state)
{
    (void)state;
    uint64_t begun = gd_now_ns();
    sem_init(&late_go, 0, 0);
    sem_init(&late_done, 0, 0);
    struct server_thread *thread = server_thread_start(run_late, NULL);
    assert_false(server_thread_stop_within(thread, 20 * MS));
    assert_true(gd_now_ns() - begun >= 20 * MS);
    sem_post(&late_go);
    sem_wait(&late_done);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_wake_during_work_ends_the_next_pause),
        TEST(a_pause_ends_by_itself),
        TEST(a_wake_does_not_end_a_sleep),
        TEST(a_stop_ends_pauses_and_sleeps),
        cmocka_unit_test(a_stop_can_abandon_a_thread),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
