#include "support.h"

#include "server/store.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(if_match), cmocka_unit_test(if_none_match)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
