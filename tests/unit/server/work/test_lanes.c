#include "tests/unit/server/support.h"

#include <stdio.h>

#include "server/work/lanes.h"

#define MS UINT64_C(1000000)

static struct server_lanes lanes;
static struct server_job jobs[1000];
static char names[1000][16];

static int set_up(void **state)
{
    (void)state;
    memset(jobs, 0, sizeof jobs);
    for (size_t i = 0; i < COUNT(jobs); i++) jobs[i].deadline_ns = UINT64_MAX;
    server_lanes_init(&lanes, 2, 256);
    return 0;
}

static bool push(int job, const char *tenant, bool is_patient)
{
    jobs[job].is_patient = is_patient;
    return server_lanes_push(&lanes, server_lanes_of(&lanes, tenant), &jobs[job], false);
}

/* Takes a job and returns its number, or -1 if there is no job. */
static int take(bool is_spare)
{
    const struct server_job *job = server_lanes_take(&lanes, is_spare);
    return job ? (int)(job - jobs) : -1;
}

static void end(int job, uint64_t ns)
{
    server_lanes_end(&lanes, jobs[job].lane, jobs[job].is_patient, ns);
}

static void take_all(void)
{
    for (int job; (job = take(false)) >= 0;) end(job, MS);
    assert_null(lanes.active);
}

static void a_lane_keeps_the_order(void **state)
{
    (void)state;
    for (int i = 0; i < 10; i++) assert_true(push(i, i % 2 ? NULL : "", false));
    server_lanes_push(&lanes, server_lanes_of(&lanes, ""), &jobs[10], true);
    assert_int_equal(server_lanes_queued(&lanes), 11);
    for (int i = -1; i < 10; i++) {
        int job = take(false);
        assert_int_equal(job, i < 0 ? 10 : i);
        end(job, MS);
    }
    assert_int_equal(take(false), -1);
    take_all();
}

static void tenants_take_turns(void **state)
{
    (void)state;
    for (int i = 0; i < 100; i++) assert_true(push(i, "flood", false));
    for (int i = 100; i < 103; i++) assert_true(push(i, "other", false));
    int own = 0;
    for (int i = 0; i < 6; i++) {
        int job = take(false);
        own += job >= 100;
        end(job, MS);
    }
    assert_int_equal(own, 3);
    take_all();
}

/* A tenant with long jobs and a tenant with short jobs each get half of the time. At any time,
 * neither is ahead of the other by more than one job. */
static void tenants_share_time_equally(void **state)
{
    (void)state;
    uint64_t used[2] = {0};
    for (int i = 0; i < 100; i++) assert_true(push(i, "long", false));
    for (int i = 100; i < 200; i++) assert_true(push(i, "short", false));
    while (used[0] + used[1] < 500 * MS) {
        int job = take(false);
        used[job >= 100] += job >= 100 ? 5 * MS : 50 * MS;
        end(job, job >= 100 ? 5 * MS : 50 * MS);
    }
    assert_in_range(used[0], 200 * MS, 300 * MS);
    take_all();
}

static void idle_tenants_gain_no_credit(void **state)
{
    (void)state;
    for (int i = 0; i < 50; i++) assert_true(push(i, "early", false));
    for (int i = 0; i < 20; i++) end(take(false), 100 * MS);
    for (int i = 100; i < 150; i++) assert_true(push(i, "late", false));
    int late = 0;
    for (int i = 0; i < 20; i++) {
        int job = take(false);
        late += job >= 100;
        end(job, 100 * MS);
    }
    assert_in_range(late, 9, 11);
    take_all();
}

static void the_tenant_with_fewest_running_is_next(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) assert_true(push(i, "flood", false));
    int first = take(false), second = take(false);
    assert_true(push(100, "other", false));
    assert_int_equal(take(false), 100);
    end(first, MS);
    end(second, MS);
    end(100, 500 * MS);
    take_all();
}

static void urgent_jobs_go_first_but_patient_ones_do_not_starve(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) assert_true(push(i, "ann", true));
    for (int i = 100; i < 200; i++) assert_true(push(i, "ann", false));
    int before = 0, job;
    while ((job = take(false)) >= 100) {
        end(job, MS);
        before++;
    }
    end(job, MS);
    assert_in_range(before, 2, 99);
    take_all();
}

/* Whatever jobs one tenant sends, the queue keeps places free for other tenants, for jobs of both
 * kinds. */
