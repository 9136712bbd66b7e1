/* Tests cached fields with equal seeds and different reaches: which field answers a request, which
 * request waits, and which field replaces another. */
#include "tests/unit/server/cached_fields.h"

#include <math.h>

static double reach_found(struct fixture *fixture, double radius)
{
    struct set set;
    const struct server_cached *cached =
        server_cache_find_field(fixture->fields, make_set(fixture, &set, 0, radius));
    double reach = cached ? gd_field_reach(cached->field) : 0;
    server_cache_unpin(cached);
    return reach;
}

static void land_radius(struct fixture *fixture, double radius)
{
    struct set set;
    make_set(fixture, &set, 0, radius);
    publish_set(fixture, claim(fixture, &set.request), &set.request);
}

static void the_field_of_largest_reach_answers_all(void **state)
{
    struct fixture *fixture = *state;
    land_radius(fixture, 0.5);
    assert_true(fabs(reach_found(fixture, 0.5) - 0.5) < 1e-15);
    assert_true(fabs(reach_found(fixture, 0.25) - 0.5) < 1e-15);
    assert_true(reach_found(fixture, 1) == 0);
    assert_true(reach_found(fixture, 0) == 0);
    land_radius(fixture, 1);
    assert_true(fabs(reach_found(fixture, 0.25) - 1) < 1e-15);
    assert_int_equal(server_mesh_cache_count(fixture->fields), 1);
    land_radius(fixture, 0);
    assert_true(isinf(reach_found(fixture, 0.25)));
    assert_true(isinf(reach_found(fixture, 0)));
    assert_int_equal(server_mesh_cache_count(fixture->fields), 1);
    assert_int_equal(server_cache_statistics(fixture->cache).fields, 1);
}

static void a_pinned_field_outlives_its_successor(void **state)
{
    struct fixture *fixture = *state;
    struct set set;
    land_radius(fixture, 0.5);
    const struct server_cached *near =
        server_cache_find_field(fixture->fields, make_set(fixture, &set, 0, 0.5));
    land_radius(fixture, 0);
    assert_true(fabs(gd_field_reach(near->field) - 0.5) < 1e-15);
    size_t held = fixture->budget.used[SERVER_BUDGET_FIELDS];
    size_t bytes = gd_field_memsize(near->field);
    server_cache_unpin(near);
    assert_true(held - fixture->budget.used[SERVER_BUDGET_FIELDS] >= bytes);
    reclaim(fixture, AMPLE);
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_FIELDS], 0);
}

/* A request waits for the pending build of its own reach; a request of a smaller or larger reach
 * does not. A field that is published late is dropped if the cached field reaches at least as
 * far. */
static void builds_of_the_same_seeds(void **state)
{
    struct fixture *fixture = *state;
    struct set near, middle, far;
    struct server_pending_build *build = claim(fixture, make_set(fixture, &middle, 0, 0.5)),
                                *none = NULL;
    struct test_job same;
    enum gd_status why;
    test_job_init(&same, NULL);
    make_set(fixture, &far, 0, 1);
    assert_int_equal(server_cache_claim(fixture->fields, &middle.request, &same.job, &none, &why),
                     SERVER_CACHE_WAIT);
    struct server_pending_build *short_flight = claim(fixture, make_set(fixture, &near, 0, 0.25)),
                                *long_flight = claim(fixture, &far.request);
    publish_set(fixture, build, &middle.request);
    sem_wait(&same.done);
    publish_set(fixture, short_flight, &near.request);
    assert_true(fabs(reach_found(fixture, 0.25) - 0.5) < 1e-15);
    assert_int_equal(server_mesh_cache_count(fixture->fields), 1);
    server_cache_fail(long_flight, GD_CANCELLED);
}

/* A failure for a radius also holds for larger radii, but not for smaller radii. */
static void failures_hold_for_larger_reaches(void **state)
{
    struct fixture *fixture = *state;
    struct set near, middle, far, whole;
    struct server_pending_build *none = NULL;
    struct test_job job;
    enum gd_status why = GD_OK;
    test_job_init(&job, NULL);
    make_set(fixture, &far, 0, 1);
    make_set(fixture, &whole, 0, 0);
    server_cache_fail(claim(fixture, make_set(fixture, &middle, 0, 0.5)), GD_BUDGET);
    assert_int_equal(server_cache_claim(fixture->fields, &far.request, &job.job, &none, &why),
                     SERVER_CACHE_SEARCH);
    assert_int_equal(why, GD_BUDGET);
    assert_int_equal(server_cache_claim(fixture->fields, &whole.request, &job.job, &none, &why),
                     SERVER_CACHE_SEARCH);
    publish_set(fixture, claim(fixture, make_set(fixture, &near, 0, 0.25)), &near.request);
}

static void drop_removes_exactly_this_reach(void **state)
{
    struct fixture *fixture = *state;
    struct set set;
    land_radius(fixture, 1);
    server_cache_drop(fixture->fields, make_set(fixture, &set, 0, 0.5));
    assert_true(reach_found(fixture, 0.5) > 0);
    server_cache_drop(fixture->fields, make_set(fixture, &set, 0, 1));
    assert_true(reach_found(fixture, 0.5) == 0);
}

/* A field with a radius does not reset the count of queries for pairs. */
static void a_near_field_keeps_the_count_of_queries(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 3);
    struct set set;
    struct server_pending_build *build = NULL;
    struct test_job job;
    test_job_init(&job, NULL);
    ask_often(fixture->fields, &source);
    make_set(fixture, &set, 0, 0.5)->seed_count = 1;
    publish_set(fixture, claim(fixture, &set.request), &set.request);
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_BUILD);
    server_cache_fail(build, GD_CANCELLED);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(the_field_of_largest_reach_answers_all),
        TEST(a_pinned_field_outlives_its_successor),
        TEST(builds_of_the_same_seeds),
        TEST(failures_hold_for_larger_reaches),
        TEST(drop_removes_exactly_this_reach),
        TEST(a_near_field_keeps_the_count_of_queries),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
