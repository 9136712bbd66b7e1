#include "tests/unit/server/records.h"

#include <stdio.h>

#include "server/surfaces/registry.h"

struct fixture {
    struct server_budget budget;
    struct server_workers *workers;
    struct server_cache *cache;
    struct server_registry *registry;
};

static const struct server_precondition none;

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    server_budget_init(&fixture->budget, (size_t)1 << 30);
    fixture->workers = server_workers_create(1, 1);
    fixture->cache = server_cache_create(&fixture->budget, fixture->workers);
    fixture->registry = server_registry_create(server_store_memory_create(), &fixture->budget);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    server_registry_destroy(fixture->registry);
    server_cache_destroy(fixture->cache);
    server_workers_destroy(fixture->workers);
    assert_int_equal(fixture->budget.total, 0);
    free(fixture);
    return 0;
}

static struct server_surface *new_surface(struct fixture *fixture, const char *name,
                                          const char *bytes)
{
    struct gd_mesh *mesh = new_mesh();
    struct server_record *record = new_record(name, bytes);
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_mesh_memsize(mesh)));
    struct server_surface *surface = server_surface_create(record, mesh, gd_mesh_memsize(mesh),
                                                           &fixture->budget, fixture->cache);
    server_record_release(record);
    return surface;
}

static bool find(struct fixture *fixture, const char *name, struct server_listed *out)
{
    const struct server_key key = mesh_key(name);
    return server_registry_find(fixture->registry, &key, out);
}

static enum server_outcome drop_if(struct fixture *fixture, const char *name,
                                   const struct server_precondition *precondition)
{
    const struct server_key key = mesh_key(name);
    return server_registry_remove(fixture->registry, &key, precondition);
}

static enum server_outcome drop(struct fixture *fixture, const char *name)
{
    return drop_if(fixture, name, &none);
}

/* Lists meshes with names after `after`. */
static uint32_t list(struct fixture *fixture, const char *after, uint32_t most,
                     struct server_listed *out)
{
    const struct server_key key = mesh_key(after);
    return server_registry_list(fixture->registry, &key, NULL, most, out);
}

/* Returns a reference to the surface of that name if it is in memory, or NULL. */
static struct server_surface *get(struct fixture *fixture, const char *name)
{
    struct server_listed listed;
    if (!find(fixture, name, &listed)) return NULL;
    server_record_release(listed.record);
    return listed.surface;
}

static uint32_t count(struct fixture *fixture)
{
    return (uint32_t)server_registry_statistics(fixture->registry).surfaces;
}

static enum server_outcome put_if(struct fixture *fixture, const char *name, const char *bytes,
                                  struct server_precondition precondition)
{
    struct server_surface *surface = new_surface(fixture, name, bytes);
    enum server_outcome outcome =
        server_registry_put(fixture->registry, surface, bytes, &precondition);
    server_surface_release(surface);
    return outcome;
}

static enum server_outcome put(struct fixture *fixture, const char *name, const char *bytes)
{
    return put_if(fixture, name, bytes, none);
}

static void finds_surfaces_by_name(void **state)
{
    struct fixture *fixture = *state;
    assert_null(get(fixture, "a"));
    assert_int_equal(put(fixture, "a", "1"), SERVER_STORE_CREATED);
    assert_int_equal(put(fixture, "b", "1"), SERVER_STORE_CREATED);
    assert_int_equal(put(fixture, "a", "2"), SERVER_STORE_REPLACED);
    assert_int_equal(count(fixture), 2);
    struct server_surface *a = get(fixture, "a"), *b = get(fixture, "b");
    assert_string_equal(a->record->name, "a");
    assert_string_not_equal(a->record->etag, b->record->etag);
    server_surface_release(a);
    server_surface_release(b);
    assert_int_equal(drop(fixture, "a"), SERVER_STORE_DONE);
    assert_int_equal(drop(fixture, "a"), SERVER_STORE_ABSENT);
    assert_null(get(fixture, "a"));
}

