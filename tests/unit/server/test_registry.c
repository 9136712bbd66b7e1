#include "support.h"

#include <stdio.h>

#include "server/registry.h"

struct fixture {
    struct server_budget budget;
    struct server_workers *workers;
    struct server_cache *cache;
    struct server_store *store;
};

static const struct server_precondition none;

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    server_budget_init(&fixture->budget, (size_t)1 << 30);
    fixture->workers = server_workers_create(1, 1);
    fixture->cache = server_cache_create(&fixture->budget, fixture->workers);
    fixture->store = server_registry_create();
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    fixture->store->close(fixture->store);
    server_cache_destroy(fixture->cache);
    server_workers_destroy(fixture->workers);
    assert_int_equal(fixture->budget.total, 0);
    free(fixture);
    return 0;
}

static struct server_surface *new_surface(struct fixture *fixture, const char *name, const char *bytes)
{
    struct server_surface_origin origin = {0};
    struct gd_mesh *mesh = new_mesh();
    snprintf(origin.name, sizeof origin.name, "%s", name);
    server_sha256(bytes, strlen(bytes), origin.sha256);
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_mesh_memsize(mesh)));
    return server_surface_create(&origin, mesh, gd_mesh_memsize(mesh), &fixture->budget, fixture->cache);
}

static enum server_store_outcome put_if(struct fixture *fixture, const char *name, const char *bytes,
                                        struct server_precondition precondition)
{
    struct server_surface *surface = new_surface(fixture, name, bytes);
    enum server_store_outcome outcome =
        fixture->store->put(fixture->store, surface, bytes, strlen(bytes), &precondition);
    server_surface_release(surface);
    return outcome;
}

static enum server_store_outcome put(struct fixture *fixture, const char *name, const char *bytes)
{
    return put_if(fixture, name, bytes, none);
}

static void keeps_by_name(void **state)
{
    struct fixture *fixture = *state;
    assert_null(fixture->store->get(fixture->store, "a"));
    assert_int_equal(put(fixture, "a", "1"), SERVER_STORE_CREATED);
    assert_int_equal(put(fixture, "b", "1"), SERVER_STORE_CREATED);
    assert_int_equal(put(fixture, "a", "2"), SERVER_STORE_REPLACED);
    assert_int_equal(fixture->store->count(fixture->store), 2);
    struct server_surface *a = fixture->store->get(fixture->store, "a"), *b = fixture->store->get(fixture->store, "b");
    assert_string_equal(a->origin.name, "a");
    assert_string_not_equal(a->etag, b->etag);
    server_surface_release(a);
    server_surface_release(b);
    assert_int_equal(fixture->store->remove(fixture->store, "a", &none), SERVER_STORE_REMOVED);
    assert_int_equal(fixture->store->remove(fixture->store, "a", &none), SERVER_STORE_ABSENT);
    assert_null(fixture->store->get(fixture->store, "a"));
}

static void what_is_held_outlives_its_name(void **state)
{
    struct fixture *fixture = *state;
    put(fixture, "a", "1");
    struct server_surface *held = fixture->store->get(fixture->store, "a");
    put(fixture, "a", "2");
    fixture->store->remove(fixture->store, "a", &none);
    assert_int_equal(gd_mesh_summary(held->mesh)->faces, 320);
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_MESHES], held->bytes);
    server_surface_release(held);
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_MESHES], 0);
}

