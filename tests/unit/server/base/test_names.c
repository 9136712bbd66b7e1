#include "tests/unit/server/support.h"

#include <stdio.h>

#include "server/base/names.h"

static void an_empty_set_has_nothing(void **state)
{
    (void)state;
    struct server_names names = {0};
    server_names_sort(&names);
    assert_false(server_names_has(&names, ""));
    server_names_free(&names);
}

static void what_was_added_is_there_and_nothing_else(void **state)
{
    (void)state;
    struct server_names names = {0};
    char name[16];
    for (int i = 0; i < 1000; i++) {
        snprintf(name, sizeof name, "%d", 2 * (i * 7 % 1000));
        server_names_add(&names, name);
    }
    server_names_sort(&names);
    for (int i = 0; i < 2000; i++) {
        snprintf(name, sizeof name, "%d", i);
        assert_int_equal(server_names_has(&names, name), i % 2 == 0);
    }
    assert_false(names.is_incomplete);
    server_names_free(&names);
}

static void a_name_that_is_too_long_is_told(void **state)
{
    (void)state;
    struct server_names names = {0};
    char name[SERVER_NAME_MOST + 2] = "";
    memset(name, 'x', SERVER_NAME_MOST);
    server_names_add(&names, name);
    assert_false(names.is_incomplete);
    assert_true(server_names_has(&names, name));
    name[SERVER_NAME_MOST] = 'x';
    server_names_add(&names, name);
    assert_true(names.is_incomplete);
    assert_false(server_names_has(&names, name));
    server_names_free(&names);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_set_has_nothing),
        cmocka_unit_test(what_was_added_is_there_and_nothing_else),
        cmocka_unit_test(a_name_that_is_too_long_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
