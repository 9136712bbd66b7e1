#include "tests/unit/server/support.h"

#include <sched.h>
#include <stdatomic.h>

#include "gd/control.h"

static void runs_submitted_jobs(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(2, 100);
    struct test_job jobs[50];
    for (size_t i = 0; i < COUNT(jobs); i++) {
        test_job_init(&jobs[i], NULL);
        assert_true(server_workers_submit(workers, &jobs[i].job));
    }
    for (size_t i = 0; i < COUNT(jobs); i++) sem_wait(&jobs[i].done);
    server_workers_destroy(workers);
    for (size_t i = 0; i < COUNT(jobs); i++) {
        assert_int_equal(jobs[i].runs, 1);
        assert_int_equal(jobs[i].refusals, 0);
    }
}

/* Creates a pool of one thread that is busy until `hold` is posted. */
static struct server_workers *busy_workers(struct test_job *first, sem_t *hold,
                                           uint32_t queue_length)
{
    struct server_workers *workers = server_workers_create(1, queue_length);
    sem_init(hold, 0, 0);
    test_job_init(first, hold);
    assert_true(server_workers_submit(workers, &first->job));
    /* waits until the job has started, because a job that counts as running may still be refused */
    sem_wait(&first->began);
    return workers;
}

static void a_full_queue_accepts_resumed_jobs_only(void **state)
{
    (void)state;
    sem_t hold;
    struct test_job first, queued[2], refused, parked;
    struct server_workers *workers = busy_workers(&first, &hold, 2);
    for (int i = 0; i < 2; i++) {
        test_job_init(&queued[i], NULL);
        assert_true(server_workers_submit(workers, &queued[i].job));
    }
    test_job_init(&refused, NULL);
    assert_false(server_workers_submit(workers, &refused.job));
    test_job_init(&parked, NULL);
    server_workers_resume(workers, &parked.job);
    assert_int_equal(server_workers_load(workers).queued, 3);
    sem_post(&hold);
    sem_wait(&parked.done);
    sem_wait(&queued[1].done);
    server_workers_destroy(workers);
    assert_int_equal(queued[0].runs + queued[1].runs + parked.runs, 3);
    assert_int_equal(refused.runs + refused.refusals, 0);
}

static void queued_jobs_have_deadlines(void **state)
{
    (void)state;
    sem_t hold;
    struct test_job first, early, late;
    struct server_workers *workers = busy_workers(&first, &hold, 10);
    test_job_init(&early, NULL);
    test_job_init(&late, NULL);
    early.job.deadline_ns = gd_now_ns() + 1000;
    assert_true(server_workers_submit(workers, &late.job));
    assert_true(server_workers_submit(workers, &early.job));
    server_workers_expire(workers, early.job.deadline_ns - 1);
    assert_int_equal(early.refusals, 0);
    server_workers_expire(workers, early.job.deadline_ns);
    assert_int_equal(early.refusals, 1);
    assert_int_equal(early.why, SERVER_REFUSAL_DEADLINE);
    assert_int_equal(server_workers_load(workers).queued, 1);
    sem_post(&hold);
    sem_wait(&late.done);
    server_workers_destroy(workers);
    assert_int_equal(late.runs, 1);
    assert_int_equal(early.runs, 0);
}

static void a_job_whose_deadline_has_passed_is_not_begun(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(1, 10);
    struct test_job job;
    test_job_init(&job, NULL);
    job.job.deadline_ns = 1;
    assert_true(server_workers_submit(workers, &job.job));
    sem_wait(&job.done);
    server_workers_destroy(workers);
    assert_int_equal(job.refusals, 1);
    assert_int_equal(job.why, SERVER_REFUSAL_DEADLINE);
}

