/* Tests the guarantees of every store that stores bytes. The back-ends are the local store in a
 * folder, and PostgreSQL if GEODESICD_TEST_STORE names a database. The tests empty this database.
 * tests/cluster/test_suites.py sets the variable. */
#include "tests/unit/server/folder.h"

#include "server/store/store.h"

struct fixture {
    char folder[FOLDER_PATH];
    const char *url; /* NULL if the store is a folder */
    struct server_store *store;
};

/* --- life ------------------------------------------------------------------------------------- */

static void open_store(struct fixture *fixture)
{
    char error[SERVER_ERROR] = "";
    fixture->store = fixture->url ? server_store_postgres_open(fixture->url, error)
                                  : server_store_local_open(fixture->folder, error);
    if (!fixture->store) fail_msg("%s", error);
}

static void tidy(struct server_store *store)
{
    if (store->tidy) store->tidy(store);
}

struct names {
    char text[512]; /* the text "key@version " for each surface */
    struct server_record *last;
    uint64_t version;
};

static bool on_stored(void *user, const struct server_stored *stored)
{
    struct names *names = user;
    size_t size = strlen(names->text);
    snprintf(names->text + size, sizeof names->text - size, "%s ", stored->record->key);
    server_record_release(names->last);
    names->last = server_record_retain(stored->record);
    names->version = stored->version;
    return true;
}

/* Removes the data of earlier tests. */
static void clear(struct fixture *fixture)
{
    for (;;) {
        struct names names = {.text = ""};
        open_store(fixture);
        assert_int_equal(fixture->store->each(fixture->store, on_stored, &names),
                         SERVER_STORE_DONE);
        if (names.last)
            assert_int_equal(fixture->store->remove(fixture->store, names.last, &names.version),
                             SERVER_STORE_DONE);
        tidy(fixture->store);
        fixture->store->close(fixture->store);
        server_record_release(names.last);
        if (!names.last) return;
    }
}

static int set_up(void **state, const char *url)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    folder_make(fixture->folder);
    fixture->url = url;
    if (url) clear(fixture);
    open_store(fixture);
    *state = fixture;
    return 0;
}

static int set_up_local(void **state)
{
    return set_up(state, NULL);
}

static int set_up_shared(void **state)
{
    const char *url = getenv("GEODESICD_TEST_STORE");
    *state = NULL;
    return url ? set_up(state, url) : 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    if (!fixture) return 0;
    fixture->store->close(fixture->store);
    folder_remove(fixture->folder);
    free(fixture);
    return 0;
}

/* --- helpers ---------------------------------------------------------------------------------- */

/* Stores a surface. `*version` is the known version of the surface's key. */
static enum server_outcome put(struct server_store *store, const struct server_record *record,
                               const char *bytes, const char *attachment, uint64_t *version)
{
    const struct server_content content = {
        .parts = {[SERVER_PART_FILE] = bytes, [SERVER_PART_ATTACHMENT] = attachment}};
    enum server_outcome outcome =
        store->stage ? store->stage(store, record, &content) : SERVER_STORE_DONE;
    if (!outcome) outcome = store->put(store, record, &content, version);
    if (!outcome) tidy(store);
    return outcome;
}

static void assert_part(struct server_store *store, const struct server_record *record,
                        enum server_part part, const char *bytes)
{
    void *found = NULL;
    assert_int_equal(store->fetch(store, &record->objects[part], &found), SERVER_STORE_DONE);
    assert_memory_equal(found, bytes, strlen(bytes));
    free(found);
}

static void assert_gone(struct server_store *store, const struct server_record *record)
{
    void *found = NULL;
    assert_int_equal(store->fetch(store, &record->objects[SERVER_PART_FILE], &found),
                     SERVER_STORE_ABSENT);
}

static void assert_holds(struct fixture *fixture, const char *expected)
{
    struct names names = {.text = ""};
    fixture->store->close(fixture->store);
    open_store(fixture);
    assert_int_equal(fixture->store->each(fixture->store, on_stored, &names), SERVER_STORE_DONE);
    server_record_release(names.last);
    assert_string_equal(names.text, expected);
}

static struct fixture *fixture_of(void **state)
{
    if (!*state) {
        print_message(
            "# skipped: tests/cluster/test_suites.py runs it with GEODESICD_TEST_STORE\n");
        skip();
    }
    return *state;
}

/* --- promises of every store ------------------------------------------------------------------ */

