#include "support.h"

#include "proto/json/utf8.h"

static void knows_characters(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t length;
    } cases[] = {
        {"a", 1},
        {"\x7f", 1},
        {"\xc2\x80", 2},
        {"\xdf\xbf", 2},
        {"\xe0\xa0\x80", 3},
        {"\xed\x9f\xbf", 3},
        {"\xee\x80\x80", 3},
        {"\xef\xbf\xbf", 3},
        {"\xf0\x90\x80\x80", 4},
        {"\xf4\x8f\xbf\xbf", 4},
        /* stray, missing and wrong continuation bytes */
        {"\x80", 0},
        {"\xbf", 0},
        {"\xc3", 0},
        {"\xc3(", 0},
        {"\xe2\x82", 0},
        {"\xe2(\xa1", 0},
        {"\xf0\x9f\x98", 0},
        /* overlong forms, surrogates, code points beyond Unicode, and bytes that never occur in
           UTF-8 */
        {"\xc0\x80", 0},
        {"\xc1\xbf", 0},
        {"\xe0\x9f\xbf", 0},
        {"\xf0\x8f\xbf\xbf", 0},
        {"\xed\xa0\x80", 0},
        {"\xed\xbf\xbf", 0},
        {"\xf4\x90\x80\x80", 0},
        {"\xf8\x88\x80\x80\x80", 0},
        {"\xff", 0},
    };
    for (size_t i = 0; i < COUNT(cases); i++)
        assert_int_equal(proto_utf8_length(cases[i].text, strlen(cases[i].text)), cases[i].length);
}

static void reads_no_further_than_the_text(void **state)
{
    (void)state;
    static const char rabbit[] = "\xf0\x9f\x90\xb0";
    assert_int_equal(proto_utf8_length(rabbit, 4), 4);
    for (size_t size = 1; size < 4; size++) assert_int_equal(proto_utf8_length(rabbit, size), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(knows_characters),
                                       cmocka_unit_test(reads_no_further_than_the_text)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
