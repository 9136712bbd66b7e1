#include "support.h"

#include "server/etag.h"

static bool holds(const char *if_match, const char *if_none_match, const char *etag)
{
    return server_precondition_holds(&(struct server_precondition){if_match, if_none_match}, etag);
}

static void if_match(void **state)
{
    (void)state;
    assert_true(holds(NULL, NULL, "a"));
    assert_true(holds(NULL, NULL, NULL));
    assert_true(holds("\"a\"", NULL, "a"));
    assert_true(holds("\"x\", \"a\"", NULL, "a"));
    assert_true(holds("*", NULL, "a"));
    assert_false(holds("\"b\"", NULL, "a"));
    assert_false(holds("a", NULL, "a")); /* a tag has quotes */
    assert_false(holds("\"aa\"", NULL, "a"));
    assert_false(holds("*", NULL, NULL));
    assert_false(holds("\"a\"", NULL, NULL));
}

static void if_none_match(void **state)
{
    (void)state;
    assert_true(holds(NULL, "*", NULL));
    assert_true(holds(NULL, "\"b\"", "a"));
    assert_true(holds(NULL, "\"a\"", NULL));
    assert_false(holds(NULL, "*", "a"));
    assert_false(holds(NULL, "\"b\", \"a\"", "a"));
}

static void weak_tags(void **state)
{
    (void)state;
    assert_false(holds("W/\"a\"", NULL, "a")); /* strong comparison: a weak tag equals nothing */
    assert_true(holds("W/\"a\", \"a\"", NULL, "a"));
    assert_false(holds(NULL, "W/\"a\"", "a"));
    assert_false(holds(NULL, "\"b\" ,W/\"a\"", "a"));
    assert_true(holds(NULL, "w/\"a\"", "a")); /* the W is a capital */
}

static void lists(void **state)
{
    (void)state;
    static const char *const with[] = {"\"a\"",          " \"a\"",     "\"x\",\"a\"", ",,\"x\" ,\t\"a\",",
                                       "\"x,y\", \"a\"", "\"\", \"a\""};
    static const char *const without[] = {"",   "\"",  "\"a",     "a",          "\"x\" * \"a\"",
                                          "W/", "W/a", "\"a\\\"", "\"x, \"a\"", "**"};
    for (size_t i = 0; i < COUNT(with); i++) assert_true(server_etag_listed(with[i], "a", 1, SERVER_ETAG_WEAK));
    for (size_t i = 0; i < COUNT(without); i++) assert_false(server_etag_listed(without[i], "a", 1, SERVER_ETAG_WEAK));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(if_match), cmocka_unit_test(if_none_match),
                                       cmocka_unit_test(weak_tags), cmocka_unit_test(lists)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
