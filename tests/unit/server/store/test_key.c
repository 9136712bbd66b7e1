#include "tests/unit/server/records.h"

#include "server/store/kind.h"

static void assert_reads_back(struct server_key key, const char *expected)
{
    char text[SERVER_KEY_TEXT];
    struct server_key read;
    server_key_write(&key, text);
    assert_string_equal(text, expected);
    assert_true(server_key_check(text, strlen(text)));
    assert_true(server_key_read(text, &read));
    assert_int_equal(server_key_compare(&read, &key), 0);
}

static void texts_are_read_back(void **state)
{
    (void)state;
    assert_reads_back(mesh_key("bunny"), "bunny");
    assert_reads_back((struct server_key){"", &server_kind_subdivision, "cube"},
                      "subdivision+cube");
    assert_reads_back((struct server_key){"acme", &server_kind_mesh, "bunny"}, "acme@bunny");
    assert_reads_back((struct server_key){"acme", &server_kind_nurbs, "sail-2.x"},
                      "acme@nurbs+sail-2.x");
}

static void malformed_keys_are_refused(void **state)
{
    static const char *const texts[] = {"",          "@a",  "a@",    "+a",        "subdivision+",
                                        "unheard+a", "a b", "a@b@c", "nurbs+a+b", "a/b"};
    (void)state;
    for (size_t i = 0; i < COUNT(texts); i++) {
        char text[SERVER_KEY_TEXT];
        struct server_key key;
        strcpy(text, texts[i]);
        if (server_key_read(text, &key)) fail_msg("'%s' was read", texts[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts_are_read_back),
        cmocka_unit_test(malformed_keys_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
