#include "tests/unit/server/folder.h"

#include "server/store/local/local.h"

static uint64_t version; /* the version is always 0, because the store is not shared */

struct fixture {
    char folder[FOLDER_PATH];
    struct server_store *store;
};

static void open_store(struct fixture *fixture)
{
    char error[SERVER_ERROR] = "";
    fixture->store = server_store_local_open(fixture->folder, error);
    if (!fixture->store) fail_msg("%s", error);
}

static void close_store(struct fixture *fixture)
{
    if (fixture->store) fixture->store->close(fixture->store);
    fixture->store = NULL;
}

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof *fixture);
    char root[FOLDER_PATH];
    folder_make(root);
    assert_true(snprintf(fixture->folder, sizeof fixture->folder, "%.200s/some/where", root) > 0);
    open_store(fixture);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    close_store(fixture);
    fixture->folder[strlen(fixture->folder) - strlen("/some/where")] = '\0';
    folder_remove(fixture->folder);
    free(fixture);
    return 0;
}

static struct server_content content_of(const char *bytes, const char *attachment)
{
    return (struct server_content){
        .parts = {[SERVER_PART_FILE] = bytes, [SERVER_PART_ATTACHMENT] = attachment}};
}

/* Stores a surface with any key, and its attachment if it has one. */
static enum server_outcome put_of(struct fixture *fixture, struct server_key key, const char *bytes,
                                  const char *attachment)
{
    struct server_record *record = new_record_of(key, MESH_OPTIONS, bytes, attachment);
    const struct server_content content = content_of(bytes, attachment);
    enum server_outcome outcome = fixture->store->put(fixture->store, record, &content, &version);
    if (!outcome) fixture->store->tidy(fixture->store);
    server_record_release(record);
    return outcome;
}

static enum server_outcome put(struct fixture *fixture, const char *name, const char *bytes)
{
    return put_of(fixture, mesh_key(name), bytes, NULL);
}

static enum server_outcome drop_of(struct fixture *fixture, struct server_key key,
                                   const char *bytes, const char *attachment)
{
    struct server_record *record = new_record_of(key, MESH_OPTIONS, bytes, attachment);
    enum server_outcome outcome = fixture->store->remove(fixture->store, record, &version);
    if (!outcome) fixture->store->tidy(fixture->store);
    server_record_release(record);
    return outcome;
}

static enum server_outcome drop(struct fixture *fixture, const char *name, const char *bytes)
{
    return drop_of(fixture, mesh_key(name), bytes, NULL);
}

/* Fetches the object of the tenant with these bytes. */
static enum server_outcome fetch_of(struct fixture *fixture, const char *tenant,
                                    enum server_part part, const char *bytes)
{
    struct server_key key = mesh_key("any");
    key.tenant = tenant;
    struct server_record *record =
        new_record_of(key, MESH_OPTIONS, bytes, part == SERVER_PART_ATTACHMENT ? bytes : NULL);
    void *found = NULL;
    enum server_outcome outcome =
        fixture->store->fetch(fixture->store, &record->objects[part], &found);
    if (!outcome) assert_memory_equal(found, bytes, strlen(bytes));
    free(found);
    server_record_release(record);
    return outcome;
}

static enum server_outcome fetch(struct fixture *fixture, const char *bytes)
{
    return fetch_of(fixture, "", SERVER_PART_FILE, bytes);
}

struct listing {
    char text[256]; /* the text "key=uses " for each surface */
};

static bool on_record(void *user, const struct server_stored *stored)
{
    struct listing *listing = user;
    size_t size = strlen(listing->text);
    snprintf(listing->text + size, sizeof listing->text - size, "%s=%d ", stored->record->key,
             (int)stored->uses.count);
    return true;
}

/* Reopens the store and asserts its contents. */
static void assert_holds(struct fixture *fixture, const char *expected)
{
    struct listing listing = {""};
    close_store(fixture);
    open_store(fixture);
    fixture->store->each(fixture->store, on_record, &listing);
    assert_string_equal(listing.text, expected);
}