static void a_cancel_refuses_all_waiting_jobs(void **state)
{
    (void)state;
    sem_t hold;
    struct test_job first, queued, later, parked;
    struct server_workers *workers = busy_workers(&first, &hold, 10);
    test_job_init(&queued, NULL);
    test_job_init(&later, NULL);
    test_job_init(&parked, NULL);
    assert_true(server_workers_submit(workers, &queued.job));
    assert_false(server_workers_cancelled(workers));
    server_workers_cancel(workers);
    assert_true(server_workers_cancelled(workers));
    /* the workers accept the job and call its `refuse` function */
    assert_true(server_workers_submit(workers, &later.job));
    server_workers_resume(workers, &parked.job);
    assert_int_equal(queued.refusals + later.refusals + parked.refusals, 3);
    assert_int_equal(queued.why, SERVER_REFUSAL_DRAINING);
    assert_int_equal(first.runs, 0);
    sem_post(&hold);
    server_workers_destroy(workers); /* waits for the running job */
    assert_int_equal(first.runs, 1);
}

static void a_foreign_thread_makes_the_workers_busy(void **state)
{
    (void)state;
    struct server_workers *workers = server_workers_create(1, 10);
    while (server_workers_are_busy(workers)) continue;
    server_workers_begin_guest(workers);
    assert_true(server_workers_are_busy(workers));
    assert_int_equal(server_workers_load(workers).running, 0);
    assert_true(server_workers_go_on(workers));
    server_workers_end_guest(workers);
    assert_false(server_workers_are_busy(workers));
    assert_int_equal(sched_getscheduler(0), SCHED_OTHER);
    server_workers_destroy(workers);
}

static void a_parked_job_is_queued_again_or_refused(void **state)
{
    (void)state;
    struct test_job back, too, brief, poor, never, late, left, after;
    struct server_workers *workers = server_workers_create(1, 10);
    struct test_job *jobs[] = {&back, &too, &brief, &poor, &never, &late, &left, &after};
    for (size_t i = 0; i < COUNT(jobs); i++) test_job_init(jobs[i], NULL);
    late.job.deadline_ns = gd_now_ns();
    assert_true(server_workers_park(workers, &left.job, &left, 0) &&
                server_workers_park(workers, &late.job, &left, 0) &&
                server_workers_park(workers, &poor.job, &poor, 0) &&
                server_workers_park(workers, &back.job, &back, 0) &&
                server_workers_park(workers, &too.job, &back, 0));
    server_workers_unpark(workers, &never.job);
    assert_true(server_workers_await(workers, &back));
    server_workers_unpark(workers, &back);
    server_workers_unpark(workers, &back);
    assert_false(server_workers_await(workers, &back));
    sem_wait(&back.done);
    sem_wait(&too.done);
    assert_true(server_workers_park(workers, &brief.job, &brief, 1000));
    server_workers_expire(workers, 999);
    assert_true(server_workers_await(workers, &brief));
    server_workers_expire(workers, 1000);
    sem_wait(&brief.done);
    assert_int_equal(brief.runs, 1);
    server_workers_refuse_parked(workers, &poor, SERVER_REFUSAL_MEMORY);
    assert_int_equal(poor.refusals, 1);
    assert_int_equal(poor.why, SERVER_REFUSAL_MEMORY);
    server_workers_expire(workers, gd_now_ns());
    assert_int_equal(late.refusals, 1);
    assert_int_equal(late.why, SERVER_REFUSAL_DEADLINE);
    assert_int_equal(left.refusals, 0);
    server_workers_cancel(workers);
    assert_int_equal(left.refusals, 1);
    assert_int_equal(left.why, SERVER_REFUSAL_DRAINING);
    assert_false(server_workers_park(workers, &after.job, &left, 0));
    server_workers_unpark(workers, &left);
    server_workers_destroy(workers);
    assert_int_equal(back.runs, 1);
    assert_int_equal(too.runs, 1);
    assert_int_equal(never.runs + late.runs + left.runs + after.runs + after.refusals, 0);
}

/* --- spare threads ---------------------------------------------------------------------------- */

static void of_tenant(struct test_job *job, const char *tenant, bool is_patient)
{
    job->job.tenant = tenant;
    job->job.is_patient = is_patient;
}

/* Creates two workers with two spare threads, and two jobs of a tenant that run until `hold` is
 * posted. */
