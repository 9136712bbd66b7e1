#include "tests/unit/server/support.h"

#include <stdio.h>

#include "proto/json/decode.h"
#include "server/surfaces/catalogue.h"

static struct gd_mesh *mesh;
static struct server_budget budget;
static struct server_catalogue *catalogue;

static int set_up(void **state)
{
    (void)state;
    mesh = new_mesh();
    server_budget_init(&budget, (size_t)1 << 30);
    catalogue = server_catalogue_create();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    server_catalogue_destroy(catalogue);
    gd_mesh_release(mesh);
    assert_int_equal(budget.total, 0); /* all counted bytes were returned to the budget */
    return 0;
}

static struct proto_located_set *new_set(const char *members)
{
    char text[1024];
    struct proto_set set;
    struct proto_problem problem;
    snprintf(text, sizeof text, "{\"points\":[%s]}", members);
    json_t *document = proto_decode_document(text, strlen(text), &problem);
    assert_true(document && proto_set_decode(document, "", &set, &problem));
    struct proto_located_set *located;
    assert_int_equal(proto_set_locate(mesh, &set, NULL, &located, &problem), GD_OK);
    proto_set_free(&set);
    json_decref(document);
    return located;
}

/* Adds a field with that id for a key. Returns whether the field is new. */
static bool add_for(const char *key, const char *id)
{
    const struct proto_field_description description = {.wedges = 7, .max_distance = 0.5};
    struct server_resource *resource =
        server_resource_create(id, new_set("{\"vertex\":1}"), &description, &budget);
    assert_non_null(resource);
    bool is_new = server_catalogue_add(catalogue, key, &resource);
    assert_string_equal(resource->id, id);
    assert_string_equal(resource->description.id, id);
    server_resource_release(resource);
    return is_new;
}

static bool add(const char *id)
{
    return add_for("", id);
}

static enum server_catalogue_finding find(const char *id)
{
    struct server_resource *resource;
    enum server_catalogue_finding finding = server_catalogue_find(catalogue, id, &resource);
    if (finding == SERVER_CATALOGUE_FOUND) server_resource_release(resource);
    return finding;
}

static void resources_are_found_until_they_are_removed(void **state)
{
    (void)state;
    struct server_resource *resource;
    assert_int_equal(find("b"), SERVER_CATALOGUE_ABSENT);
    assert_true(add("b"));
    assert_false(add("b"));
    assert_int_equal(server_catalogue_find(catalogue, "b", &resource), SERVER_CATALOGUE_FOUND);
    struct gd_field_request request = server_resource_request(resource);
    assert_true(request.seed_count == 1 && request.radius == 0.5 && !request.target);
    server_resource_release(server_catalogue_remove(catalogue, "b"));
    assert_null(server_catalogue_remove(catalogue, "b"));
    assert_int_equal(find("b"), SERVER_CATALOGUE_ABSENT);
    assert_int_equal(resource->description.wedges, 7); /* a reference keeps the resource */
    server_resource_release(resource);
    assert_int_equal(budget.total, 0);
}

static void lists_in_order(void **state)
{
    (void)state;
    static const char *const ids[] = {"m", "a", "z", "c"};
    struct server_resource *page[4];
    for (size_t i = 0; i < COUNT(ids); i++) assert_true(add(ids[i]));
    assert_int_equal(server_catalogue_list(catalogue, NULL, 2, page), 2);
    assert_string_equal(page[0]->id, "a");
    assert_string_equal(page[1]->id, "c");
    assert_int_equal(server_catalogue_list(catalogue, "c", 2, page + 2), 2);
    assert_string_equal(page[2]->id, "m");
    assert_string_equal(page[3]->id, "z");
    for (int i = 0; i < 4; i++) server_resource_release(page[i]);
    /* a page can begin after a removed resource */
    assert_int_equal(server_catalogue_list(catalogue, "d", 1, page), 1);
    assert_string_equal(page[0]->id, "m");
    server_resource_release(page[0]);
}

static void the_least_recently_used_is_forgotten(void **state)
{
    (void)state;
    char id[PROTO_FIELD_ID + 1];
    for (int i = 0; i < SERVER_CATALOGUE_RESOURCES; i++) {
        snprintf(id, sizeof id, "%08d", i);
        assert_true(add(id));
    }
    assert_int_equal(find("00000000"), SERVER_CATALOGUE_FOUND);
    assert_true(add("new"));
    assert_int_equal(find("00000000"), SERVER_CATALOGUE_FOUND);
    assert_int_equal(find("00000001"), SERVER_CATALOGUE_FORGOT);
    assert_true(add("00000001"));
    assert_int_equal(find("00000001"), SERVER_CATALOGUE_FOUND);
    assert_int_equal(find("00000002"), SERVER_CATALOGUE_FORGOT);
    server_resource_release(server_catalogue_remove(catalogue, "00000001"));
    /* the field was removed, and not forgotten for lack of room */
    assert_int_equal(find("00000001"), SERVER_CATALOGUE_ABSENT);
}