static void path_in(const struct fixture *fixture, char path[SERVER_DISK_PATH], const char *name)
{
    snprintf(path, SERVER_DISK_PATH, "%s/%s", fixture->folder, name);
}

static void object_path(const struct fixture *fixture, char path[SERVER_DISK_PATH],
                        const char *bytes)
{
    char sha256[SERVER_SHA256_HEX];
    server_sha256(bytes, strlen(bytes), sha256);
    snprintf(path, SERVER_DISK_PATH, "%s/objects/%.2s/%s", fixture->folder, sha256, sha256);
}

static void write_over(const char *path, const char *text)
{
    FILE *file = fopen(path, "r+e");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* Damages a file of the folder. */
static void spoil(const struct fixture *fixture, const char *name)
{
    char path[SERVER_DISK_PATH];
    path_in(fixture, path, name);
    write_over(path, "this is no database at all, nor a manifest, and never was one");
}

static void lose(const struct fixture *fixture, const char *name)
{
    char path[SERVER_DISK_PATH];
    path_in(fixture, path, name);
    assert_int_equal(remove(path), 0);
}

static void put_two_and_close(struct fixture *fixture)
{
    put(fixture, "a", "1");
    put(fixture, "b", "2");
    close_store(fixture);
}

static void lists_in_the_order_of_keys(void **state)
{
    struct fixture *fixture = *state;
    assert_holds(fixture, "");
    static const char *const names[] = {"m", "b", "z", "B", "bb", "-"};
    for (size_t i = 0; i < COUNT(names); i++)
        assert_int_equal(put(fixture, names[i], names[i]), SERVER_STORE_DONE);
    assert_int_equal(drop(fixture, "z", "z"), SERVER_STORE_DONE);
    assert_int_equal(put(fixture, "m", "other"), SERVER_STORE_DONE);
    assert_holds(fixture, "-=0 B=0 b=0 bb=0 m=0 ");
    assert_int_equal(fetch(fixture, "other"), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "bb"), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "z"), SERVER_STORE_ABSENT);
    assert_int_equal(fetch(fixture, "m"), SERVER_STORE_ABSENT);
}

static void surfaces_share_objects(void **state)
{
    struct fixture *fixture = *state;
    put(fixture, "a", "same");
    put(fixture, "b", "same");
    drop(fixture, "a", "same");
    assert_int_equal(fetch(fixture, "same"), SERVER_STORE_DONE);
    put(fixture, "b", "other");
    assert_int_equal(fetch(fixture, "same"), SERVER_STORE_ABSENT);
}

/* A request that found a surface before its removal can still fetch its bytes until the removal is
 * published. */
static void objects_are_deleted_by_tidy(void **state)
{
    struct fixture *fixture = *state;
    struct server_record *two = new_record("a", "2");
    put(fixture, "a", "1");
    const struct server_content content = content_of("2", NULL);
    assert_int_equal(fixture->store->put(fixture->store, two, &content, &version),
                     SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "1"), SERVER_STORE_DONE);
    fixture->store->tidy(fixture->store);
    assert_int_equal(fetch(fixture, "1"), SERVER_STORE_ABSENT);
    assert_int_equal(fixture->store->remove(fixture->store, two, &version), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "2"), SERVER_STORE_DONE);
    fixture->store->tidy(fixture->store);
    assert_int_equal(fetch(fixture, "2"), SERVER_STORE_ABSENT);
    server_record_release(two);
}

static void remembers_uses(void **state)
{
    struct fixture *fixture = *state;
    struct server_record *a = new_record("a", "1"), *b = new_record("b", "2");
    const struct server_record *records[] = {a, b};
    const struct server_store_uses uses[] = {{3, 100}, {70, 200}};
    put(fixture, "a", "1");
    put(fixture, "b", "2");
    fixture->store->note_uses(fixture->store, records, uses, 2);
    assert_holds(fixture, "a=3 b=70 ");
    server_record_release(a);
    server_record_release(b);
}