static void a_retained_surface_outlives_its_name(void **state)
{
    struct fixture *fixture = *state;
    put(fixture, "a", "1");
    struct server_surface *held = get(fixture, "a");
    put(fixture, "a", "2");
    drop(fixture, "a");
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
    struct server_listed listed[10];
    for (size_t i = 0; i < COUNT(names); i++) put(fixture, names[i], "1");
    assert_int_equal(list(fixture, NULL, 10, listed), 6);
    for (size_t i = 0; i < 6; i++) {
        assert_string_equal(listed[i].record->name, sorted[i]);
        server_listed_release(&listed[i]);
    }
    assert_int_equal(list(fixture, "b", 2, listed), 2);
    assert_string_equal(listed[0].record->name, "bb");
    server_listed_release(&listed[0]);
    server_listed_release(&listed[1]);
    assert_int_equal(list(fixture, "c", 1, listed), 1); /* a name that does not exist */
    assert_string_equal(listed[0].record->name, "m");
    server_listed_release(&listed[0]);
    assert_int_equal(list(fixture, "z", 10, listed), 0);
}

static void lists_by_prefix(void **state)
{
    struct fixture *fixture = *state;
    static const char *const names[] = {"a", "b", "ba", "bb", "c"};
    static const struct {
        const char *after, *prefix;
        uint32_t most, count;
        const char *first;
    } cases[] = {
        {NULL, "b", 10, 3, "b"}, {NULL, "b", 2, 2, "b"},    {"a", "b", 10, 3, "b"},
        {"b", "b", 10, 2, "ba"}, {"ba", "b", 10, 1, "bb"},  {"bb", "b", 10, 0, NULL},
        {"c", "b", 10, 0, NULL}, {NULL, "bc", 10, 0, NULL}, {NULL, "", 10, 5, "a"},
    };
    struct server_listed listed[10];
    for (size_t i = 0; i < COUNT(names); i++) put(fixture, names[i], "1");
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct server_key key = mesh_key(cases[i].after);
        uint32_t count =
            server_registry_list(fixture->registry, &key, cases[i].prefix, cases[i].most, listed);
        assert_int_equal(count, cases[i].count);
        if (count) assert_string_equal(listed[0].record->name, cases[i].first);
        while (count) server_listed_release(&listed[--count]);
    }
}

static void writes_obey_preconditions(void **state)
{
    struct fixture *fixture = *state;
    char right[SERVER_ETAG + 2];
    assert_int_equal(put_if(fixture, "a", "1", (struct server_precondition){.if_match = {"*"}}),
                     SERVER_STORE_PRECONDITION);
    assert_int_equal(
        put_if(fixture, "a", "1", (struct server_precondition){.if_none_match = {"*"}}),
        SERVER_STORE_CREATED);
    assert_int_equal(
        put_if(fixture, "a", "2", (struct server_precondition){.if_none_match = {"*"}}),
        SERVER_STORE_PRECONDITION);
    struct server_surface *a = get(fixture, "a");
    snprintf(right, sizeof right, "\"%s\"", a->record->etag);
    server_surface_release(a);
    const struct server_precondition wrong_tag = {.if_match = {"\"x\""}},
                                     right_tag = {.if_match = {right}};
    assert_int_equal(drop_if(fixture, "a", &wrong_tag), SERVER_STORE_PRECONDITION);
    assert_int_equal(put_if(fixture, "a", "2", right_tag), SERVER_STORE_REPLACED);
    /* the name has another surface now */
    assert_int_equal(drop_if(fixture, "a", &right_tag), SERVER_STORE_PRECONDITION);
    assert_int_equal(count(fixture), 1);
}

static void replacing_ends_the_fields(void **state)
{
    struct fixture *fixture = *state;
    put(fixture, "a", "1");
    struct server_surface *a = get(fixture, "a");
    struct gd_point source = vertex_point(a->mesh, 0);
    struct server_pending_build *build;
    struct test_job job;
    test_job_init(&job, NULL);
    ask_often(a->fields, &source);
    assert_int_equal(server_cache_enter(a->fields, &source, &job.job, &build), SERVER_CACHE_BUILD);
    struct gd_field *field = new_field(a->mesh, &source);
    assert_true(
        server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_field_memsize(field)));
    server_cache_unpin(server_cache_publish(build, field));
    assert_int_equal(server_mesh_cache_count(a->fields), 1);
    put(fixture, "a", "2");
    assert_int_equal(server_mesh_cache_count(a->fields), 0);
    assert_null(server_cache_find(a->fields, &source));
    assert_int_equal(fixture->budget.used[SERVER_BUDGET_FIELDS], 0);
    server_surface_release(a);
}

static void note_gone(void *user, const struct server_record *record)
{
    char *names = user;
    strcat(names, record->name);
}

