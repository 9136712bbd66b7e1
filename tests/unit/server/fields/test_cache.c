#include "tests/unit/server/cached_fields.h"

#include <math.h>

static struct server_pending_build *enter(struct fixture *fixture, uint32_t vertex)
{
    struct gd_point source = vertex_point(fixture->mesh, vertex);
    struct server_pending_build *build = NULL;
    struct test_job job;
    test_job_init(&job, NULL);
    ask_often(fixture->fields, &source);
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_BUILD);
    return build;
}

/* Builds and publishes the field of a vertex. Returns the field pinned. */
static const struct server_cached *land(struct fixture *fixture, struct server_pending_build *build,
                                        uint32_t vertex)
{
    struct gd_point source = vertex_point(fixture->mesh, vertex);
    struct gd_field *field = new_field(fixture->mesh, &source);
    assert_true(
        server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field)));
    const struct server_cached *cached = server_cache_publish(build, field);
    assert_non_null(cached);
    return cached;
}

static void add(struct fixture *fixture, uint32_t vertex)
{
    server_cache_unpin(land(fixture, enter(fixture, vertex), vertex));
}

/* A build time in nanoseconds. A test can't reduce the priority of a field, so this time exceeds
 * the build times of all other fields. */
#define DEAR 1e15

/* Adds a field with a fixed build time, since real times vary. */
static void add_dear(struct fixture *fixture, uint32_t vertex)
{
    const struct server_cached *cached = land(fixture, enter(fixture, vertex), vertex);
    ((struct server_cached *)cached)->cost = DEAR;
    server_cache_unpin(cached);
    /* this use gives the field the priority of an expensive field */
    server_cache_unpin(find(fixture, vertex));
}

static void finds_published_fields(void **state)
{
    struct fixture *fixture = *state;
    for (uint32_t vertex = 0; vertex < 40; vertex++) {
        assert_false(has(fixture, vertex));
        add(fixture, vertex);
    }
    for (uint32_t vertex = 0; vertex < 40; vertex++) {
        struct gd_point source = vertex_point(fixture->mesh, vertex);
        const struct server_cached *cached = find(fixture, vertex);
        double distance = 1;
        assert_int_equal(gd_field_distance(cached->field, &source, &distance), GD_OK);
        assert_true(distance == 0);
        server_cache_unpin(cached);
    }
    assert_int_equal(server_mesh_cache_count(fixture->fields), 40);
    assert_int_equal(server_cache_statistics(fixture->cache).hits, 40);
    assert_int_equal(server_cache_statistics(fixture->cache).misses, 40);
}

static void mesh_caches_do_not_share_fields(void **state)
{
    struct fixture *fixture = *state;
    struct server_mesh_cache *other = server_mesh_cache_open(fixture->cache);
    struct gd_point source = vertex_point(fixture->mesh, 3);
    add(fixture, 3);
    assert_null(server_cache_find(other, &source));
    server_mesh_cache_close(other);
    server_mesh_cache_release(other);
    assert_true(has(fixture, 3));
}

static void one_job_builds_and_the_others_wait(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct server_pending_build *build = enter(fixture, 7), *none = NULL;
    struct test_job waiting[3];
    assert_false(server_cache_is_awaited(build));
    for (int i = 0; i < 3; i++) {
        test_job_init(&waiting[i], NULL);
        assert_int_equal(server_cache_enter(fixture->fields, &source, &waiting[i].job, &none),
                         SERVER_CACHE_WAIT);
    }
    assert_true(server_cache_is_awaited(build));
    assert_null(find(fixture, 7));
    server_cache_unpin(land(fixture, build, 7));
    for (int i = 0; i < 3; i++) {
        sem_wait(&waiting[i].done);
        assert_int_equal(waiting[i].runs, 1);
    }
    assert_int_equal(server_cache_statistics(fixture->cache).builds, 1);
    assert_int_equal(server_cache_statistics(fixture->cache).waits, 3);
}

static void a_field_is_built_after_enough_queries(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct server_pending_build *build = NULL;
    struct test_job job;
    test_job_init(&job, NULL);
    for (int i = 0; i < SERVER_CACHE_SEARCHES; i++) {
        assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                         SERVER_CACHE_SEARCH);
        server_cache_note(fixture->fields, &source);
    }
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_BUILD);
    server_cache_fail(build, GD_CANCELLED);
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_BUILD);
    server_cache_unpin(land(fixture, build, 7));
    reclaim(fixture, AMPLE); /* the count of queries begins again after an eviction */
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_SEARCH);
    assert_int_equal(server_cache_statistics(fixture->cache).builds, 2);
}