static void damaged_objects_are_found_and_replaced(void **state)
{
    struct fixture *fixture = *state;
    char path[SERVER_DISK_PATH];
    struct server_record *record = new_record("a", "some bytes");
    put(fixture, "a", "some bytes");
    object_path(fixture, path, "some bytes");
    write_over(path, "x");
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DAMAGED);
    const struct server_content content = content_of("some bytes", NULL);
    assert_int_equal(fixture->store->keep(fixture->store, record, &content), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DONE);
    assert_int_equal(truncate(path, 3), 0);
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DAMAGED);
    assert_int_equal(put(fixture, "b", "some bytes"), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DONE);
    server_record_release(record);
}

/* --- verification ----------------------------------------------------------------------------- */

struct pacing {
    /* `bytes` counts the bytes read so far; the visit ends after `most` bytes */
    size_t bytes, most;
    struct fixture *fixture; /* the store that rewrites `written` during the visit, or NULL */
    struct server_record *written;
};

static bool on_piece(void *user, size_t bytes)
{
    struct pacing *pacing = user;
    pacing->bytes += bytes;
    if (pacing->fixture) {
        const struct server_content content = content_of("some bytes", NULL);
        assert_int_equal(
            pacing->fixture->store->keep(pacing->fixture->store, pacing->written, &content),
            SERVER_STORE_DONE);
    }
    return pacing->bytes <= pacing->most;
}

static enum server_outcome verify(struct fixture *fixture, const char *bytes, struct pacing pacing)
{
    struct server_record *record = new_record("a", bytes);
    enum server_outcome outcome = fixture->store->verify(
        fixture->store, &record->objects[SERVER_PART_FILE], on_piece, &pacing);
    server_record_release(record);
    return outcome;
}

static void objects_in_quarantine_are_not_read(void **state)
{
    struct fixture *fixture = *state;
    const struct pacing all = {.most = SIZE_MAX};
    char path[SERVER_DISK_PATH];
    put(fixture, "a", "some bytes");
    object_path(fixture, path, "some bytes");
    assert_int_equal(verify(fixture, "some bytes", all), SERVER_STORE_DONE);
    assert_int_equal(verify(fixture, "others", all), SERVER_STORE_ABSENT);
    assert_int_equal(verify(fixture, "some bytes", (struct pacing){.most = 0}),
                     SERVER_STORE_UNAVAILABLE);
    write_over(path, "x");
    assert_int_equal(verify(fixture, "some bytes", all), SERVER_STORE_DAMAGED);
    assert_int_equal(fixture->store->damaged(fixture->store), 1);
    write_over(path, "s"); /* repairs the file, but not by the store */
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DAMAGED);
    assert_int_equal(verify(fixture, "some bytes", all), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DONE);
    assert_int_equal(truncate(path, 3), 0);
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DAMAGED);
    assert_int_equal(fixture->store->damaged(fixture->store), 1);
    drop(fixture, "a", "some bytes");
    assert_int_equal(fixture->store->damaged(fixture->store), 0);
}

static void objects_rewritten_meanwhile_stay_out_of_quarantine(void **state)
{
    struct fixture *fixture = *state;
    struct pacing pacing = {
        .most = SIZE_MAX, .fixture = fixture, .written = new_record("a", "some bytes")};
    char path[SERVER_DISK_PATH];
    put(fixture, "a", "some bytes");
    object_path(fixture, path, "some bytes");
    write_over(path, "x");
    assert_int_equal(verify(fixture, "some bytes", pacing), SERVER_STORE_UNAVAILABLE);
    assert_int_equal(fixture->store->damaged(fixture->store), 0);
    assert_int_equal(fetch(fixture, "some bytes"), SERVER_STORE_DONE);
    server_record_release(pacing.written);
}

static void only_one_process_uses_a_folder(void **state)
{
    struct fixture *fixture = *state;
    char error[SERVER_ERROR] = "";
    assert_null(server_store_local_open(fixture->folder, error));
    assert_non_null(strstr(error, "in use by another geodesicd"));
    assert_null(server_store_local_open("/dev/null/data", error));
    assert_non_null(strstr(error, "/dev/null/data"));
}