static void the_watcher_is_called_with_the_last_name(void **state)
{
    struct fixture *fixture = *state;
    char names[16] = "";
    server_registry_watch(fixture->registry, note_gone, names);
    put(fixture, "a", "1");
    put(fixture, "b", "1");
    put(fixture, "c", "2");
    put(fixture, "a", "1");
    put(fixture, "a", "2"); /* "b" still has this ETag */
    assert_string_equal(names, "");
    put(fixture, "b", "2");
    assert_string_equal(names, "b");
    assert_int_equal(drop(fixture, "a"), SERVER_STORE_DONE);
    assert_int_equal(drop(fixture, "b"), SERVER_STORE_DONE);
    assert_string_equal(names, "b");
    assert_int_equal(drop(fixture, "c"), SERVER_STORE_DONE);
    assert_string_equal(names, "bc");
}

/* --- with a store that has a `fetch` function ------------------------------------------------- */

static enum server_outcome answer; /* outcome of the next writes */

static enum server_outcome answer_put(struct server_store *store,
                                      const struct server_record *record,
                                      const struct server_content *content, uint64_t *version)
{
    (void)store, (void)record, (void)content, (void)version;
    return answer;
}

static enum server_outcome answer_keep(struct server_store *store,
                                       const struct server_record *record,
                                       const struct server_content *content)
{
    (void)store, (void)record, (void)content;
    return answer;
}

static enum server_outcome answer_remove(struct server_store *store,
                                         const struct server_record *record, uint64_t *version)
{
    (void)store, (void)record, (void)version;
    return answer;
}

static enum server_outcome give_back(struct server_store *store, const struct server_object *object,
                                     void **bytes)
{
    (void)store, (void)object, (void)bytes;
    return SERVER_STORE_ABSENT; /* not called */
}

static int set_up_stored(void **state)
{
    set_up(state);
    struct fixture *fixture = *state;
    struct server_store *store = server_store_memory_create();
    server_registry_destroy(fixture->registry);
    store->put = answer_put;
    store->keep = answer_keep;
    store->remove = answer_remove;
    store->fetch = give_back;
    answer = SERVER_STORE_DONE;
    fixture->registry = server_registry_create(store, &fixture->budget);
    return 0;
}

static bool is_loaded(struct fixture *fixture, const char *name)
{
    struct server_surface *surface = get(fixture, name);
    server_surface_release(surface);
    return surface != NULL;
}

static void a_refusal_of_the_store_changes_nothing(void **state)
{
    static const enum server_outcome refusals[] = {SERVER_STORE_FULL, SERVER_STORE_READ_ONLY,
                                                   SERVER_STORE_REFUSED, SERVER_STORE_NO_MEMORY};
    struct fixture *fixture = *state;
    put(fixture, "a", "1");
    struct server_surface *before = get(fixture, "a");
    for (size_t i = 0; i < COUNT(refusals); i++) {
        answer = refusals[i];
        assert_int_equal(put(fixture, "a", "2"), refusals[i]);
        assert_int_equal(put(fixture, "b", "2"), refusals[i]);
        assert_int_equal(drop(fixture, "a"), refusals[i]);
    }
    struct server_surface *after = get(fixture, "a");
    assert_ptr_equal(before, after);
    assert_int_equal(count(fixture), 1);
    server_surface_release(before);
    server_surface_release(after);
}

static void unused_surfaces_are_unloaded_least_recently_used_first(void **state)
{
    struct fixture *fixture = *state;
    struct server_surface *used;
    put(fixture, "a", "1");
    put(fixture, "b", "1");
    put(fixture, "c", "1");
    const struct server_key key = mesh_key("a");
    assert_true(server_registry_use(fixture->registry, &key, &used));
    server_surface_release(used);
    struct server_surface *held = get(fixture, "b");
    size_t bytes = held->bytes;
    fixture->budget.limit = fixture->budget.total;
    /* everything except the mesh in use */
    assert_int_equal(server_budget_available(&fixture->budget), 2 * bytes);
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, bytes));
    assert_true(is_loaded(fixture, "a"));
    assert_false(is_loaded(fixture, "c"));
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, bytes));
    assert_false(is_loaded(fixture, "a"));
    assert_false(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, 1));
    assert_true(is_loaded(fixture, "b"));
    assert_int_equal(count(fixture), 3);
    server_surface_release(held);
    server_budget_give(&fixture->budget, SERVER_BUDGET_FLIGHT, 2 * bytes);
}