/* Returns the number of queries of vertex 7 that use a search before a query builds the field. */
static int count_searches(struct fixture *fixture, struct server_pending_build **build)
{
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct test_job job;
    test_job_init(&job, NULL);
    for (int count = 0;; count++) {
        enum server_cache_turn turn = server_cache_enter(fixture->fields, &source, &job.job, build);
        if (turn == SERVER_CACHE_BUILD) return count;
        assert_int_equal(turn, SERVER_CACHE_SEARCH);
        server_cache_note(fixture->fields, &source);
    }
}

static void an_abandoned_build_doubles_the_searches(void **state)
{
    struct fixture *fixture = *state;
    struct server_pending_build *build = NULL;
    for (int expected = SERVER_CACHE_SEARCHES; expected <= 8 * SERVER_CACHE_SEARCHES;
         expected *= 2) {
        assert_int_equal(count_searches(fixture, &build), expected);
        server_cache_abandon(build);
    }
    assert_int_equal(count_searches(fixture, &build), 16 * SERVER_CACHE_SEARCHES);
    server_cache_unpin(land(fixture, build, 7));
    reclaim(fixture, AMPLE);
    assert_int_equal(count_searches(fixture, &build), SERVER_CACHE_SEARCHES);
    server_cache_fail(build, GD_BUDGET);
    assert_int_equal(count_searches(fixture, &build), 2 * SERVER_CACHE_SEARCHES);
    server_cache_fail(build, GD_CANCELLED);
    assert_int_equal(count_searches(fixture, &build), 0);
    server_cache_fail(build, GD_CANCELLED);
}

static void a_field_published_meanwhile_is_found(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct server_pending_build *build = NULL;
    struct test_job job;
    test_job_init(&job, NULL);
    add(fixture, 7);
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_AGAIN);
    assert_null(build);
}

/* Calls server_cache_enter for a request that must wait for the pending build. */
static void wait_for(struct fixture *fixture, const struct gd_point *source, struct test_job *job)
{
    struct server_pending_build *none = NULL;
    assert_int_equal(server_cache_enter(fixture->fields, source, &job->job, &none),
                     SERVER_CACHE_WAIT);
}

static void jobs_retry_after_a_cancelled_build(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct server_pending_build *build = enter(fixture, 7);
    struct test_job job;
    test_job_init(&job, NULL);
    wait_for(fixture, &source, &job);
    server_cache_fail(build, GD_CANCELLED);
    sem_wait(&job.done);
    assert_int_equal(job.runs, 1);
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_BUILD);
    server_cache_unpin(land(fixture, build, 7));
}

static void jobs_search_after_a_failed_build(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct server_pending_build *build = enter(fixture, 7);
    struct test_job job;
    test_job_init(&job, NULL);
    wait_for(fixture, &source, &job);
    server_cache_fail(build, GD_INTERNAL);
    sem_wait(&job.done);
    assert_int_equal(job.runs, 1);
    assert_int_equal(server_cache_enter(fixture->fields, &source, &job.job, &build),
                     SERVER_CACHE_SEARCH);
}

static void waiting_jobs_have_deadlines(void **state)
{
    struct fixture *fixture = *state;
    struct gd_point source = vertex_point(fixture->mesh, 7);
    struct server_pending_build *build = enter(fixture, 7);
    struct test_job early, late;
    test_job_init(&early, NULL);
    test_job_init(&late, NULL);
    early.job.deadline_ns = 1000;
    wait_for(fixture, &source, &late);
    wait_for(fixture, &source, &early);
    server_workers_expire(fixture->workers, 1000);
    assert_int_equal(early.refusals, 1);
    assert_int_equal(early.why, SERVER_REFUSAL_DEADLINE);
    assert_true(server_cache_is_awaited(build));
    server_cache_fail(build, GD_CANCELLED);
    sem_wait(&late.done);
    assert_int_equal(late.runs, 1);
}

static void closing_removes_fields_but_keeps_pins(void **state)
{
    struct fixture *fixture = *state;
    add(fixture, 1);
    add(fixture, 2);
    const struct server_cached *pinned = find(fixture, 1);
    struct server_pending_build *build = enter(fixture, 3);
    server_mesh_cache_close(fixture->fields);
    assert_false(has(fixture, 1));
    assert_int_equal(server_mesh_cache_count(fixture->fields), 0);
    assert_in_range(fixture->budget.used[SERVER_BUDGET_FIELDS], gd_field_memsize(pinned->field),
                    gd_field_memsize(pinned->field) + 512);
    /* the field is published, and freed with its last pin */
    server_cache_unpin(land(fixture, build, 3));
    assert_false(has(fixture, 3));
    server_cache_unpin(pinned);
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_FIELDS], 0);
}

