#include "tests/unit/io/reading.h"

#include "io/utf16.h"

static void expect_text(const char *bytes, size_t size, const char *expected)
{
    char *text;
    size_t length;
    assert_true(gd__is_utf16(bytes, size));
    assert_int_equal(gd__utf16_decode(bytes, size, NULL, &text, &length), GD_OK);
    assert_int_equal(length, strlen(expected));
    assert_memory_equal(text, expected, length);
    free(text);
}

static void decodes_both_byte_orders(void **state)
{
    (void)state;
    expect_text(BYTES("\xFF\xFE"), "");
    expect_text(BYTES("\xFE\xFF\0A\0\xE9\x20\xAC"), "A\xC3\xA9\xE2\x82\xAC");
    expect_text(BYTES("\xFF\xFE"
                      "A\0\xE9\0\xAC\x20"),
                "A\xC3\xA9\xE2\x82\xAC");
    expect_text(BYTES("\xFE\xFF\xD8\x3D\xDE\0\0z"), "\xF0\x9F\x98\x80z");
}

#define REPLACED "\xEF\xBF\xBD"

static void replaces_half_pairs(void **state)
{
    (void)state;
    expect_text(BYTES("\xFE\xFF\xD8\x3D\0z"), REPLACED "z");
    expect_text(BYTES("\xFE\xFF\xD8\x3D"), REPLACED);
    expect_text(BYTES("\xFE\xFF\xDE\0\0z"), REPLACED "z");
    expect_text(BYTES("\xFE\xFF\0z\0"), "z");
}

static void recognises_byte_order_marks(void **state)
{
    (void)state;
    assert_false(gd__is_utf16("\xFF", 1));
    assert_false(gd__is_utf16("\xEF\xBB\xBF", 3));
    assert_false(gd__is_utf16("OFF", 3));
}

/* Writes the text in UTF-16 with a byte order mark. Returns the size. */
static size_t encode(const char *text, bool big_endian, char out[256])
{
    size_t size = 0;
    memcpy(out, big_endian ? "\xFE\xFF" : "\xFF\xFE", 2);
    for (size_t i = 0; text[i]; i++) {
        out[size += 2] = big_endian ? '\0' : text[i];
        out[size + 1] = big_endian ? text[i] : '\0';
    }
    return size + 2;
}

static void reads_files(void **state)
{
    (void)state;
    static const char *const texts[] = {"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
                                        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                        ("{\"vertices\":[[0,0,0],[1,0,0],[0,1,0]],"
                                         "\"faces\":[[0,1,2]]}")};
    for (size_t i = 0; i < 2 * COUNT_OF(texts); i++) {
        char bytes[256];
        size_t size = encode(texts[i / 2], i % 2, bytes);
        const struct good_input input = {bytes, size, "0 0 0; 1 0 0; 0 1 0 | 0 1 2"};
        check_good(GD_FORMAT_ANY, &input, 1);
        check_truncations(GD_FORMAT_ANY, &input, 1);
    }
}

static void names_lines(void **state)
{
    (void)state;
    char bytes[256];
    size_t size = encode("v 0 0 0\nv 0 0 x\n", true, bytes);
    const struct bad_input input = {bytes, size, GD_SYNTAX, 2, "found 'x'"};
    check_bad(GD_FORMAT_OBJ, &input, 1);
}

static bool refuse(void *user, double fraction)
{
    (void)user;
    (void)fraction;
    return false;
}

static void observes_the_control(void **state)
{
    (void)state;
    const struct gd_control control = {.progress = refuse};
    size_t size = (size_t)1 << 20, length;
    char *bytes = calloc(size, 1), *text = bytes;
    assert_non_null(bytes);
    memcpy(bytes, "\xFF\xFE", 2);
    assert_int_equal(gd__utf16_decode(bytes, size, &control, &text, &length), GD_CANCELLED);
    assert_ptr_equal(text, bytes);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decodes_both_byte_orders),
        cmocka_unit_test(replaces_half_pairs),
        cmocka_unit_test(recognises_byte_order_marks),
        cmocka_unit_test(reads_files),
        cmocka_unit_test(names_lines),
        cmocka_unit_test(observes_the_control),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