static void a_damaged_database_is_made_again(void **state)
{
    struct fixture *fixture = *state;
    put_two_and_close(fixture);
    spoil(fixture, "geodesicd.db");
    assert_holds(fixture, "a=0 b=0 ");
    assert_null(fixture->store->health(fixture->store));
    assert_int_equal(put(fixture, "c", "3"), SERVER_STORE_DONE);
    close_store(fixture);
    lose(fixture, "geodesicd.db");
    assert_holds(fixture, "a=0 b=0 c=0 ");
}

static void count_aside(void *user, const char *path, const char *name)
{
    int *count = user;
    (void)path;
    *count += strstr(name, SERVER_DISK_ASIDE) && !strstr(name, "-wal") && !strstr(name, "-shm");
}

static void damaged_files_are_kept_under_another_name(void **state)
{
    struct fixture *fixture = *state;
    char manifests[SERVER_DISK_PATH];
    int databases = 0, damaged = 0;
    path_in(fixture, manifests, "manifests");
    put_two_and_close(fixture);
    for (int i = 0; i < 3; i++) {
        spoil(fixture, "geodesicd.db");
        assert_holds(fixture, "a=0 b=0 ");
        close_store(fixture);
        spoil(fixture, "manifests/a.manifest");
        assert_holds(fixture, "a=0 b=0 ");
        close_store(fixture);
    }
    assert_true(folder_each(fixture->folder, count_aside, &databases));
    assert_true(folder_each(manifests, count_aside, &damaged));
    assert_int_equal(databases, 3);
    assert_int_equal(damaged, 3);
}

static void a_manifest_is_made_again_from_its_row(void **state)
{
    struct fixture *fixture = *state;
    put_two_and_close(fixture);
    spoil(fixture, "manifests/a.manifest");
    lose(fixture, "manifests/b.manifest");
    assert_holds(fixture, "a=0 b=0 ");
    close_store(fixture);
    lose(fixture, "geodesicd.db");
    assert_holds(fixture, "a=0 b=0 ");
}

static void only_a_surface_without_row_and_manifest_is_lost(void **state)
{
    struct fixture *fixture = *state;
    put_two_and_close(fixture);
    spoil(fixture, "manifests/a.manifest");
    lose(fixture, "geodesicd.db");
    assert_holds(fixture, "b=0 ");
    assert_int_equal(fetch(fixture, "1"), SERVER_STORE_DONE); /* the object's bytes are kept */
    assert_holds(fixture, "b=0 ");
}

/* --- tenants and attachments ------------------------------------------------------------------ */

static void each_tenant_has_its_own_names(void **state)
{
    struct fixture *fixture = *state;
    const struct server_key acme = {.tenant = "acme", .kind = &server_kind_mesh, .name = "a"};
    assert_int_equal(put(fixture, "a", "1"), SERVER_STORE_DONE);
    assert_int_equal(put_of(fixture, acme, "1", NULL), SERVER_STORE_DONE);
    assert_holds(fixture, "a=0 acme@a=0 ");
    assert_int_equal(drop(fixture, "a", "1"), SERVER_STORE_DONE);
    /* tenants do not share objects of equal bytes */
    assert_int_equal(fetch(fixture, "1"), SERVER_STORE_ABSENT);
    assert_int_equal(fetch_of(fixture, "acme", SERVER_PART_FILE, "1"), SERVER_STORE_DONE);
    close_store(fixture);
    lose(fixture, "geodesicd.db");
    assert_holds(fixture, "acme@a=0 ");
    assert_int_equal(fetch_of(fixture, "acme", SERVER_PART_FILE, "1"), SERVER_STORE_DONE);
    close_store(fixture);
    lose(fixture, "manifests/acme@a.manifest");
    assert_holds(fixture, "acme@a=0 ");
}

