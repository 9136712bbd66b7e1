#include "tests/unit/server/support.h"

#include <sched.h>
#include <sys/resource.h>

#include "server/work/executor.h"

/* A job on a worker that runs an executor of `count` tasks. */
struct run {
    struct test_job job; /* must be the first member */
    struct server_workers *workers;
    uint32_t count;
    atomic_uint *done; /* for each task, how often the task ran */
    atomic_uint at_work, most_at_work;
    sem_t *wait_for; /* every task waits for this semaphore; NULL if no task waits */
    sem_t *start;    /* the run waits for this semaphore; NULL if it does not wait */
};

static void do_task(void *context, uint32_t index)
{
    struct run *run = context;
    unsigned now = atomic_fetch_add(&run->at_work, 1) + 1, most = atomic_load(&run->most_at_work);
    while (now > most && !atomic_compare_exchange_weak(&run->most_at_work, &most, now)) continue;
    if (run->wait_for) sem_wait(run->wait_for);
    atomic_fetch_add(&run->done[index], 1);
    atomic_fetch_sub(&run->at_work, 1);
}

static void execute(struct server_job *job)
{
    struct run *run = (struct run *)job;
    if (run->start) sem_wait(run->start);
    const struct gd_executor *executor =
        server_executor_start(run->workers, run->count, UINT64_MAX);
    gd_executor_run(executor, do_task, run, run->count);
    server_executor_stop(executor);
    assert_int_equal(atomic_load(&run->at_work), 0);
    test_job_run(job);
}

static void prepare(struct run *run, struct server_workers *workers, uint32_t count,
                    sem_t *wait_for)
{
    memset(run, 0, sizeof *run);
    test_job_init(&run->job, NULL);
    run->job.job.run = execute;
    run->workers = workers;
    run->count = count;
    run->wait_for = wait_for;
    run->done = test_calloc(count, sizeof *run->done);
}

static void start(struct run *run, struct server_workers *workers, uint32_t count, sem_t *wait_for)
{
    prepare(run, workers, count, wait_for);
    assert_true(server_workers_submit(workers, &run->job.job));
}

static void finish(struct run *run)
{
    sem_wait(&run->job.done);
    assert_int_equal(run->job.runs, 1);
    for (uint32_t i = 0; i < run->count; i++) assert_int_equal(atomic_load(&run->done[i]), 1);
    test_free(run->done);
}

static void every_task_runs_once(void **state)
{
    (void)state;
    for (uint32_t threads = 1; threads <= 4; threads++) {
        struct server_workers *workers = server_workers_create(threads, 100);
        static const uint32_t counts[] = {1, 2, 3, 1000};
        for (size_t i = 0; i < COUNT(counts); i++) {
            struct run run;
            start(&run, workers, counts[i], NULL);
            finish(&run);
        }
        server_workers_destroy(workers);
    }
}

static void idle_workers_help(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(3, 100);
    sem_t gate;
    sem_init(&gate, 0, 0);
    struct run run;
    start(&run, workers, 9, &gate);
    while (atomic_load(&run.at_work) < 3) continue; /* all three threads run a task */
    for (int i = 0; i < 9; i++) sem_post(&gate);
    finish(&run);
    assert_int_equal(atomic_load(&run.most_at_work), 3);
    server_workers_destroy(workers);
    sem_destroy(&gate);
}

/* There are as many runs as threads, so there are no helpers, and no run waits for another run. */
static void runs_on_all_workers_end(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 100);
    struct run runs[20];
    for (size_t i = 0; i < COUNT(runs); i++) start(&runs[i], workers, 50, NULL);
    for (size_t i = 0; i < COUNT(runs); i++) finish(&runs[i]);
    server_workers_destroy(workers);
}

/* After each task, a helper queues itself behind the jobs that have arrived meanwhile. The test
 * lets one task end at a time. Otherwise the run's own thread could run all tasks before the helper
 * wakes. */