static void lists_in_order(void **state)
{
    struct fixture *fixture = *state;
    static const char *const names[] = {"m", "b", "z", "B", "bb", "-"};
    static const char *const sorted[] = {"-", "B", "b", "bb", "m", "z"};
    struct server_surface *listed[10];
    for (size_t i = 0; i < COUNT(names); i++) put(fixture, names[i], "1");
    assert_int_equal(fixture->store->list(fixture->store, NULL, 10, listed), 6);
    for (size_t i = 0; i < 6; i++) {
        assert_string_equal(listed[i]->origin.name, sorted[i]);
        server_surface_release(listed[i]);
    }
    assert_int_equal(fixture->store->list(fixture->store, "b", 2, listed), 2);
    assert_string_equal(listed[0]->origin.name, "bb");
    server_surface_release(listed[0]);
    server_surface_release(listed[1]);
    assert_int_equal(fixture->store->list(fixture->store, "c", 1, listed), 1); /* a name that is not there */
    assert_string_equal(listed[0]->origin.name, "m");
    server_surface_release(listed[0]);
    assert_int_equal(fixture->store->list(fixture->store, "z", 10, listed), 0);
}

static void preconditions_decide(void **state)
{
    struct fixture *fixture = *state;
    char right[SERVER_ETAG + 2];
    assert_int_equal(put_if(fixture, "a", "1", (struct server_precondition){.if_match = "*"}),
                     SERVER_STORE_PRECONDITION);
    assert_int_equal(put_if(fixture, "a", "1", (struct server_precondition){.if_none_match = "*"}),
                     SERVER_STORE_CREATED);
    assert_int_equal(put_if(fixture, "a", "2", (struct server_precondition){.if_none_match = "*"}),
                     SERVER_STORE_PRECONDITION);
    struct server_surface *a = fixture->store->get(fixture->store, "a");
    snprintf(right, sizeof right, "\"%s\"", a->etag);
    server_surface_release(a);
    const struct server_precondition wrong_tag = {.if_match = "\"x\""}, right_tag = {.if_match = right};
    assert_int_equal(fixture->store->remove(fixture->store, "a", &wrong_tag), SERVER_STORE_PRECONDITION);
    assert_int_equal(put_if(fixture, "a", "2", right_tag), SERVER_STORE_REPLACED);
    assert_int_equal(fixture->store->remove(fixture->store, "a", &right_tag),
                     SERVER_STORE_PRECONDITION); /* it is another one now */
    assert_int_equal(fixture->store->count(fixture->store), 1);
}

static void replacing_ends_the_fields(void **state)
{
    struct fixture *fixture = *state;
    put(fixture, "a", "1");
    struct server_surface *a = fixture->store->get(fixture->store, "a");
    struct gd_point source = vertex_point(a->mesh, 0);
    struct server_flight *flight;
    struct test_job job;
    test_job_init(&job, NULL);
    assert_int_equal(server_cache_enter(a->shelf, &source, NULL, &job.job, &flight), SERVER_CACHE_BUILD);
    struct gd_field *field = new_field(a->mesh, &source);
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field)));
    server_cache_unpin(server_cache_land(flight, field));
    assert_int_equal(server_shelf_count(a->shelf), 1);
    put(fixture, "a", "2");
    assert_int_equal(server_shelf_count(a->shelf), 0);
    assert_null(server_cache_find(a->shelf, &source));
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_FIELDS], 0);
    server_surface_release(a);
}

static void *put_and_remove(void *user)
{
    struct fixture *fixture = user;
    for (int step = 0; step < 60; step++) {
        char name[2] = {(char)('a' + step % 3), '\0'};
        struct server_surface *listed[3], *got = fixture->store->get(fixture->store, name);
        uint32_t count = fixture->store->list(fixture->store, NULL, 3, listed);
        if (step % 2)
            put(fixture, name, "1");
        else
            fixture->store->remove(fixture->store, name, &none);
        for (uint32_t i = 0; i < count; i++) server_surface_release(listed[i]);
        server_surface_release(got);
    }
    return NULL;
}

static void many_threads_at_once(void **state)
{
    pthread_t threads[4];
    for (int i = 0; i < 4; i++) pthread_create(&threads[i], NULL, put_and_remove, *state);
    for (int i = 0; i < 4; i++) pthread_join(threads[i], NULL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(keeps_by_name),        TEST(what_is_held_outlives_its_name), TEST(lists_in_order),
        TEST(preconditions_decide), TEST(replacing_ends_the_fields),      TEST(many_threads_at_once),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
