#include "tests/unit/server/support.h"

#include "server/work/yielding.h"

#define MS UINT64_C(1000000)

/* A job's looks, each millisecond from `from` to `to`, of a thread that gets one part in `part` of
 * the time; how often it is behind. */
static uint32_t look(struct server_yielding *yielding, uint64_t from, uint64_t to, uint64_t part)
{
    uint32_t behind = 0;
    for (uint64_t at = from; at < to; at++)
        behind += server_yielding_is_due(yielding, at * MS, at * MS / part);
    return behind;
}

static void long_work_goes_behind(void **state)
{
    (void)state;
    struct server_yielding yielding;
    server_yielding_begin(&yielding, 7000 * MS);
    assert_int_equal(look(&yielding, 7000, 7050, 1), 0);
    assert_int_equal(look(&yielding, 7050, 9000, 1), 1950);
    server_yielding_begin(&yielding, 9000 * MS);
    assert_int_equal(look(&yielding, 9000, 9050, 1), 0);
    assert_int_equal(look(&yielding, 9050, 9100, 1), 50);
}

/* Half of the time is enough, a twentieth is not: then it is back for a second after the first
 * tenth of one, for two after the next. */
static void nothing_starves(void **state)
{
    (void)state;
    struct server_yielding yielding;
    server_yielding_begin(&yielding, 1000 * MS);
    assert_int_equal(look(&yielding, 1050, 2050, 2), 1000);
    server_yielding_begin(&yielding, 3000 * MS);
    assert_int_equal(look(&yielding, 3050, 3150, 20), 100);
    assert_int_equal(look(&yielding, 3150, 4150, 20), 0);
    assert_int_equal(look(&yielding, 4150, 4250, 20), 100);
    assert_int_equal(look(&yielding, 4250, 6250, 20), 0);
    assert_int_equal(look(&yielding, 6250, 6350, 20), 100);
}

/* A thread that did not run for a while sees it at its next look. */
static void a_long_pause_is_seen(void **state)
{
    (void)state;
    struct server_yielding yielding;
    server_yielding_begin(&yielding, 0);
    assert_true(server_yielding_is_due(&yielding, 60 * MS, 60 * MS));
    assert_false(server_yielding_is_due(&yielding, 900 * MS, 63 * MS));
    assert_false(server_yielding_is_due(&yielding, 1800 * MS, 963 * MS));
    assert_true(server_yielding_is_due(&yielding, 1901 * MS, 1064 * MS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(long_work_goes_behind),
                                       cmocka_unit_test(nothing_starves),
                                       cmocka_unit_test(a_long_pause_is_seen)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
