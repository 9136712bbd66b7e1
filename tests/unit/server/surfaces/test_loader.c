/* Tests simultaneous loads of one surface. */
#include "tests/unit/server/folder.h"

#include "server/surfaces/loader.h"

/* A store in which each fetch waits until the test sets its outcome. */
struct slow_store {
    struct server_store store; /* must be the first member */
    struct server_record *records[2];
    sem_t began, may_end;
    enum server_outcome outcome;
};

static enum server_outcome each(struct server_store *base,
                                bool (*visit)(void *user, const struct server_stored *stored),
                                void *user)
{
    struct slow_store *slow = (struct slow_store *)base;
    for (int i = 0; i < 2; i++) visit(user, &(struct server_stored){.record = slow->records[i]});
    return SERVER_STORE_DONE;
}

static enum server_outcome fetch(struct server_store *base, const struct server_object *object,
                                 void **bytes)
{
    struct slow_store *slow = (struct slow_store *)base;
    (void)object, (void)bytes;
    sem_post(&slow->began);
    sem_wait(&slow->may_end);
    return slow->outcome;
}

static void ignore_close(struct server_store *base)
{
    (void)base;
}

struct fixture {
    struct slow_store slow;
    struct server_budget budget;
    struct server_workers *workers;
    struct server_registry *registry;
    struct server_loader *loader;
    struct test_job job;
    pthread_t threads[2];
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    struct slow_store *slow = &fixture->slow;
    slow->store = (struct server_store){.each = each, .fetch = fetch, .close = ignore_close};
    slow->records[0] = new_record("a", "1");
    slow->records[1] = new_record("b", "2");
    slow->outcome = SERVER_STORE_UNAVAILABLE;
    sem_init(&slow->began, 0, 0);
    sem_init(&slow->may_end, 0, 0);
    server_budget_init(&fixture->budget, 1 << 20);
    fixture->workers = server_workers_create(1, 4);
    fixture->registry = server_registry_create(&slow->store, &fixture->budget);
    fixture->loader =
        server_loader_create(&(struct server_loader_parts){.budget = &fixture->budget,
                                                           .workers = fixture->workers,
                                                           .registry = fixture->registry,
                                                           .max_faces = 100});
    test_job_init(&fixture->job, NULL);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    server_loader_destroy(fixture->loader);
    server_registry_destroy(fixture->registry);
    server_workers_destroy(fixture->workers);
    for (int i = 0; i < 2; i++) server_record_release(fixture->slow.records[i]);
    assert_int_equal(fixture->budget.total, 0);
    free(fixture);
    return 0;
}

struct loading {
    struct fixture *fixture;
    struct server_record *record;
};

static void *load(void *user)
{
    struct loading *loading = user;
    struct server_surface *surface;
    struct proto_problem problem;
    server_loader_load(loading->fixture->loader, loading->record, NULL, &surface, &problem);
    free(loading);
    return NULL;
}

/* Makes a thread load a record, and waits until the thread fetches the bytes. */
static void begin_load(struct fixture *fixture, int i)
{
    struct loading *loading = malloc(sizeof *loading);
    *loading = (struct loading){fixture, fixture->slow.records[i]};
    assert_int_equal(pthread_create(&fixture->threads[i], NULL, load, loading), 0);
    sem_wait(&fixture->slow.began);
}

static void end_load(struct fixture *fixture, int i)
{
    sem_post(&fixture->slow.may_end);
    pthread_join(fixture->threads[i], NULL);
}

static bool join(struct fixture *fixture)
{
    return server_loader_join(fixture->loader, fixture->slow.records[0], &fixture->job.job);
}

static void a_second_job_waits_and_is_resumed(void **state)
{
    struct fixture *fixture = *state;
    struct server_surface *surface;
    struct proto_problem problem;
    begin_load(fixture, 0);
    assert_int_equal(server_loader_load(fixture->loader, fixture->slow.records[0],
                                        &fixture->job.job, &surface, &problem),
                     SERVER_LOADER_WAITING);
    end_load(fixture, 0);
    sem_wait(&fixture->job.done);
    assert_int_equal(fixture->job.runs, 1);
    assert_false(join(fixture));
}

static void other_surfaces_are_loaded_meanwhile(void **state)
{
    struct fixture *fixture = *state;
    begin_load(fixture, 0);
    begin_load(fixture, 1);
    sem_post(&fixture->slow.may_end);
    end_load(fixture, 0);
    pthread_join(fixture->threads[1], NULL);
    assert_int_equal(fixture->job.runs + fixture->job.refusals, 0);
}

static void short_memory_refuses_all_jobs(void **state)
{
    struct fixture *fixture = *state;
    begin_load(fixture, 0);
    assert_true(join(fixture));
    fixture->slow.outcome = SERVER_STORE_NO_MEMORY;
    end_load(fixture, 0);
    assert_int_equal(fixture->job.refusals, 1);
    assert_int_equal(fixture->job.why, SERVER_REFUSAL_MEMORY);
}

static void a_waiting_job_has_a_deadline(void **state)
{
    struct fixture *fixture = *state;
    begin_load(fixture, 0);
    fixture->job.job.deadline_ns = 100;
    assert_true(join(fixture));
    server_workers_expire(fixture->workers, 99);
    assert_int_equal(fixture->job.refusals, 0);
    server_workers_expire(fixture->workers, 100);
    assert_int_equal(fixture->job.refusals, 1);
    assert_int_equal(fixture->job.why, SERVER_REFUSAL_DEADLINE);
    end_load(fixture, 0);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_second_job_waits_and_is_resumed),
        TEST(other_surfaces_are_loaded_meanwhile),
        TEST(short_memory_refuses_all_jobs),
        TEST(a_waiting_job_has_a_deadline),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
