#include "tests/unit/io/reading.h"

#include "io/scan.h"

/* Returns the line number of the first '!' as an error reports it. */
static uint64_t line_of_mark(const char *text)
{
    struct gd_detail detail;
    struct gd__scan scan = gd__scan_begin(text, strlen(text), &detail);
    assert_int_equal(gd__scan_fail(&scan, strchr(text, '!'), GD_SYNTAX, "here"), GD_SYNTAX);
    assert_int_equal(detail.kind, GD_ELEMENT_LINE);
    char expected[32];
    snprintf(expected, sizeof expected, "line %llu: here",
             (unsigned long long)detail.elements[0][0]);
    assert_string_equal(detail.text, expected);
    return detail.elements[0][0];
}

static void counts_lines_of_every_kind(void **state)
{
    (void)state;
    assert_int_equal(line_of_mark("!"), 1);
    assert_int_equal(line_of_mark("\n!"), 2);
    assert_int_equal(line_of_mark("a\n\nb!\n"), 3);
    assert_int_equal(line_of_mark("a\r\n\r\nb!\n"), 3);
    assert_int_equal(line_of_mark("a\r\rb!\r"), 3);
    assert_int_equal(line_of_mark("a\n\rb\r\n!"), 4);
}

/* Checks that gd__scan_skip_line finds `lines` lines. */
static void check_lines(const char *text, bool comments, bool continued, int lines)
{
    struct gd__scan scan = gd__scan_begin(text, strlen(text), NULL);
    scan.comments = comments;
    scan.continued = continued;
    int count = 0;
    for (; scan.at < scan.end; count++) gd__scan_skip_line(&scan);
    if (count != lines) fail_msg("'%s' has %d lines, not %d", text, count, lines);
}

static void skips_lines(void **state)
{
    (void)state;
    check_lines("", false, false, 0);
    check_lines("a\nb\r\nc\rd", false, false, 4);
    check_lines("a\\\nb\n", false, false, 2);
    check_lines("a\\\nb\n", false, true, 1);
    check_lines("a\\\r\nb\\\rc\n\n", false, true, 2);
    check_lines("a\\", false, true, 1);
    check_lines("\\\n\\\n\\\n", false, true, 1);
    check_lines("a # b\\\nc\n", true, true, 2);
    check_lines("# b\\\nc\n", true, true, 2);
    check_lines("a\\# b\nc\n", true, true, 2);
    check_lines("a # b\\\nc\n", false, true, 1);
}

static void splits_words(void **state)
{
    (void)state;
    const char *text = " \tone two#three \n four\\\n five";
    struct gd__scan scan = gd__scan_begin(text, strlen(text), NULL);
    scan.comments = scan.continued = true;
    assert_true(gd__word_is(gd__scan_word(&scan), "one"));
    assert_true(gd__word_resembles(gd__scan_word(&scan), "TWO"));
    assert_int_equal(gd__scan_word(&scan).length, 0);
    gd__scan_skip_space(&scan);
    assert_true(gd__word_is(gd__scan_word(&scan), "four"));
    assert_true(gd__word_is(gd__scan_word(&scan), "five"));
    assert_int_equal(gd__scan_word(&scan).length, 0);
    assert_ptr_equal(scan.at, scan.end);
}

static void reads_integers(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum gd_status status;
        int64_t value;
    } cases[] = {
        {"7", GD_OK, 7},
        {" -12 ", GD_OK, -12},
        {"+5/", GD_OK, 5},
        {"0009", GD_OK, 9},
        {"922337203685477570", GD_OK, 922337203685477570},
        {"99999999999999999999", GD_OK, INT64_MAX},
        {"-99999999999999999999999999", GD_OK, -INT64_MAX},
        {"", GD_TRUNCATED, 0},
        {"\n", GD_SYNTAX, 0},
        {"-", GD_SYNTAX, 0},
        {"1.0", GD_SYNTAX, 0},
        {"1e3", GD_SYNTAX, 0},
        {"--1", GD_SYNTAX, 0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        struct gd__scan scan = gd__scan_begin(cases[i].text, strlen(cases[i].text), NULL);
        int64_t value = 0;
        assert_int_equal(gd__scan_integer(&scan, &value), cases[i].status);
        assert_true(value == cases[i].value);
    }
}

/* A reader reads at most 64 KiB as one number, so the deadline is checked in time. */
static void refuses_very_long_numbers(void **state)
{
    (void)state;
    char *digits = malloc(GD__SCAN_LOOK + 2);
    memset(digits, '1', GD__SCAN_LOOK + 1);
    digits[GD__SCAN_LOOK + 1] = '\0';
    for (size_t more = 0; more < 2; more++) {
        struct gd__scan scan = gd__scan_begin(digits, GD__SCAN_LOOK + more, NULL);
        struct gd__scan again = scan;
        enum gd_status expected = more ? GD_SYNTAX : GD_OK;
        double number;
        int64_t integer;
        assert_int_equal(gd__scan_number(&scan, &number), expected);
        assert_int_equal(gd__scan_integer(&again, &integer), expected);
    }
    free(digits);
}

static void a_deadline_replaces_the_failure(void **state)
{
    (void)state;
    struct gd_detail detail = {.text = ""};
    struct gd__scan scan = gd__scan_begin("!", 1, &detail);
    assert_int_equal(gd__scan_unexpected(&scan, "a vertex"), GD_SYNTAX);
    assert_string_not_equal(detail.text, "");
    scan.deadline_ns = 1; /* long ago */
    assert_int_equal(gd__scan_end(&scan, GD_SYNTAX), GD_DEADLINE);
    assert_string_equal(detail.text, "");
    assert_int_equal(detail.kind, GD_ELEMENT_NONE);
}

static void shows_printable_text_only(void **state)
{
    (void)state;
    const char *word = "a\001\xC3\xA4\x7F~";
    assert_string_equal(gd__excerpt((struct gd__word){word, strlen(word)}).text, "a????~");
    const char *long_word = "0123456789012345678901234567890123456789";
    assert_string_equal(gd__excerpt((struct gd__word){long_word, 40}).text,
                        "0123456789012345678901234567890");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_lines_of_every_kind),
        cmocka_unit_test(skips_lines),
        cmocka_unit_test(splits_words),
        cmocka_unit_test(reads_integers),
        cmocka_unit_test(refuses_very_long_numbers),
        cmocka_unit_test(a_deadline_replaces_the_failure),
        cmocka_unit_test(shows_printable_text_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
