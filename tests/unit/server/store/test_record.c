#include "tests/unit/server/records.h"

#include "proto/json/writer.h"
#include "server/surfaces/catalogue.h"

#include <malloc.h>
#include <stdio.h>

static bool has_no_memory; /* makes the replaced strndup fail */

char *strndup(const char *text, size_t size)
{
    char *copy = has_no_memory ? NULL : malloc(size + 1);
    if (!copy) return NULL;
    copy[size] = '\0';
    return memcpy(copy, text, size);
}

static void a_record_is_read_as_written(void **state)
{
    (void)state;
    const struct server_key key = {.tenant = "acme", .kind = &server_kind_mesh, .name = "bunny.1"};
    struct server_record *record =
                             new_record_of(key, "format=obj&triangulate=false", "v 0 0 0\n", "uv"),
                         *again;
    size_t size;
    char *text = server_record_write(record, &size);
    assert_int_equal(strlen(text), size);
    assert_int_equal(server_record_read(NULL, text, size, &again), SERVER_RECORD_READ);
    assert_string_equal(again->tenant, "acme");
    assert_ptr_equal(again->kind, &server_kind_mesh);
    assert_string_equal(again->name, "bunny.1");
    assert_string_equal(again->key, "acme@bunny.1");
    assert_string_equal(again->etag, record->etag);
    assert_string_equal(again->attachment_sha256, record->attachment_sha256);
    assert_int_equal(again->attachment_size, 2);
    assert_string_equal(again->sha256, record->sha256);
    assert_int_equal(again->size, 8);
    assert_int_equal(again->memory, 1234);
    assert_int_equal(again->created, record->created);
    assert_string_equal(again->options, "format=obj&triangulate=false");
    assert_string_equal(again->description, record->description);
    server_record_release(again);
    server_record_release(record);
    free(text);
}

/* Parses the options of an upload from a query string, makes a record with these options, and reads
 * the options back from the record. */
static void options_are_read_as_written(void **state)
{
    (void)state;
    static const struct {
        const char *asked, *kept;
    } options[] = {
        {"format=ply", "format=ply&triangulate=true"},
        {"repair=split&format=stl", "format=stl&triangulate=true&repair=split"},
        {"weld=0&repair=none&format=off", "format=off&triangulate=true&weld=0"},
        {"triangulate=false&format=json&weld=0.1",
         "format=json&triangulate=false&weld=0.10000000000000001"},
        {"weld=1e-300&repair=split&format=obj",
         "format=obj&triangulate=true&repair=split&weld=1e-300"},
    };
    for (size_t i = 0; i < COUNT(options); i++) {
        char kept[SERVER_OPTIONS];
        struct server_options asked;
        struct server_record *again;
        struct proto_problem problem;
        size_t size;
        assert_true(server_options_split(options[i].asked, &asked));
        assert_true(server_kind_mesh.read_options(&asked.parameters, NULL, kept, &problem));
        assert_string_equal(kept, options[i].kept);
        struct server_record *record = new_record_of(mesh_key("a"), kept, "1", NULL);
        char *text = server_record_write(record, &size);
        assert_int_equal(server_record_read(NULL, text, size, &again), SERVER_RECORD_READ);
        assert_string_equal(again->options, kept);
        assert_string_equal(again->etag, record->etag);
        server_record_release(again);
        server_record_release(record);
        free(text);
    }
}

static void tags_differ_by_bytes_and_options(void **state)
{
    (void)state;
    struct server_record *a = new_record("a", "1"), *b = new_record("b", "1"),
                         *c = new_record("a", "2");
    const struct server_key acme = {.tenant = "acme", .kind = &server_kind_mesh, .name = "a"};
    struct server_record *d =
        new_record_of(mesh_key("a"), "format=obj&triangulate=false", "1", NULL);
    struct server_record *e = new_record_of(mesh_key("a"), MESH_OPTIONS, "1", "attachment");
    struct server_record *f = new_record_of(acme, MESH_OPTIONS, "1", NULL);
    assert_string_equal(a->etag, b->etag);
    assert_string_not_equal(a->etag, c->etag);
    assert_string_not_equal(a->etag, d->etag);
    assert_false(server_record_equal(a, b)); /* another name */
    assert_false(server_record_equal(a, c));
    assert_false(server_record_equal(a, d));
    assert_false(server_record_equal(a, e));
    assert_false(server_record_equal(a, f));
    assert_string_not_equal(a->etag, e->etag);
    /* the tags differ, so that caches that use tags as keys are separate for each tenant */
    assert_string_not_equal(a->etag, f->etag);
    assert_true(server_record_equal(a, a));
    server_record_release(a);
    server_record_release(b);
    server_record_release(c);
    server_record_release(d);
    server_record_release(e);
    server_record_release(f);
}