static void surfaces_survive_a_restart(void **state)
{
    struct fixture *fixture = fixture_of(state);
    struct server_record *record = new_record("a", "some bytes");
    uint64_t version = 0;
    assert_int_equal(put(fixture->store, record, "some bytes", NULL, &version), SERVER_STORE_DONE);
    assert_holds(fixture, "a ");
    assert_part(fixture->store, record, SERVER_PART_FILE, "some bytes");
    server_record_release(record);
}

static void an_attachment_lives_as_long_as_its_surface(void **state)
{
    struct fixture *fixture = fixture_of(state);
    struct server_record *record = new_record_of(mesh_key("a"), MESH_OPTIONS, "bytes", "attached");
    uint64_t version = 0;
    assert_int_equal(put(fixture->store, record, "bytes", "attached", &version), SERVER_STORE_DONE);
    assert_part(fixture->store, record, SERVER_PART_ATTACHMENT, "attached");
    assert_int_equal(fixture->store->remove(fixture->store, record, &version), SERVER_STORE_DONE);
    tidy(fixture->store);
    assert_gone(fixture->store, record);
    assert_holds(fixture, "");
    server_record_release(record);
}

static void replacing_deletes_the_old_objects(void **state)
{
    struct fixture *fixture = fixture_of(state);
    struct server_record *old = new_record("a", "old"), *new = new_record("a", "new");
    uint64_t version = 0;
    assert_int_equal(put(fixture->store, old, "old", NULL, &version), SERVER_STORE_DONE);
    assert_int_equal(put(fixture->store, new, "new", NULL, &version), SERVER_STORE_DONE);
    assert_part(fixture->store, new, SERVER_PART_FILE, "new");
    assert_gone(fixture->store, old);
    assert_holds(fixture, "a ");
    server_record_release(old);
    server_record_release(new);
}

static void objects_stay_while_a_surface_has_them(void **state)
{
    struct fixture *fixture = fixture_of(state);
    struct server_record *one = new_record("one", "same"), *two = new_record("two", "same");
    uint64_t version_one = 0, version_two = 0;
    assert_int_equal(put(fixture->store, one, "same", NULL, &version_one), SERVER_STORE_DONE);
    assert_int_equal(put(fixture->store, two, "same", NULL, &version_two), SERVER_STORE_DONE);
    assert_int_equal(fixture->store->remove(fixture->store, one, &version_one), SERVER_STORE_DONE);
    tidy(fixture->store);
    assert_part(fixture->store, two, SERVER_PART_FILE, "same");
    assert_holds(fixture, "two ");
    server_record_release(one);
    server_record_release(two);
}

static void tenants_and_kinds_have_their_own_names(void **state)
{
    struct fixture *fixture = fixture_of(state);
    struct server_record *records[] = {
        new_record("it", "bytes"),
        new_record_of((struct server_key){"ann", &server_kind_mesh, "it"}, MESH_OPTIONS, "bytes",
                      NULL),
        new_record_of((struct server_key){"", &server_kind_subdivision, "it"}, "format=obj",
                      "bytes", NULL)};
    uint64_t versions[COUNT(records)] = {0};
    for (size_t i = 0; i < COUNT(records); i++)
        assert_int_equal(put(fixture->store, records[i], "bytes", NULL, &versions[i]),
                         SERVER_STORE_DONE);
    assert_holds(fixture, "ann@it it subdivision+it ");
    assert_int_equal(fixture->store->remove(fixture->store, records[0], &versions[0]),
                     SERVER_STORE_DONE);
    tidy(fixture->store);
    assert_part(fixture->store, records[1], SERVER_PART_FILE, "bytes");
    for (size_t i = 0; i < COUNT(records); i++) server_record_release(records[i]);
}

static bool go_on(void *user, size_t bytes)
{
    *(size_t *)user += bytes;
    return true;
}

static void large_bytes_are_verified_piece_by_piece(void **state)
{
    struct fixture *fixture = fixture_of(state);
    size_t size = 3 * 1048576 + 17, looked = 0;
    char *bytes = malloc(size + 1);
    for (size_t i = 0; i < size; i++) bytes[i] = (char)('a' + i * i % 23);
    bytes[size] = '\0';
    struct server_record *record = new_record("large", bytes);
    uint64_t version = 0;
    assert_int_equal(put(fixture->store, record, bytes, NULL, &version), SERVER_STORE_DONE);
    assert_part(fixture->store, record, SERVER_PART_FILE, bytes);
    assert_int_equal(
        fixture->store->verify(fixture->store, &record->objects[SERVER_PART_FILE], go_on, &looked),
        SERVER_STORE_DONE);
    assert_int_equal(looked, size);
    server_record_release(record);
    free(bytes);
}