/* Shrinks the budget to the bytes held now, so that one more byte must be reclaimed. */
static void fill_up(struct fixture *fixture)
{
    fixture->budget.limit = fixture->budget.total;
}

static void evicts_the_least_used_field(void **state)
{
    struct fixture *fixture = *state;
    for (uint32_t vertex = 0; vertex < 8; vertex++) add_dear(fixture, vertex);
    for (int use = 0; use < 20; use++)
        for (uint32_t vertex = 0; vertex < 8; vertex++)
            if (vertex != 5) assert_true(has(fixture, vertex));
    fill_up(fixture);
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, 1));
    server_budget_give(&fixture->budget, SERVER_BUDGET_FLIGHT, 1);
    assert_int_equal(server_cache_statistics(fixture->cache).evictions, 1);
    assert_false(has(fixture, 5));
}

static void evicts_fields_used_long_ago(void **state)
{
    struct fixture *fixture = *state;
    add_dear(fixture, 0);
    for (int use = 0; use < 20; use++) assert_true(has(fixture, 0));
    for (uint32_t vertex = 1; vertex < 160; vertex++) {
        add_dear(fixture, vertex);
        fill_up(fixture); /* the budget has room for one field only */
        assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, 1));
        server_budget_give(&fixture->budget, SERVER_BUDGET_FLIGHT, 1);
        fixture->budget.limit = AMPLE;
    }
    assert_int_equal(server_mesh_cache_count(fixture->fields), 1);
    assert_false(has(fixture, 0));
}

static void pinned_fields_are_not_evicted(void **state)
{
    struct fixture *fixture = *state;
    add(fixture, 0);
    add(fixture, 1);
    const struct server_cached *pinned = find(fixture, 0);
    size_t bytes = fixture->budget.total;
    fill_up(fixture);
    assert_false(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, bytes));
    assert_true(has(fixture, 0));
    assert_false(has(fixture, 1));
    server_cache_unpin(pinned);
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, bytes));
    server_budget_give(&fixture->budget, SERVER_BUDGET_FLIGHT, bytes);
    assert_false(has(fixture, 0));
}

/* --- fields of sets --------------------------------------------------------------------------- */

static void fields_of_different_sets_differ(void **state)
{
    struct fixture *fixture = *state;
    struct set plain, moved, turned;
    make_set(fixture, &plain, 0, 0);
    make_set(fixture, &moved, 0.5, 0);
    make_set(fixture, &turned, 0, 0);
    turned.seeds[0] = plain.seeds[1];
    turned.seeds[1] = plain.seeds[0];
    struct set *const sets[] = {&plain, &moved, &turned};
    for (size_t i = 0; i < COUNT(sets); i++) {
        assert_false(has_set(fixture, &sets[i]->request));
        publish_set(fixture, claim(fixture, &sets[i]->request), &sets[i]->request);
        assert_true(has_set(fixture, &sets[i]->request));
    }
    assert_false(has(fixture, 3));
    assert_int_equal(server_mesh_cache_count(fixture->fields), 3);
    server_cache_drop(fixture->fields, &moved.request);
    server_cache_drop(fixture->fields, &moved.request);
    assert_false(has_set(fixture, &moved.request));
    assert_true(has_set(fixture, &plain.request));
}

static void pairs_share_the_field_of_a_single_point(void **state)
{
    struct fixture *fixture = *state;
    struct set set;
    uint32_t count;
    make_set(fixture, &set, 0, 0)->seed_count = 1;
    publish_set(fixture, claim(fixture, &set.request), &set.request);
    assert_true(has(fixture, 3));
    struct set near;
    make_set(fixture, &near, 0, 0.5)->seed_count = 1;
    near.seeds[0] = near.seeds[1];
    publish_set(fixture, claim(fixture, &near.request), &near.request);
    assert_true(has_set(fixture, &near.request));
    assert_false(has(fixture, 8)); /* pairs need the whole field */
    const struct server_cached **points = server_mesh_cache_pin_points(fixture->fields, &count);
    assert_int_equal(count, 1); /* the count does not include the incomplete field */
    assert_false(isfinite(gd_field_reach(points[0]->field)));
    server_cache_unpin(points[0]);
    free(points);
}

