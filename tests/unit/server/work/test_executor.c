#include "tests/unit/server/support.h"

#include "server/work/executor.h"

/* A job on a worker that runs an executor of `count` tasks. */
struct run {
    struct test_job job; /* first */
    struct server_workers *workers;
    uint32_t count;
    atomic_uint *done; /* per task: how often */
    atomic_uint at_work, most_at_work;
    sem_t *wait_for; /* every task waits for it; NULL: none does */
    sem_t *start;    /* the run waits for it; NULL: it does not */
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
    struct server_executor executor;
    if (run->start) sem_wait(run->start);
    gd_executor_run(server_executor_of(&executor, run->workers, UINT64_MAX), do_task, run,
                    run->count);
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
    while (atomic_load(&run.at_work) < 3) continue; /* all three are at a task */
    for (int i = 0; i < 9; i++) sem_post(&gate);
    finish(&run);
    assert_int_equal(atomic_load(&run.most_at_work), 3);
    server_workers_destroy(workers);
    sem_destroy(&gate);
}

/* As many runs as threads: nobody is there to help, and none waits for the other. */
static void runs_of_all_workers_at_once_end(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 100);
    struct run runs[20];
    for (size_t i = 0; i < COUNT(runs); i++) start(&runs[i], workers, 50, NULL);
    for (size_t i = 0; i < COUNT(runs); i++) finish(&runs[i]);
    server_workers_destroy(workers);
}

/* A helper queues up behind what came meanwhile. Tasks may go on one at a time: of many, the run's
 * own thread could take all before the helper wakes. */
static void others_get_their_turn_between_tasks(void **state)
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
        assert_true(gone_on++ < run.count - 2); /* of the last two, one is each thread's */
        sem_post(&gate);
        nanosleep(&moment, NULL);
    }
    assert_int_equal(other.runs, 1);
    while (gone_on++ < run.count) sem_post(&gate);
    finish(&run);
    server_workers_destroy(workers);
    sem_destroy(&gate);
}

/* No room for helpers: the thread does it all itself. */
static void a_full_queue_does_not_matter(void **state)
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

/* What is refused by a drain is done by the thread itself; the caller's tasks see to it that they
 * end early. */
static void helpers_may_be_refused(void **state)
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_task_runs_once),
        cmocka_unit_test(idle_workers_help),
        cmocka_unit_test(runs_of_all_workers_at_once_end),
        cmocka_unit_test(others_get_their_turn_between_tasks),
        cmocka_unit_test(a_full_queue_does_not_matter),
        cmocka_unit_test(helpers_may_be_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
