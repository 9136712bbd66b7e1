#include "tests/unit/server/folder.h"

#include "server/surfaces/pending_loads.h"

struct fixture {
    struct server_workers *workers;
    struct server_pending_loads *loads;
    struct server_record *record, *other;
    struct test_job job;
    struct server_pending_load *load;
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    fixture->workers = server_workers_create(1, 4);
    fixture->loads = server_pending_loads_create(fixture->workers);
    fixture->record = new_record("a", "1");
    fixture->other = new_record("b", "2");
    test_job_init(&fixture->job, NULL);
    assert_int_equal(
        server_pending_loads_enter(fixture->loads, fixture->record, NULL, &fixture->load),
        SERVER_PENDING_LOADS_LOAD);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    server_workers_destroy(fixture->workers);
    server_pending_loads_destroy(fixture->loads);
    server_record_release(fixture->record);
    server_record_release(fixture->other);
    free(fixture);
    return 0;
}

static void who_waits_is_resumed(void **state)
{
    struct fixture *fixture = *state;
    struct server_pending_load *second;
    assert_int_equal(
        server_pending_loads_enter(fixture->loads, fixture->record, &fixture->job.job, &second),
        SERVER_PENDING_LOADS_WAIT);
    server_pending_loads_end(fixture->load);
    sem_wait(&fixture->job.done);
    assert_int_equal(fixture->job.runs, 1);
    assert_false(server_pending_loads_join(fixture->loads, fixture->record, &fixture->job.job));
}

static void others_are_loaded_meanwhile(void **state)
{
    struct fixture *fixture = *state;
    struct server_pending_load *second;
    assert_int_equal(
        server_pending_loads_enter(fixture->loads, fixture->other, &fixture->job.job, &second),
        SERVER_PENDING_LOADS_LOAD);
    server_pending_loads_end(fixture->load);
    server_pending_loads_end(second);
    assert_int_equal(fixture->job.runs + fixture->job.refusals, 0);
}

static void a_failure_for_all_is_told_to_all(void **state)
{
    struct fixture *fixture = *state;
    assert_true(server_pending_loads_join(fixture->loads, fixture->record, &fixture->job.job));
    server_pending_loads_fail(fixture->load, SERVER_REFUSAL_MEMORY);
    assert_int_equal(fixture->job.refusals, 1);
    assert_int_equal(fixture->job.why, SERVER_REFUSAL_MEMORY);
}

static void who_waits_has_a_deadline(void **state)
{
    struct fixture *fixture = *state;
    fixture->job.job.deadline_ns = 100;
    assert_true(server_pending_loads_join(fixture->loads, fixture->record, &fixture->job.job));
    server_pending_loads_expire(fixture->loads, 99);
    assert_int_equal(fixture->job.refusals, 0);
    server_pending_loads_expire(fixture->loads, 100);
    assert_int_equal(fixture->job.refusals, 1);
    assert_int_equal(fixture->job.why, SERVER_REFUSAL_DEADLINE);
    server_pending_loads_end(fixture->load);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(who_waits_is_resumed),
        TEST(others_are_loaded_meanwhile),
        TEST(a_failure_for_all_is_told_to_all),
        TEST(who_waits_has_a_deadline),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