static void every_changed_byte_is_detected(void **state)
{
    (void)state;
    struct server_record *record = new_record("a", "1"), *again;
    size_t size;
    char *text = server_record_write(record, &size);
    for (size_t at = 0; at < size; at++) {
        for (int bit = 0; bit < 8; bit += 3) {
            text[at] = (char)(text[at] ^ 1 << bit);
            assert_int_equal(server_record_read(NULL, text, size, &again), SERVER_RECORD_DAMAGED);
            text[at] = (char)(text[at] ^ 1 << bit);
        }
    }
    for (size_t cut = 0; cut < size; cut++)
        assert_int_equal(server_record_read(NULL, text, cut, &again), SERVER_RECORD_DAMAGED);
    server_record_release(record);
    free(text);
}

/* Reads the text with a correct checksum. */
static enum server_record_reading read_signed(const char *body)
{
    char text[1024], checksum[SERVER_SHA256_HEX];
    struct server_record *record;
    server_sha256(body, strlen(body), checksum);
    int size = snprintf(text, sizeof text, "%schecksum %s\n", body, checksum);
    enum server_record_reading reading = server_record_read(NULL, text, (size_t)size, &record);
    if (reading == SERVER_RECORD_READ) server_record_release(record);
    return reading;
}

#define SHA   "b391f08159e507ad3a0fa80558bdb046e150e38868378c9972072d54ad65f858"
#define TITLE "geodesicd record 2\n"
#define OWNER TITLE "kind mesh\ntenant \n"
#define HEAD  OWNER "name a\nsha256 " SHA "\n"
#define TIMES "created 1\nmemory 2\n"
#define TAIL  "attachment \n" TIMES "options format=obj&triangulate=true\ndescription {}\n"

static void only_complete_records_are_read(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        TITLE,
        TITLE "kind mesh\nname a\nsha256 " SHA "\nsize 1\n" TAIL,
        TITLE "kind mesh\ntenant ../a\nname a\nsha256 " SHA "\nsize 1\n" TAIL,
        OWNER "name ../a\nsha256 " SHA "\nsize 1\n" TAIL,
        OWNER "name a\nsha256 b391\nsize 1\n" TAIL,
        OWNER "name a\nsha256 " SHA "f\nsize 1\n" TAIL,
        HEAD "size -1\n" TAIL,
        HEAD "size 1 \n" TAIL,
        HEAD "size\n" TAIL,
        HEAD "size 1\n" TIMES "options format=obj&triangulate=true\ndescription {}\n",
        HEAD "size 1\nattachment " SHA "\n" TIMES
             "options format=obj&triangulate=true\ndescription {}\n",
        HEAD "size 1\nattachment b391 1\n" TIMES
             "options format=obj&triangulate=true\ndescription {}\n",
        HEAD "size 1\nattachment \n" TIMES "options format=png&triangulate=true\ndescription {}\n",
        HEAD "size 1\nattachment \n" TIMES "options format=any&triangulate=true\ndescription {}\n",
        /* the options are not in the canonical form */
        HEAD "size 1\nattachment \n" TIMES "options triangulate=true&format=obj\ndescription {}\n",
        HEAD "size 1\nattachment \n" TIMES "options format\ndescription {}\n",
        HEAD "size 1\nattachment \n" TIMES
             "options a=b&a=b&a=b&a=b&a=b&a=b&a=b&a=b&a=b\ndescription {}\n",
        HEAD "size 1\nattachment \n" TIMES "options format=obj&triangulate=true\n",
    };
    assert_int_equal(read_signed(HEAD "size 1\n" TAIL), SERVER_RECORD_READ);
    for (size_t i = 0; i < COUNT(wrong); i++)
        assert_int_equal(read_signed(wrong[i]), SERVER_RECORD_DAMAGED);
    assert_int_equal(read_signed("geodesicd record 4\nname a\nwhatever\n"), SERVER_RECORD_NEWER);
    assert_int_equal(read_signed(TITLE "kind dodecahedron\ntenant \nwhatever\n"),
                     SERVER_RECORD_NEWER);
}

