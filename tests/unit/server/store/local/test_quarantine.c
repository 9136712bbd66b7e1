#include "tests/unit/server/support.h"

#include "server/store/local/quarantine.h"

static void what_is_condemned_is_held_until_it_is_lifted(void **state)
{
    struct server_quarantine quarantine;
    (void)state;
    server_quarantine_init(&quarantine);
    uint64_t turn = server_quarantine_turn(&quarantine);
    assert_true(server_quarantine_condemn(&quarantine, "a", turn));
    assert_true(server_quarantine_condemn(&quarantine, "b", turn));
    assert_true(server_quarantine_condemn(&quarantine, "a", turn)); /* once is enough */
    assert_int_equal(server_quarantine_count(&quarantine), 2);
    server_quarantine_lift(&quarantine, "a");
    server_quarantine_lift(&quarantine, "nobody");
    assert_false(server_quarantine_holds(&quarantine, "a"));
    assert_true(server_quarantine_holds(&quarantine, "b"));
    assert_int_equal(server_quarantine_count(&quarantine), 1);
    server_quarantine_clear(&quarantine);
}

static void nobody_is_condemned_for_what_was(void **state)
{
    struct server_quarantine quarantine;
    (void)state;
    server_quarantine_init(&quarantine);
    uint64_t turn = server_quarantine_turn(&quarantine);
    server_quarantine_lift(&quarantine, "a"); /* it was written meanwhile */
    assert_false(server_quarantine_condemn(&quarantine, "a", turn));
    assert_false(server_quarantine_holds(&quarantine, "a"));
    assert_true(server_quarantine_condemn(&quarantine, "a", server_quarantine_turn(&quarantine)));
    server_quarantine_clear(&quarantine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_condemned_is_held_until_it_is_lifted),
        cmocka_unit_test(nobody_is_condemned_for_what_was)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
