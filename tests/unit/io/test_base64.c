#include "io/base64.h"
#include "tests/unit/io/reading.h"

/* The test vectors of RFC 4648, section 10. */
static const char *const known[][2] = {{"", ""},
                                       {"f", "Zg=="},
                                       {"fo", "Zm8="},
                                       {"foo", "Zm9v"},
                                       {"foob", "Zm9vYg=="},
                                       {"fooba", "Zm9vYmE="},
                                       {"foobar", "Zm9vYmFy"}};

static void writes_known_texts(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(known); i++) {
        char out[16];
        size_t length = gd__base64_characters(strlen(known[i][0]));
        assert_int_equal(length, strlen(known[i][1]));
        gd__base64_write(known[i][0], strlen(known[i][0]), out);
        assert_memory_equal(out, known[i][1], length);
    }
}

static void check_read(const char *text, const char *bytes)
{
    char out[64];
    size_t size;
    assert_true(gd__base64_bytes(strlen(text)) <= sizeof out);
    assert_true(gd__base64_read(text, strlen(text), out, &size));
    assert_int_equal(size, strlen(bytes));
    assert_memory_equal(out, bytes, size);
}

static void reads_known_texts(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(known); i++) check_read(known[i][1], known[i][0]);
    check_read("Zg", "f");
    check_read("Zm8", "fo");
    check_read("Pz8\\/", "???");
}

static void refuses_invalid_texts(void **state)
{
    (void)state;
    static const char *const bad[] = {"Z",      "Zm9vY",    "Zm 9v", "Zm9*",
                                      "Zm9v\n", "Zg==Zg==", "Zm9\\", "Zm-_"};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        char out[64];
        size_t size = 77;
        if (gd__base64_read(bad[i], strlen(bad[i]), out, &size)) fail_msg("'%s' was read", bad[i]);
        assert_int_equal(size, 77);
    }
}

/* Encodes and decodes data of all lengths up to 100. AddressSanitizer checks that no byte is
 * written beyond the buffer. */
static void reads_written_text(void **state)
{
    (void)state;
    for (size_t size = 0; size <= 100; size++) {
        char bytes[100], *text = malloc(gd__base64_characters(size) + 1);
        for (size_t i = 0; i < size; i++) bytes[i] = (char)(i * 89 + size * 7);
        gd__base64_write(bytes, size, text);
        char *back = malloc(gd__base64_bytes(gd__base64_characters(size)));
        size_t back_size;
        assert_true(gd__base64_read(text, gd__base64_characters(size), back, &back_size));
        assert_int_equal(back_size, size);
        assert_memory_equal(back, bytes, size);
        free(back);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_known_texts),
        cmocka_unit_test(reads_known_texts),
        cmocka_unit_test(refuses_invalid_texts),
        cmocka_unit_test(reads_written_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