/* Tests a record of version 1, which has no kind. */
static void version_1_is_a_mesh_without_tenant(void **state)
{
    (void)state;
    static const char body[] =
        "geodesicd record 1\nname a\nsha256 " SHA
        "\nsize 7\ncreated 1\nmemory 2\noptions format=obj&triangulate=true\ndescription {}\n";
    char text[1024], checksum[SERVER_SHA256_HEX];
    struct server_record *record;
    server_sha256(body, strlen(body), checksum);
    int size = snprintf(text, sizeof text, "%schecksum %s\n", body, checksum);
    assert_int_equal(server_record_read("a", text, (size_t)size, &record), SERVER_RECORD_READ);
    assert_ptr_equal(record->kind, &server_kind_mesh);
    assert_string_equal(record->tenant, "");
    assert_string_equal(record->attachment_sha256, "");
    assert_int_equal(record->size, 7);
    server_record_release(record);
}

static void nothing_leaks_without_memory(void **state)
{
    (void)state;
    struct server_record *record = new_record("a", "1"), *again = NULL;
    size_t size;
    char *text = server_record_write(record, &size);
    size_t before = mallinfo2().uordblks;
    has_no_memory = true;
    enum server_record_reading reading = server_record_read(NULL, text, size, &again);
    has_no_memory = false;
    assert_int_equal(reading, SERVER_RECORD_NO_MEMORY);
    assert_int_equal(mallinfo2().uordblks, before); /* a sanitizer checks leaks itself */
    assert_null(again);
    server_record_release(record);
    free(text);
}

static void a_record_is_counted_once_until_it_is_released(void **state)
{
    (void)state;
    struct server_budget budget;
    struct server_record *record = new_record("a", "v 0 0 0\n"),
                         *other = new_record("b", "v 0 0 0\n");
    server_budget_init(&budget, sizeof *record + 1000);
    assert_true(server_record_take(record, &budget));
    size_t bytes = budget.used[SERVER_BUDGET_RECORDS];
    assert_in_range(bytes, sizeof *record, sizeof *record + 1000);
    assert_true(server_record_take(record, &budget));
    server_record_count(record, &budget);
    assert_int_equal(budget.used[SERVER_BUDGET_RECORDS], bytes);
    assert_false(server_record_take(other, &budget));
    server_record_count(other, &budget); /* the record exists, so it is counted */
    assert_int_equal(budget.used[SERVER_BUDGET_RECORDS], 2 * bytes);
    assert_non_null(server_record_catalogue(record));
    assert_true(budget.used[SERVER_BUDGET_RECORDS] > 2 * bytes);
    server_record_release(record);
    server_record_release(other);
    assert_int_equal(budget.total, 0);
}

static void the_caption_of_a_counted_record_is_counted(void **state)
{
    (void)state;
    struct server_budget budget;
    struct server_record *record = new_record("a", "v 0 0 0\n");
    server_budget_init(&budget, sizeof *record + 1000);
    assert_true(server_record_take(record, &budget));
    size_t bytes = budget.used[SERVER_BUDGET_RECORDS];
    assert_true(server_record_set_caption(record, "scan"));
    assert_int_equal(budget.used[SERVER_BUDGET_RECORDS], bytes + sizeof "scan");
    server_record_release(record);
    assert_int_equal(budget.total, 0);
}

static void a_long_description_is_shortened_when_it_is_read(void **state)
{
    (void)state;
    struct server_record *record = new_record("a", "v 0 0 0\n"), *again;
    struct proto_writer writer;
    size_t size = 0;
    proto_writer_init(&writer, 1 << 20);
    proto_append_format(&writer, "{\"name\":\"a\",\"boundaries\":[{\"vertices\":3,\"length\":1}");
    for (int i = 1; i < 5000; i++)
        proto_append_format(&writer, ",{\"vertices\":3,\"length\":%d}", i);
    proto_append(&writer, "]}", 3);
    free(record->description);
    record->description = proto_writer_take(&writer, &size);
    char *text = server_record_write(record, &size);
    assert_int_equal(server_record_read(NULL, text, size, &again), SERVER_RECORD_READ);
    assert_true(strlen(again->description) < 4096);
    assert_non_null(strstr(again->description, "\"boundary_count\":5000"));
    assert_string_equal(again->etag, record->etag);
    server_record_release(again);
    server_record_release(record);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_record_is_read_as_written),
        cmocka_unit_test(options_are_read_as_written),
        cmocka_unit_test(tags_differ_by_bytes_and_options),
        cmocka_unit_test(every_changed_byte_is_detected),
        cmocka_unit_test(only_complete_records_are_read),
        cmocka_unit_test(version_1_is_a_mesh_without_tenant),
        cmocka_unit_test(nothing_leaks_without_memory),
        cmocka_unit_test(a_record_is_counted_once_until_it_is_released),
        cmocka_unit_test(the_caption_of_a_counted_record_is_counted),
        cmocka_unit_test(a_long_description_is_shortened_when_it_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
