#include "tests/unit/server/support.h"

#include "server/work/traffic.h"

#define MS UINT64_C(1000000)

/* Requests at even distances for so long, and what a worker sees then who looked in the beginning.
 */
static bool seen_after(struct server_traffic *traffic, uint64_t begin_ns, uint64_t length_ns,
                       uint64_t distance_ns)
{
    (void)server_traffic_is_dense(traffic, begin_ns);
    for (uint64_t at = begin_ns; at < begin_ns + length_ns; at += distance_ns)
        server_traffic_note(at);
    return server_traffic_is_dense(traffic, begin_ns + length_ns);
}

static void dense_is_more_than_half_of_the_slots(void **state)
{
    (void)state;
    struct server_traffic traffic = {0};
    assert_true(seen_after(&traffic, 1000 * MS, 20 * MS, 24000));
    assert_true(seen_after(&traffic, 1100 * MS, 20 * MS, 150000));
    assert_false(seen_after(&traffic, 1200 * MS, 20 * MS, 250000));
    assert_false(seen_after(&traffic, 1300 * MS, 1000 * MS, 1000 * MS));
}

/* Many at once, as one client's pipeline, are one slot. */
static void a_burst_is_not_dense(void **state)
{
    (void)state;
    struct server_traffic traffic = {0};
    (void)server_traffic_is_dense(&traffic, 5000 * MS);
    for (int i = 0; i < 10000; i++) server_traffic_note(5001 * MS);
    assert_false(server_traffic_is_dense(&traffic, 5010 * MS));
}

/* Within ten milliseconds the last answer stands; it ends with the traffic. */
static void it_is_measured_now_and_then(void **state)
{
    (void)state;
    struct server_traffic traffic = {0};
    assert_true(seen_after(&traffic, 7000 * MS, 10 * MS, 24000));
    assert_true(server_traffic_is_dense(&traffic, 7019 * MS));
    assert_false(server_traffic_is_dense(&traffic, 7021 * MS));
}

/* Threads whose clocks were read in another order than they come. */
static void a_slot_of_the_past_is_let_be(void **state)
{
    (void)state;
    struct server_traffic traffic = {0};
    (void)server_traffic_is_dense(&traffic, 9000 * MS);
    for (int i = 0; i < 1000; i++) server_traffic_note((9009 + (i & 1)) * MS);
    assert_false(server_traffic_is_dense(&traffic, 9010 * MS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dense_is_more_than_half_of_the_slots),
        cmocka_unit_test(a_burst_is_not_dense),
        cmocka_unit_test(it_is_measured_now_and_then),
        cmocka_unit_test(a_slot_of_the_past_is_let_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
