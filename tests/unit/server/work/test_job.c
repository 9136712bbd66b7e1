#include "tests/unit/server/support.h"

static void takes_out_those_that_are_late(void **state)
{
    (void)state;
    static const uint64_t deadlines[] = {5, 50, 6, 60, 7};
    struct test_job jobs[5];
    struct server_job *list = NULL;
    for (int i = 4; i >= 0; i--) {
        test_job_init(&jobs[i], NULL);
        jobs[i].job.deadline_ns = deadlines[i];
        jobs[i].job.next = list;
        list = &jobs[i].job;
    }
    struct server_job *expired = server_jobs_expire(&list, 6);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
    for (int i = 0; i < 5; i++) assert_int_equal(jobs[i].refusals, deadlines[i] <= 6);
    assert_ptr_equal(list, &jobs[1].job); /* the others stay, in their order */
    assert_ptr_equal(list->next, &jobs[3].job);
    assert_ptr_equal(list->next->next, &jobs[4].job);
    assert_null(list->next->next->next);
}

static void what_is_not_wanted_is_late(void **state)
{
    (void)state;
    struct test_job jobs[2];
    for (int i = 0; i < 2; i++) test_job_init(&jobs[i], NULL);
    jobs[0].job.next = &jobs[1].job;
    jobs[1].job.next = NULL;
    struct server_job *list = &jobs[0].job;
    assert_null(server_jobs_expire(&list, 6));
    atomic_store(&jobs[0].job.is_unwanted, true);
    assert_ptr_equal(server_jobs_expire(&list, 6), &jobs[0].job);
    assert_ptr_equal(list, &jobs[1].job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_out_those_that_are_late),
        cmocka_unit_test(what_is_not_wanted_is_late),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
