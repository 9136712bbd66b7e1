#include "folder.h"

#include <malloc.h>

static bool has_no_memory; /* for strndup, which this takes the place of */

char *strndup(const char *text, size_t size)
{
    char *copy = has_no_memory ? NULL : malloc(size + 1);
    if (!copy) return NULL;
    copy[size] = '\0';
    return memcpy(copy, text, size);
}

static void comes_back_as_it_was(void **state)
{
    (void)state;
    struct server_record *record = new_record("bunny.1", "v 0 0 0\n"), *again;
    size_t size;
    record->options.build.refuse_polygons = true;
    char *text = server_record_write(record, &size);
    assert_int_equal(strlen(text), size);
    assert_int_equal(server_record_read(text, size, &again), SERVER_RECORD_READ);
    assert_string_equal(again->name, "bunny.1");
    assert_string_equal(again->sha256, record->sha256);
    assert_int_equal(again->size, 8);
    assert_int_equal(again->memory, 1234);
    assert_int_equal(again->created, record->created);
    assert_int_equal(again->options.format, GD_FORMAT_OBJ);
    assert_true(again->options.build.refuse_polygons);
    assert_string_equal(again->description, record->description);
    server_record_release(again);
    server_record_release(record);
    free(text);
}

static void assert_same_options(const struct proto_mesh_options *a, const struct proto_mesh_options *b)
{
    assert_int_equal(a->format, b->format);
    assert_int_equal(a->build.refuse_polygons, b->build.refuse_polygons);
    assert_int_equal(a->build.repair_split, b->build.repair_split);
    assert_int_equal(a->build.weld, b->build.weld);
    assert_true(a->build.weld_tolerance == b->build.weld_tolerance);
}

static void options_come_back_as_they_were(void **state)
{
    (void)state;
    static const struct proto_mesh_options options[] = {
        {.format = GD_FORMAT_PLY},
        {.format = GD_FORMAT_STL, .build = {.repair_split = true}},
        {.format = GD_FORMAT_OFF, .build = {.weld = true, .weld_tolerance = 0}},
        {.format = GD_FORMAT_JSON, .build = {.refuse_polygons = true, .weld = true, .weld_tolerance = 0.1 / 3}},
        {.format = GD_FORMAT_OBJ, .build = {.repair_split = true, .weld = true, .weld_tolerance = 1e-300}},
    };
    char tags[COUNT(options)][SERVER_ETAG];
    for (size_t i = 0; i < COUNT(options); i++) {
        struct server_record *record = new_record("a", "1"), *again, *made;
        size_t size;
        made = server_record_create("a", record->sha256, 1, &options[i]);
        char *text = server_record_write(made, &size);
        assert_int_equal(server_record_read(text, size, &again), SERVER_RECORD_READ);
        assert_same_options(&again->options, &options[i]);
        assert_string_equal(again->etag, made->etag);
        strcpy(tags[i], made->etag);
        for (size_t j = 0; j < i; j++) assert_string_not_equal(tags[i], tags[j]);
        server_record_release(record);
        server_record_release(made);
        server_record_release(again);
        free(text);
    }
}

static void tags_differ_by_bytes_and_options(void **state)
{
    (void)state;
    struct server_record *a = new_record("a", "1"), *b = new_record("b", "1"), *c = new_record("a", "2");
    struct proto_mesh_options options = {.format = GD_FORMAT_OBJ, .build = {.refuse_polygons = true}};
    struct server_record *d = server_record_create("a", a->sha256, 1, &options);
    assert_string_equal(a->etag, b->etag);
    assert_string_not_equal(a->etag, c->etag);
    assert_string_not_equal(a->etag, d->etag);
    assert_false(server_record_equal(a, b)); /* another name */
    assert_false(server_record_equal(a, c));
    assert_false(server_record_equal(a, d));
    assert_true(server_record_equal(a, a));
    server_record_release(a);
    server_record_release(b);
    server_record_release(c);
    server_record_release(d);
}