static struct server_workers *flooded_workers(struct test_job first[2], sem_t *hold,
                                              bool is_patient)
{
    struct server_workers *workers = server_workers_create(2, 100);
    assert_true(server_workers_add_spare(workers));
    sem_init(hold, 0, 0);
    for (int i = 0; i < 2; i++) {
        test_job_init(&first[i], hold);
        of_tenant(&first[i], "flood", is_patient);
        assert_true(server_workers_submit(workers, &first[i].job));
        sem_wait(&first[i].began);
    }
    return workers;
}

static void end_flooded(struct server_workers *workers, sem_t *hold, int count)
{
    for (int i = 0; i < count; i++) sem_post(hold);
    server_workers_destroy(workers);
}

static void a_spare_thread_runs_a_job_of_another_tenant(void **state)
{
    (void)state;
    sem_t hold;
    struct test_job first[2], more, own[3];
    struct server_workers *workers = flooded_workers(first, &hold, false);
    test_job_init(&more, NULL);
    of_tenant(&more, "flood", false);
    assert_true(server_workers_submit(workers, &more.job));
    for (int i = 0; i < 3; i++) {
        test_job_init(&own[i], NULL);
        of_tenant(&own[i], "other", i == 1);
        assert_true(server_workers_submit(workers, &own[i].job));
    }
    for (int i = 0; i < 3; i++) sem_wait(&own[i].done);
    assert_int_equal(more.runs, 0);
    end_flooded(workers, &hold, 2);
}

static void a_spare_thread_runs_an_urgent_job_beside_patient_ones(void **state)
{
    (void)state;
    sem_t hold;
    struct test_job first[2], urgent[2], patient;
    struct server_workers *workers = flooded_workers(first, &hold, true);
    test_job_init(&patient, NULL);
    of_tenant(&patient, "flood", true);
    assert_true(server_workers_submit(workers, &patient.job));
    for (int i = 0; i < 2; i++) {
        test_job_init(&urgent[i], i ? NULL : &hold);
        of_tenant(&urgent[i], "flood", false);
        assert_true(server_workers_submit(workers, &urgent[i].job));
    }
    sem_wait(&urgent[0].began);
    sem_wait(&urgent[1].done);
    assert_int_equal(patient.runs, 0);
    end_flooded(workers, &hold, 3);
}

/* A job that submits another job, as executors do. The other job has the same tenant and kind. */
struct submitting {
    struct server_job job; /* must be the first member */
    struct server_workers *workers;
    struct test_job *other;
    sem_t done;
};

static void submit_other(struct server_job *job)
{
    struct submitting *submitting = (struct submitting *)job;
    assert_true(server_workers_submit(submitting->workers, &submitting->other->job));
    sem_post(&submitting->done);
}

static void submitted_jobs_belong_to_the_tenant(void **state)
{
    (void)state;
    struct test_job other;
    struct server_workers *workers = server_workers_create(1, 10);
    struct submitting submitting = {.job = {.run = submit_other,
                                            .deadline_ns = UINT64_MAX,
                                            .tenant = "ann",
                                            .is_patient = true},
                                    .workers = workers,
                                    .other = &other};
    sem_init(&submitting.done, 0, 0);
    test_job_init(&other, NULL);
    assert_true(server_workers_submit(workers, &submitting.job));
    sem_wait(&other.done);
    assert_true(other.job.is_patient);
    sem_wait(&submitting.done);
    server_workers_destroy(workers);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_submitted_jobs),
        cmocka_unit_test(a_full_queue_accepts_resumed_jobs_only),
        cmocka_unit_test(queued_jobs_have_deadlines),
        cmocka_unit_test(a_job_whose_deadline_has_passed_is_not_begun),
        cmocka_unit_test(a_cancel_refuses_all_waiting_jobs),
        cmocka_unit_test(a_foreign_thread_makes_the_workers_busy),
        cmocka_unit_test(a_parked_job_is_queued_again_or_refused),
        cmocka_unit_test(a_spare_thread_runs_a_job_of_another_tenant),
        cmocka_unit_test(a_spare_thread_runs_an_urgent_job_beside_patient_ones),
        cmocka_unit_test(submitted_jobs_belong_to_the_tenant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
