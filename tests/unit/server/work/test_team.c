#include "server/work/team.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#include "gd/control.h"
#include "tests/support/test.h"

/* Runs of two tasks, as a field has them: each adds to its own sum what it finds in the other's, so
 * that a task that is left out, done twice or mixed with those of another run shows. */
enum { RUNS = 2000 };

struct sums {
    uint64_t before[2], after[2];
    pthread_t thread[2];
    uint32_t other_thread; /* runs whose tasks were done by two threads */
};

static void add(void *context, uint32_t index)
{
    struct sums *sums = context;
    sums->after[index] = 3 * sums->before[1 - index] + index + 1;
    sums->thread[index] = pthread_self();
    for (uint64_t end = gd_now_ns() + 5000; gd_now_ns() < end;) continue;
}

static void check_runs(const struct gd_executor *executor, struct sums *sums)
{
    uint64_t expected[2] = {0, 0};
    *sums = (struct sums){0};
    for (int i = 0; i < RUNS; i++) {
        gd_executor_run(executor, add, sums, 2);
        memcpy(sums->before, sums->after, sizeof sums->before);
        sums->other_thread += !pthread_equal(sums->thread[0], sums->thread[1]);
        uint64_t first = 3 * expected[1] + 1;
        expected[1] = 3 * expected[0] + 2;
        expected[0] = first;
    }
    assert_memory_equal(sums->after, expected, sizeof expected);
}

/* Runs until the helper has taken part, which on a busy machine may take a while: workers come
 * after all others. */
static void check_runs_of_two(const struct gd_executor *executor, struct sums *sums)
{
    uint64_t end = gd_now_ns() + UINT64_C(20000000000);
    do check_runs(executor, sums);
    while (!sums->other_thread && gd_now_ns() < end);
    assert_true(sums->other_thread > 0);
}

static void many_runs(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 8);
    struct server_team *team = server_team_call(workers, UINT64_MAX);
    const struct gd_executor *executor = server_team_executor(team);
    struct sums sums;
    assert_int_equal(executor->width, 2);
    check_runs_of_two(executor, &sums);
    print_message("# %u of %d runs by two threads\n", sums.other_thread, RUNS);
    struct timespec pause = {.tv_nsec = 2000000};
    nanosleep(&pause, NULL); /* the helper sleeps by now */
    check_runs_of_two(executor, &sums);
    server_team_dismiss(team);
    server_workers_destroy(workers);
}

static void nobody_helps(void **state)
{
    (void)state;
    struct server_workers *one = server_workers_create(1, 8), *none = server_workers_create(2, 8);
    assert_null(server_team_call(one, UINT64_MAX));
    assert_null(server_team_executor(NULL));
    server_team_dismiss(NULL);
    server_workers_cancel(none); /* refuses the helper */
    struct server_team *team = server_team_call(none, UINT64_MAX);
    struct sums sums;
    check_runs(server_team_executor(team), &sums);
    assert_int_equal(sums.other_thread, 0);
    server_team_dismiss(team);
    server_workers_destroy(one);
    server_workers_destroy(none);
}

struct waiting {
    struct server_job job;
    atomic_bool ran;
};

static void note(struct server_job *job)
{
    atomic_store(&((struct waiting *)job)->ran, true);
}

static void never(struct server_job *job, enum server_refusal why)
{
    (void)job, (void)why;
    fail();
}

/* A job that comes while the helper holds the only worker is not kept waiting, and the runs go on
 * without it. */
static void leaves_when_wanted(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 8);
    struct server_team *first = server_team_call(workers, UINT64_MAX),
                       *second = server_team_call(workers, UINT64_MAX);
    struct waiting waiting = {.job = {.run = note, .refuse = never, .deadline_ns = UINT64_MAX}};
    struct sums sums;
    gd_executor_run(server_team_executor(first), add, &sums, 2);
    assert_true(server_workers_submit(workers, &waiting.job));
    for (uint64_t end = gd_now_ns() + UINT64_C(5000000000);
         !atomic_load(&waiting.ran) && gd_now_ns() < end;) {
        gd_executor_run(server_team_executor(first), add, &sums, 2);
        gd_executor_run(server_team_executor(second), add, &sums, 2);
    }
    assert_true(atomic_load(&waiting.ran));
    check_runs(server_team_executor(first), &sums);
    server_team_dismiss(first);
    server_team_dismiss(second);
    server_workers_destroy(workers);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(many_runs), cmocka_unit_test(nobody_helps),
                                       cmocka_unit_test(leaves_when_wanted)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