static void other_jobs_run_between_tasks(void **state)
{
    (void)state;
    const struct timespec moment = {.tv_nsec = 1000000};
    uint32_t gone_on = 0;
    struct server_workers *workers = server_workers_create(2, 100);
    sem_t gate;
    sem_init(&gate, 0, 0);
    struct run run;
    struct test_job other;
    test_job_init(&other, NULL);
    start(&run, workers, 40, &gate);
    while (atomic_load(&run.at_work) < 2) continue;
    assert_true(server_workers_submit(workers, &other.job));
    while (sem_trywait(&other.done) != 0) {
        assert_true(gone_on++ < run.count - 2); /* each thread runs one of the last two tasks */
        sem_post(&gate);
        nanosleep(&moment, NULL);
    }
    assert_int_equal(other.runs, 1);
    while (gone_on++ < run.count) sem_post(&gate);
    finish(&run);
    server_workers_destroy(workers);
    sem_destroy(&gate);
}

/* The queue has no room for helpers, so the thread runs all tasks. */
static void a_full_queue_leaves_all_tasks_to_the_thread(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 1);
    sem_t hold, begin;
    sem_init(&hold, 0, 0);
    sem_init(&begin, 0, 0);
    struct test_job blocker, queued;
    struct run run;
    test_job_init(&blocker, &hold);
    test_job_init(&queued, NULL);
    prepare(&run, workers, 30, NULL);
    run.start = &begin;
    assert_true(server_workers_submit(workers, &blocker.job));
    while (server_workers_load(workers).running < 1) continue;
    assert_true(server_workers_submit(workers, &run.job.job));
    while (server_workers_load(workers).running < 2) continue;
    assert_true(server_workers_submit(workers, &queued.job));
    sem_post(&begin);
    finish(&run);
    assert_int_equal(atomic_load(&run.most_at_work), 1);
    sem_wait(&queued.done);
    sem_post(&hold);
    sem_wait(&blocker.done);
    server_workers_destroy(workers);
    sem_destroy(&hold);
    sem_destroy(&begin);
}

/* If a drain refuses the helper jobs, the thread of the running job runs all tasks. */
static void refused_helpers_leave_all_tasks_to_the_thread(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 100);
    sem_t gate;
    sem_init(&gate, 0, 0);
    struct run run;
    start(&run, workers, 30, &gate);
    while (atomic_load(&run.at_work) < 2) continue;
    server_workers_cancel(workers);
    for (int i = 0; i < 30; i++) sem_post(&gate);
    finish(&run);
    server_workers_destroy(workers);
    sem_destroy(&gate);
}

/* Number of runs. Each run has two tasks. A task computes its sum from the sum that the other task
 * has computed in the preceding run. So a skipped, repeated or misplaced task changes the sums. */
enum { RUNS = 50 };

struct sums {
    uint64_t before[2], after[2];
    pthread_t thread[2];
    /* the time until which a task waits for the other task of its run to begin */
    uint64_t patience_ns;
    atomic_uint begun;
};

static void add(void *context, uint32_t index)
{
    struct sums *sums = context;
    sums->after[index] = 3 * sums->before[1 - index] + index + 1;
    sums->thread[index] = pthread_self();
    atomic_fetch_add(&sums->begun, 1);
    while (atomic_load(&sums->begun) < 2 && gd_now_ns() < sums->patience_ns) sched_yield();
}

/* Returns the number of runs whose tasks were executed by two threads. If `together`, each task
 * waits until the other task has begun, so each run needs both threads. */
static int check_runs(const struct gd_executor *executor, bool together)
{
    uint64_t expected[2] = {0, 0};
    int two = 0;
    struct sums sums = {0};
    if (together) sums.patience_ns = gd_now_ns() + UINT64_C(60000000000);
    for (int i = 0; i < RUNS; i++) {
        atomic_store(&sums.begun, 0);
        gd_executor_run(executor, add, &sums, 2);
        memcpy(sums.before, sums.after, sizeof sums.before);
        two += !pthread_equal(sums.thread[0], sums.thread[1]);
        uint64_t first = 3 * expected[1] + 1;
        expected[1] = 3 * expected[0] + 2;
        expected[0] = first;
    }
    assert_memory_equal(sums.after, expected, sizeof expected);
    return two;
}