static void an_attachment_lives_as_long_as_its_surface(void **state)
{
    struct fixture *fixture = *state;
    const struct server_key key = mesh_key("a");
    assert_int_equal(put_of(fixture, key, "file", "attachment"), SERVER_STORE_DONE);
    assert_int_equal(put_of(fixture, mesh_key("b"), "other", "attachment"), SERVER_STORE_DONE);
    /* stores a file with the bytes of an attachment */
    assert_int_equal(put(fixture, "c", "attachment"), SERVER_STORE_DONE);
    assert_holds(fixture, "a=0 b=0 c=0 ");
    assert_int_equal(fetch_of(fixture, "", SERVER_PART_ATTACHMENT, "attachment"),
                     SERVER_STORE_DONE);
    /* without the attachment the file is another surface */
    assert_int_equal(put(fixture, "a", "file"), SERVER_STORE_DONE);
    assert_int_equal(drop(fixture, "c", "attachment"), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "attachment"), SERVER_STORE_DONE); /* used by b */
    assert_int_equal(drop_of(fixture, mesh_key("b"), "other", "attachment"), SERVER_STORE_DONE);
    assert_int_equal(fetch(fixture, "attachment"), SERVER_STORE_ABSENT);
    assert_int_equal(fetch(fixture, "other"), SERVER_STORE_ABSENT);
    assert_int_equal(fetch(fixture, "file"), SERVER_STORE_DONE);
}

static void a_damaged_attachment_is_found_and_replaced(void **state)
{
    struct fixture *fixture = *state;
    char path[SERVER_DISK_PATH];
    struct server_record *record = new_record_of(mesh_key("a"), MESH_OPTIONS, "file", "attachment");
    const struct server_content content = content_of("file", "attachment");
    put_of(fixture, mesh_key("a"), "file", "attachment");
    object_path(fixture, path, "attachment");
    write_over(path, "x");
    assert_int_equal(fetch_of(fixture, "", SERVER_PART_ATTACHMENT, "attachment"),
                     SERVER_STORE_DAMAGED);
    assert_int_equal(fixture->store->keep(fixture->store, record, &content), SERVER_STORE_DONE);
    assert_int_equal(fetch_of(fixture, "", SERVER_PART_ATTACHMENT, "attachment"),
                     SERVER_STORE_DONE);
    server_record_release(record);
}

static void unused_objects_are_deleted(void **state)
{
    struct fixture *fixture = *state;
    char from[SERVER_DISK_PATH], to[SERVER_DISK_PATH];
    put(fixture, "a", "1");
    object_path(fixture, from, "1");
    snprintf(to, sizeof to, "%.*s%062d", (int)(strrchr(from, '/') + 3 - from), from, 0);
    assert_int_equal(link(from, to), 0);
    path_in(fixture, from, "temporary/77");
    assert_int_equal(link(to, from), 0);
    assert_holds(fixture, "a=0 ");
    assert_int_not_equal(access(to, F_OK), 0);
    assert_int_not_equal(access(from, F_OK), 0);
    assert_int_equal(fetch(fixture, "1"), SERVER_STORE_DONE);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(lists_in_the_order_of_keys),
        TEST(surfaces_share_objects),
        TEST(objects_are_deleted_by_tidy),
        TEST(remembers_uses),
        TEST(damaged_objects_are_found_and_replaced),
        TEST(objects_in_quarantine_are_not_read),
        TEST(objects_rewritten_meanwhile_stay_out_of_quarantine),
        TEST(only_one_process_uses_a_folder),
        TEST(a_damaged_database_is_made_again),
        TEST(damaged_files_are_kept_under_another_name),
        TEST(a_manifest_is_made_again_from_its_row),
        TEST(only_a_surface_without_row_and_manifest_is_lost),
        TEST(each_tenant_has_its_own_names),
        TEST(an_attachment_lives_as_long_as_its_surface),
        TEST(a_damaged_attachment_is_found_and_replaced),
        TEST(unused_objects_are_deleted),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
