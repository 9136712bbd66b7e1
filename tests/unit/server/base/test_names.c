#include "tests/unit/server/support.h"

#include <stdio.h>

#include "server/base/names.h"

static void an_empty_set_has_no_names(void **state)
{
    (void)state;
    struct server_names names = {0};
    assert_false(server_names_has(&names, ""));
    server_names_free(&names);
}

static void a_set_has_the_added_names_only(void **state)
{
    (void)state;
    struct server_names names = {0};
    char name[16];
    for (int i = 0; i < 1000; i++) {
        snprintf(name, sizeof name, "%d", 2 * (i * 7 % 1000));
        server_names_add(&names, name);
    }
    for (int i = 0; i < 2000; i++) {
        snprintf(name, sizeof name, "%d", i);
        assert_int_equal(server_names_has(&names, name), i % 2 == 0);
    }
    assert_false(names.is_incomplete);
    server_names_free(&names);
}

static void a_name_may_be_added_twice(void **state)
{
    (void)state;
    struct server_names names = {0};
    char name[] = "name";
    server_names_add(&names, name);
    server_names_add(&names, name);
    *name = 'g';
    server_names_add(&names, name);
    assert_int_equal(names.count, 2);
    assert_true(server_names_has(&names, "name"));
    assert_true(server_names_has(&names, "game"));
    assert_false(names.is_incomplete);
    server_names_free(&names);
    assert_false(server_names_has(&names, "name"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_set_has_no_names),
        cmocka_unit_test(a_set_has_the_added_names_only),
        cmocka_unit_test(a_name_may_be_added_twice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