static void the_same_record_again_is_kept_in_memory(void **state)
{
    struct fixture *fixture = *state;
    struct server_listed listed;
    struct gd_mesh *mesh = new_mesh();
    put(fixture, "a", "1");
    fixture->budget.limit = fixture->budget.total;
    assert_true(server_budget_take(&fixture->budget, SERVER_BUDGET_FLIGHT, gd_mesh_memsize(mesh)));
    assert_true(find(fixture, "a", &listed));
    assert_null(listed.surface);
    struct server_surface *again = server_surface_create(listed.record, mesh, gd_mesh_memsize(mesh),
                                                         &fixture->budget, fixture->cache);
    assert_int_equal(server_registry_put(fixture->registry, again, "1", &none),
                     SERVER_STORE_REPLACED);
    assert_true(is_loaded(fixture, "a"));
    assert_int_equal(server_registry_statistics(fixture->registry).loads, 1);
    server_surface_release(again);
    server_listed_release(&listed);
}

static struct fixture *tidied; /* the fixture that look_while_tidying uses */
/* the ETag of "a" at that time, or an empty text if "a" did not exist */
static char seen[SERVER_ETAG];
static unsigned tidy_count;

static void look_while_tidying(struct server_store *store)
{
    struct server_listed listed;
    (void)store;
    seen[0] = '\0';
    tidy_count++;
    if (!find(tidied, "a", &listed)) return;
    strcpy(seen, listed.record->etag);
    server_listed_release(&listed);
}

/* The order matters, because no client may get a surface whose bytes are about to be deleted. */
static void the_store_tidies_after_the_slots_change(void **state)
{
    struct fixture *fixture = *state;
    char before[SERVER_ETAG];
    struct server_store *store = server_store_memory_create();
    store->tidy = look_while_tidying;
    server_registry_destroy(fixture->registry);
    fixture->registry = server_registry_create(store, &fixture->budget);
    tidied = fixture;
    put(fixture, "a", "1");
    strcpy(before, seen);
    put(fixture, "a", "2");
    assert_true(before[0] && seen[0]);
    assert_string_not_equal(seen, before);
    assert_int_equal(drop(fixture, "a"), SERVER_STORE_DONE);
    assert_string_equal(seen, "");
    assert_int_equal(tidy_count, 3);
    assert_int_equal(drop(fixture, "a"), SERVER_STORE_ABSENT);
    assert_int_equal(tidy_count, 3);
}

static void stored_surfaces_are_confirmed(void **state)
{
    struct fixture *fixture = *state;
    struct server_listed before;
    put(fixture, "a", "1");
    assert_true(find(fixture, "a", &before));
    assert_int_equal(server_registry_put(fixture->registry, before.surface, "1", NULL),
                     SERVER_STORE_REPLACED);
    answer = SERVER_STORE_FULL;
    assert_int_equal(server_registry_put(fixture->registry, before.surface, "1", NULL),
                     SERVER_STORE_FULL);
    answer = SERVER_STORE_DONE;
    put(fixture, "a", "2");
    assert_int_equal(server_registry_put(fixture->registry, before.surface, "1", NULL),
                     SERVER_STORE_ABSENT);
    server_listed_release(&before);
}

static void *put_and_remove(void *user)
{
    struct fixture *fixture = user;
    for (int step = 0; step < 60; step++) {
        char name[2] = {(char)('a' + step % 3), '\0'};
        struct server_listed listed[3];
        struct server_surface *got = get(fixture, name);
        uint32_t found = list(fixture, NULL, 3, listed);
        if (step % 2)
            put(fixture, name, "1");
        else
            drop(fixture, name);
        for (uint32_t i = 0; i < found; i++) server_listed_release(&listed[i]);
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
#define TEST(name)   cmocka_unit_test_setup_teardown(name, set_up, tear_down)
#define STORED(name) cmocka_unit_test_setup_teardown(name, set_up_stored, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(finds_surfaces_by_name),
        TEST(a_retained_surface_outlives_its_name),
        TEST(lists_in_order),
        TEST(lists_by_prefix),
        TEST(writes_obey_preconditions),
        TEST(replacing_ends_the_fields),
        TEST(the_watcher_is_called_with_the_last_name),
        TEST(the_store_tidies_after_the_slots_change),
        TEST(many_threads_at_once),
        STORED(a_refusal_of_the_store_changes_nothing),
        STORED(unused_surfaces_are_unloaded_least_recently_used_first),
        STORED(the_same_record_again_is_kept_in_memory),
        STORED(stored_surfaces_are_confirmed),
    };
#undef STORED
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