static void a_tenant_leaves_places_free(void **state)
{
    (void)state;
    lanes.is_shared = true;
    for (int kind = 0; kind < SERVER_LANE_KINDS; kind++) {
        int at = 500 * kind, queued = 0;
        while (push(at + queued, "flood", kind)) queued++;
        assert_int_equal(queued, 128);
        for (int i = 0; i < 6; i++) {
            snprintf(names[i], sizeof names[i], "t%d", i);
            assert_true(push(at + 400 + i, names[i], kind));
        }
    }
    take_all();
}

static void a_single_tenant_has_all_places(void **state)
{
    (void)state;
    int queued = 0;
    while (push(queued, "", false)) queued++;
    assert_int_equal(queued, 256);
    assert_true(push(queued, "", true));
    take_all();
}

static void spare_workers_take_permitted_jobs_only(void **state)
{
    (void)state;
    for (int i = 0; i < 5; i++) assert_true(push(i, "flood", false));
    int first = take(false), second = take(false);
    assert_int_equal(take(true), -1);
    assert_true(push(100, "other", false));
    assert_true(push(101, "other", false));
    assert_int_equal(take(true), 100);
    assert_int_equal(take(true), -1);
    end(100, MS);
    assert_int_equal(take(true), 101);
    end(101, MS);
    end(first, MS);
    end(second, MS);
    take_all();
}

static void expired_jobs_are_removed_from_all_lanes(void **state)
{
    (void)state;
    int late = 0;
    for (int i = 0; i < 60; i++) {
        jobs[i].deadline_ns = i % 3 ? UINT64_MAX : 5;
        assert_true(push(i, i % 2 ? "ann" : "bob", i % 5 == 0));
    }
    for (struct server_job *job = server_lanes_expire(&lanes, 5); job; job = job->next) late++;
    assert_int_equal(late, 20);
    assert_int_equal(server_lanes_queued(&lanes), 40);
    assert_true(push(100, "ann", false));
    int left = 0;
    for (int job; (job = take(false)) >= 0; left++) end(job, MS);
    assert_int_equal(left, 41);
    assert_null(lanes.active);
}

/* --- lists of jobs ---------------------------------------------------------------------------- */

static void expire_takes_the_late_jobs(void **state)
{
    (void)state;
    static const uint64_t deadlines[] = {5, 50, 6, 60, 7};
    struct test_job some[5];
    struct server_job *list = NULL;
    for (int i = 4; i >= 0; i--) {
        test_job_init(&some[i], NULL);
        some[i].job.deadline_ns = deadlines[i];
        some[i].job.next = list;
        list = &some[i].job;
    }
    struct server_job *expired = server_jobs_expire(&list, 6);
    server_jobs_refuse(expired, SERVER_REFUSAL_DEADLINE);
    for (int i = 0; i < 5; i++) assert_int_equal(some[i].refusals, deadlines[i] <= 6);
    assert_ptr_equal(list, &some[1].job); /* the others stay, in their order */
    assert_ptr_equal(list->next, &some[3].job);
    assert_ptr_equal(list->next->next, &some[4].job);
    assert_null(list->next->next->next);
}

static void an_unwanted_job_is_late(void **state)
{
    (void)state;
    struct test_job some[2];
    for (int i = 0; i < 2; i++) test_job_init(&some[i], NULL);
    some[0].job.next = &some[1].job;
    some[1].job.next = NULL;
    struct server_job *list = &some[0].job;
    assert_null(server_jobs_expire(&list, 6));
    atomic_store(&some[0].job.is_unwanted, true);
    assert_ptr_equal(server_jobs_expire(&list, 6), &some[0].job);
    assert_ptr_equal(list, &some[1].job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(a_lane_keeps_the_order, set_up),
        cmocka_unit_test_setup(tenants_take_turns, set_up),
        cmocka_unit_test_setup(tenants_share_time_equally, set_up),
        cmocka_unit_test_setup(idle_tenants_gain_no_credit, set_up),
        cmocka_unit_test_setup(the_tenant_with_fewest_running_is_next, set_up),
        cmocka_unit_test_setup(urgent_jobs_go_first_but_patient_ones_do_not_starve, set_up),
        cmocka_unit_test_setup(a_tenant_leaves_places_free, set_up),
        cmocka_unit_test_setup(a_single_tenant_has_all_places, set_up),
        cmocka_unit_test_setup(spare_workers_take_permitted_jobs_only, set_up),
        cmocka_unit_test_setup(expired_jobs_are_removed_from_all_lanes, set_up),
        cmocka_unit_test(expire_takes_the_late_jobs),
        cmocka_unit_test(an_unwanted_job_is_late),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