static void a_full_list_of_a_key_removes_resources_of_this_key_only(void **state)
{
    (void)state;
    char id[PROTO_FIELD_ID + 1];
    assert_true(add_for("ann", "first"));
    for (int i = 0; i < SERVER_CATALOGUE_RESOURCES + 10; i++) {
        snprintf(id, sizeof id, "%08d", i);
        assert_true(add_for("bob", id));
    }
    assert_int_equal(find("first"), SERVER_CATALOGUE_FOUND);
    assert_int_equal(find("00000009"), SERVER_CATALOGUE_FORGOT);
    assert_int_equal(find("00000010"), SERVER_CATALOGUE_FOUND);
    assert_false(add_for("bob", "first"));
    assert_true(add_for("ann", "second"));
    assert_int_equal(find("00000011"), SERVER_CATALOGUE_FOUND);
}

static void without_memory_there_is_no_resource(void **state)
{
    (void)state;
    const struct proto_field_description description = {.wedges = 7};
    struct proto_located_set *set = new_set("{\"vertex\":1}");
    budget.limit = 16;
    assert_null(server_resource_create("a", set, &description, &budget));
    free(set);
}

static void ids_of_different_fields_differ(void **state)
{
    (void)state;
    static const char *const sets[] = {
        "{\"vertex\":1}",
        "{\"vertex\":2}",
        "{\"vertex\":1,\"offset\":1}",
        "{\"vertex\":1,\"label\":\"\"}",
        "{\"vertex\":1,\"label\":\"a\"}",
        "{\"vertex\":1},{\"vertex\":2}",
        "{\"vertex\":2},{\"vertex\":1}",
        "{\"vertex\":1,\"label\":\"a\"},{\"vertex\":2,\"label\":\"b\"}",
        "{\"vertex\":1,\"label\":\"ab\"},{\"vertex\":2,\"label\":\"\"}",
    };
    char ids[2 * COUNT(sets) + 1][PROTO_FIELD_ID + 1], again[PROTO_FIELD_ID + 1];
    for (size_t i = 0; i < COUNT(sets); i++) {
        struct proto_located_set *set = new_set(sets[i]), *other = new_set(sets[i]);
        assert_true(server_resource_name("0123456789abcdef", set, 0, ids[2 * i]));
        assert_true(server_resource_name("0123456789abcdef", set, 1, ids[2 * i + 1]));
        assert_true(server_resource_name("0123456789abcdef", other, 0, again));
        assert_string_equal(ids[2 * i], again);
        assert_int_equal(strspn(again, "0123456789abcdef"), PROTO_FIELD_ID);
        if (i == 0)
            assert_true(server_resource_name("0123456789abcdee", set, 0, ids[2 * COUNT(sets)]));
        free(set);
        free(other);
    }
    for (size_t i = 0; i < COUNT(ids); i++)
        for (size_t j = 0; j < i; j++) assert_string_not_equal(ids[i], ids[j]);
}

static void *add_and_remove(void *user)
{
    uint32_t seed = (uint32_t)(uintptr_t)user;
    char id[PROTO_FIELD_ID + 1];
    struct server_resource *page[16];
    for (int i = 0; i < 2000; i++) {
        seed = seed * 1664525 + 1013904223;
        snprintf(id, sizeof id, "%u", seed >> 8 & 31);
        if (seed >> 20 & 1) add(id);
        if (seed >> 21 & 1) find(id);
        if (seed >> 22 & 1) server_resource_release(server_catalogue_remove(catalogue, id));
        for (uint32_t count = server_catalogue_list(catalogue, id, 16, page); count; count--)
            server_resource_release(page[count - 1]);
    }
    return NULL;
}

static void many_threads_at_once(void **state)
{
    (void)state;
    pthread_t threads[4];
    for (uintptr_t i = 0; i < 4; i++)
        pthread_create(&threads[i], NULL, add_and_remove, (void *)(i + 1));
    for (int i = 0; i < 4; i++) pthread_join(threads[i], NULL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(resources_are_found_until_they_are_removed),
        TEST(lists_in_order),
        TEST(the_least_recently_used_is_forgotten),
        TEST(a_full_list_of_a_key_removes_resources_of_this_key_only),
        TEST(without_memory_there_is_no_resource),
        TEST(ids_of_different_fields_differ),
        TEST(many_threads_at_once),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