static void a_claim_after_a_failure_returns_its_error(void **state)
{
    struct fixture *fixture = *state;
    struct set set, other;
    struct server_pending_build *build = claim(fixture, make_set(fixture, &set, 0, 0)),
                                *none = NULL;
    struct test_job job;
    enum gd_status why = GD_OK;
    test_job_init(&job, NULL);
    assert_int_equal(server_cache_claim(fixture->fields, &set.request, &job.job, &none, &why),
                     SERVER_CACHE_WAIT);
    server_cache_fail(build, GD_BUDGET);
    sem_wait(&job.done);
    assert_int_equal(server_cache_claim(fixture->fields, &set.request, &job.job, &none, &why),
                     SERVER_CACHE_SEARCH);
    assert_int_equal(why, GD_BUDGET);
    build = claim(fixture, make_set(fixture, &other, 1, 0));
    /* the builder's own deadline has passed, so the next builder may succeed */
    server_cache_fail(build, GD_DEADLINE);
    publish_set(fixture, claim(fixture, &other.request), &other.request);
}

static void a_claim_without_a_job_does_not_wait(void **state)
{
    struct fixture *fixture = *state;
    struct set set;
    struct server_pending_build *build = claim(fixture, make_set(fixture, &set, 0, 0)),
                                *none = NULL;
    enum gd_status why = GD_OK;
    assert_int_equal(server_cache_claim(fixture->fields, &set.request, NULL, &none, &why),
                     SERVER_CACHE_SEARCH);
    assert_null(none);
    publish_set(fixture, build, &set.request);
    assert_int_equal(server_cache_claim(fixture->fields, &set.request, NULL, &none, &why),
                     SERVER_CACHE_AGAIN);
}

struct reader {
    struct fixture *fixture;
    uint32_t seed;
};

/* Queries random sources and builds missing fields. Reserves memory of the budget between
 * queries. */
static void *read_and_build(void *user)
{
    struct reader *reader = user;
    struct fixture *fixture = reader->fixture;
    for (int step = 0; step < 300; step++) {
        uint32_t vertex = (reader->seed = reader->seed * 1664525 + 1013904223) >> 8 & 15;
        struct gd_point source = vertex_point(fixture->mesh, vertex);
        const struct server_cached *cached = server_cache_find(fixture->fields, &source);
        struct server_pending_build *build = NULL;
        struct test_job job;
        test_job_init(&job, NULL);
        ask_often(fixture->fields, &source);
        switch (server_cache_enter(fixture->fields, &source, &job.job, &build)) {
        case SERVER_CACHE_BUILD:
            if (step % 3 == 0)
                server_cache_fail(build, step % 2 ? GD_CANCELLED : GD_INTERNAL);
            else
                server_cache_unpin(land(fixture, build, vertex));
            break;
        case SERVER_CACHE_WAIT:
            sem_wait(&job.done);
            break;
        case SERVER_CACHE_AGAIN:
        case SERVER_CACHE_SEARCH:
            break;
        }
        server_cache_unpin(cached);
        if (step % 50 == 0) reclaim(fixture, 1 << 16);
    }
    return NULL;
}

static void many_threads_at_once(void **state)
{
    struct reader readers[4];
    pthread_t threads[4];
    for (uint32_t i = 0; i < 4; i++) {
        readers[i] = (struct reader){*state, i};
        pthread_create(&threads[i], NULL, read_and_build, &readers[i]);
    }
    for (int i = 0; i < 4; i++) pthread_join(threads[i], NULL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(finds_published_fields),
        TEST(mesh_caches_do_not_share_fields),
        TEST(one_job_builds_and_the_others_wait),
        TEST(an_abandoned_build_doubles_the_searches),
        TEST(a_field_published_meanwhile_is_found),
        TEST(a_field_is_built_after_enough_queries),
        TEST(jobs_retry_after_a_cancelled_build),
        TEST(jobs_search_after_a_failed_build),
        TEST(waiting_jobs_have_deadlines),
        TEST(closing_removes_fields_but_keeps_pins),
        TEST(evicts_the_least_used_field),
        TEST(evicts_fields_used_long_ago),
        TEST(pinned_fields_are_not_evicted),
        TEST(fields_of_different_sets_differ),
        TEST(pairs_share_the_field_of_a_single_point),
        TEST(a_claim_after_a_failure_returns_its_error),
        TEST(a_claim_without_a_job_does_not_wait),
        TEST(many_threads_at_once),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