static void every_change_of_a_byte_is_seen(void **state)
{
    (void)state;
    struct server_record *record = new_record("a", "1"), *again;
    size_t size;
    char *text = server_record_write(record, &size);
    for (size_t at = 0; at < size; at++) {
        for (int bit = 0; bit < 8; bit += 3) {
            text[at] = (char)(text[at] ^ 1 << bit);
            assert_int_equal(server_record_read(text, size, &again), SERVER_RECORD_DAMAGED);
            text[at] = (char)(text[at] ^ 1 << bit);
        }
    }
    for (size_t cut = 0; cut < size; cut++)
        assert_int_equal(server_record_read(text, cut, &again), SERVER_RECORD_DAMAGED);
    server_record_release(record);
    free(text);
}

/* What the text says, with a checksum that is right. */
static enum server_record_reading read_signed(const char *body)
{
    char text[1024], checksum[SERVER_SHA256_HEX];
    struct server_record *record;
    server_sha256(body, strlen(body), checksum);
    int size = snprintf(text, sizeof text, "%schecksum %s\n", body, checksum);
    enum server_record_reading reading = server_record_read(text, (size_t)size, &record);
    if (reading == SERVER_RECORD_READ) server_record_release(record);
    return reading;
}

#define SHA  "b391f08159e507ad3a0fa80558bdb046e150e38868378c9972072d54ad65f858"
#define HEAD "geodesicd record 1\nname a\nsha256 " SHA "\n"
#define TAIL "created 1\nmemory 2\noptions format=obj&triangulate=true\ndescription {}\n"

static void only_whole_records_are_read(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        "geodesicd record 1\n",
        "geodesicd record 1\nname ../a\nsha256 " SHA "\nsize 1\n" TAIL,
        "geodesicd record 1\nname a\nsha256 b391\nsize 1\n" TAIL,
        "geodesicd record 1\nname a\nsha256 " SHA "f\nsize 1\n" TAIL,
        HEAD "size -1\n" TAIL,
        HEAD "size 1 \n" TAIL,
        HEAD "size\n" TAIL,
        HEAD "size 1\ncreated 1\nmemory 2\noptions format=png&triangulate=true\ndescription {}\n",
        HEAD "size 1\ncreated 1\nmemory 2\noptions format\ndescription {}\n",
        HEAD "size 1\ncreated 1\nmemory 2\noptions a=b&a=b&a=b&a=b&a=b&a=b&a=b&a=b&a=b\ndescription {}\n",
        HEAD "size 1\ncreated 1\nmemory 2\noptions format=obj&triangulate=true\n",
    };
    assert_int_equal(read_signed(HEAD "size 1\n" TAIL), SERVER_RECORD_READ);
    for (size_t i = 0; i < COUNT(wrong); i++) assert_int_equal(read_signed(wrong[i]), SERVER_RECORD_DAMAGED);
    assert_int_equal(read_signed("geodesicd record 2\nname a\nwhatever\n"), SERVER_RECORD_NEWER);
}

static void nothing_is_left_without_memory(void **state)
{
    (void)state;
    struct server_record *record = new_record("a", "1"), *again = NULL;
    size_t size;
    char *text = server_record_write(record, &size);
    size_t before = mallinfo2().uordblks;
    has_no_memory = true;
    enum server_record_reading reading = server_record_read(text, size, &again);
    has_no_memory = false;
    assert_int_equal(reading, SERVER_RECORD_NO_MEMORY);
    assert_int_equal(mallinfo2().uordblks, before); /* under a sanitizer its own check of leaks */
    assert_null(again);
    server_record_release(record);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(comes_back_as_it_was),
        cmocka_unit_test(options_come_back_as_they_were),
        cmocka_unit_test(tags_differ_by_bytes_and_options),
        cmocka_unit_test(every_change_of_a_byte_is_seen),
        cmocka_unit_test(only_whole_records_are_read),
        cmocka_unit_test(nothing_is_left_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