/* --- promises of a shared store --------------------------------------------------------------- */

static void a_change_of_an_old_version_is_stale(void **state)
{
    struct fixture *fixture = fixture_of(state);
    struct server_record *old = new_record("a", "old"), *new = new_record("a", "new");
    uint64_t none = 0, first = 0, wrong;
    assert_int_equal(put(fixture->store, old, "old", NULL, &first), SERVER_STORE_DONE);
    assert_true(first > 0);
    assert_int_equal(put(fixture->store, new, "new", NULL, &none), SERVER_STORE_STALE);
    wrong = first + 1;
    assert_int_equal(fixture->store->remove(fixture->store, old, &wrong), SERVER_STORE_STALE);
    uint64_t second = first;
    assert_int_equal(put(fixture->store, new, "new", NULL, &second), SERVER_STORE_DONE);
    assert_true(second > first);
    assert_part(fixture->store, new, SERVER_PART_FILE, "new");
    server_record_release(old);
    server_record_release(new);
}

struct changes {
    char text[256]; /* the text "+key " or "-key " for each change */
    uint64_t last;
};

static bool on_change(void *user, const struct server_stored *change)
{
    struct changes *changes = user;
    size_t size = strlen(changes->text);
    snprintf(changes->text + size, sizeof changes->text - size, "%c%s ", change->record ? '+' : '-',
             change->key);
    assert_true(change->version > changes->last);
    changes->last = change->version;
    return true;
}

static void other_daemons_follow_in_the_order_of_versions(void **state)
{
    struct fixture *fixture = fixture_of(state);
    char error[SERVER_ERROR];
    struct names names = {.text = ""};
    struct changes changes = {"", 0};
    struct server_store *other = server_store_postgres_open(fixture->url, error);
    assert_non_null(other);
    assert_int_equal(other->each(other, on_stored, &names), SERVER_STORE_DONE);
    assert_int_equal(other->follow(other, on_change, &changes), SERVER_STORE_DONE);
    assert_string_equal(changes.text, "");
    struct server_record *a = new_record("a", "1"), *b = new_record("b", "2"),
                         *c = new_record("c", "3");
    uint64_t version_a = 0, version_b = 0, version_c = 0;
    assert_int_equal(put(fixture->store, a, "1", NULL, &version_a), SERVER_STORE_DONE);
    assert_int_equal(put(fixture->store, b, "2", NULL, &version_b), SERVER_STORE_DONE);
    assert_int_equal(put(fixture->store, c, "3", NULL, &version_c), SERVER_STORE_DONE);
    assert_int_equal(fixture->store->remove(fixture->store, a, &version_a), SERVER_STORE_DONE);
    assert_int_equal(other->follow(other, on_change, &changes), SERVER_STORE_DONE);
    assert_string_equal(changes.text, "+b +c -a ");
    assert_int_equal(other->follow(other, on_change, &changes), SERVER_STORE_DONE);
    assert_string_equal(changes.text, "+b +c -a ");
    other->close(other);
    server_record_release(a);
    server_record_release(b);
    server_record_release(c);
}

static void a_database_that_does_not_answer_is_reported(void **state)
{
    char error[SERVER_ERROR] = "";
    (void)fixture_of(state);
    assert_null(server_store_postgres_open(
        "postgresql://nobody:secret@127.0.0.1:1/nothing?connect_timeout=1", error));
    assert_non_null(strstr(error, "can't be reached"));
    assert_null(strstr(error, "secret"));
}

#define SHARED(test) cmocka_unit_test_setup_teardown(test, set_up_shared, tear_down)
#define EACH(test)   cmocka_unit_test_setup_teardown(test, set_up_local, tear_down), SHARED(test)

int main(void)
{
    const struct CMUnitTest tests[] = {EACH(surfaces_survive_a_restart),
                                       EACH(an_attachment_lives_as_long_as_its_surface),
                                       EACH(replacing_deletes_the_old_objects),
                                       EACH(objects_stay_while_a_surface_has_them),
                                       EACH(tenants_and_kinds_have_their_own_names),
                                       EACH(large_bytes_are_verified_piece_by_piece),
                                       SHARED(a_change_of_an_old_version_is_stale),
                                       SHARED(other_daemons_follow_in_the_order_of_versions),
                                       SHARED(a_database_that_does_not_answer_is_reported)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