static void one_executor_serves_many_runs(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 8);
    const struct gd_executor *executor = server_executor_start(workers, 9, UINT64_MAX);
    assert_int_equal(executor->width, 2);
    assert_int_equal(check_runs(executor, true), RUNS);
    const struct timespec pause = {.tv_nsec = 2000000};
    nanosleep(&pause, NULL); /* longer than a helper's sleep */
    assert_int_equal(check_runs(executor, true), RUNS);
    server_executor_stop(executor);
    server_workers_destroy(workers);
}

static void one_thread_needs_no_executor(void **state)
{
    (void)state;
    struct server_workers *one = server_workers_create(1, 8);
    struct server_workers *two = server_workers_create(2, 8);
    assert_null(server_executor_start(one, 2, UINT64_MAX));
    assert_null(server_executor_start(two, 1, UINT64_MAX));
    server_executor_stop(NULL);
    server_workers_cancel(two); /* refuses the helper */
    const struct gd_executor *executor = server_executor_start(two, 2, UINT64_MAX);
    assert_int_equal(check_runs(executor, false), 0);
    server_executor_stop(executor);
    server_workers_destroy(one);
    server_workers_destroy(two);
}

/* If a job arrives while helpers hold both workers, the job soon runs. Afterwards a helper runs on
 * this worker again. */
static void helpers_leave_for_a_job_and_come_back(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 8);
    const struct gd_executor *first = server_executor_start(workers, 2, UINT64_MAX);
    const struct gd_executor *second = server_executor_start(workers, 2, UINT64_MAX);
    struct test_job job;
    struct sums sums = {0};
    test_job_init(&job, NULL);
    while (server_workers_load(workers).running < 2) continue;
    assert_true(server_workers_submit(workers, &job.job));
    for (uint64_t end = gd_now_ns() + UINT64_C(20000000000);
         sem_trywait(&job.done) != 0 && gd_now_ns() < end;) {
        gd_executor_run(first, add, &sums, 2);
        gd_executor_run(second, add, &sums, 2);
    }
    assert_int_equal(job.runs, 1);
    assert_int_equal(check_runs(first, true), RUNS);
    assert_int_equal(check_runs(second, true), RUNS);
    server_executor_stop(first);
    server_executor_stop(second);
    server_workers_destroy(workers);
}

static void note_idle(void *context, uint32_t index)
{
    atomic_bool *is_idle = context;
    (void)index;
    if (sched_getscheduler(0) == SCHED_IDLE) atomic_store(is_idle, true);
    for (uint64_t end = gd_now_ns() + 50000; gd_now_ns() < end;) continue;
}

/* A helper that works for long gets idle priority, although its tasks do not check the control. The
 * calling thread is not a worker, so it keeps its priority. */
static void a_long_helper_gets_idle_priority(void **state)
{
    (void)state;
    if (setpriority(PRIO_PROCESS, 0, -1) != 0) skip(); /* needs CAP_SYS_NICE */
    (void)setpriority(PRIO_PROCESS, 0, 0);
    struct server_workers *workers = server_workers_create(2, 8);
    const struct gd_executor *executor = server_executor_start(workers, 2, UINT64_MAX);
    atomic_bool is_idle = false;
    for (uint64_t end = gd_now_ns() + UINT64_C(20000000000); !is_idle && gd_now_ns() < end;)
        gd_executor_run(executor, note_idle, &is_idle, 2);
    assert_true(is_idle);
    server_executor_stop(executor);
    server_workers_destroy(workers);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_task_runs_once),
        cmocka_unit_test(idle_workers_help),
        cmocka_unit_test(runs_on_all_workers_end),
        cmocka_unit_test(other_jobs_run_between_tasks),
        cmocka_unit_test(a_full_queue_leaves_all_tasks_to_the_thread),
        cmocka_unit_test(refused_helpers_leave_all_tasks_to_the_thread),
        cmocka_unit_test(one_executor_serves_many_runs),
        cmocka_unit_test(one_thread_needs_no_executor),
        cmocka_unit_test(helpers_leave_for_a_job_and_come_back),
        cmocka_unit_test(a_long_helper_gets_idle_priority),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
