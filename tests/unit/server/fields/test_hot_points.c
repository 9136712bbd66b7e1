#include "tests/unit/server/support.h"

#include "server/fields/hot_points.h"

static void counts_repeated_points(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    for (uint32_t i = 1; i <= 40; i++) {
        server_hot_points_note(&hot_points, 7);
        server_hot_points_note(&hot_points, 8 + i % 3);
        assert_int_equal(server_hot_points_count(&hot_points, 7), i);
    }
    assert_int_equal(server_hot_points_count(&hot_points, 8), 13);
    assert_int_equal(server_hot_points_count(&hot_points, 99), 0);
    server_hot_points_forget(&hot_points, 7);
    server_hot_points_forget(&hot_points, 99);
    assert_int_equal(server_hot_points_count(&hot_points, 7), 0);
    assert_int_equal(server_hot_points_count(&hot_points, 8), 13);
}

/* A hash of 0 is valid. */
static void a_hash_of_zero_is_valid(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    assert_int_equal(server_hot_points_count(&hot_points, 0), 0);
    server_hot_points_note(&hot_points, 0);
    assert_int_equal(server_hot_points_count(&hot_points, 0), 1);
}

static void distinct_points_get_no_counters(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    for (uint64_t i = 0; i < 100000; i++) {
        server_hot_points_note(&hot_points, i);
        assert_true(server_hot_points_count(&hot_points, i) <= 1);
    }
}

/* One query in ten uses the same point; the others use random points. */
static void finds_a_frequent_point_among_many(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    for (uint64_t i = 0; i < 2000; i++) server_hot_points_note(&hot_points, i % 10 ? i : 1000000);
    assert_in_range(server_hot_points_count(&hot_points, 1000000),
                    200 - 2000 / (SERVER_HOT_POINTS + 1), 200);
}

/* New points replace old points. */
static void forgets_old_points(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    for (uint64_t i = 0; i < 15 * SERVER_HOT_POINTS; i++)
        server_hot_points_note(&hot_points, i % SERVER_HOT_POINTS);
    for (uint64_t i = 0; i < 30; i++) server_hot_points_note(&hot_points, 1000);
    assert_in_range(server_hot_points_count(&hot_points, 1000), 14, 16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_repeated_points),
        cmocka_unit_test(a_hash_of_zero_is_valid),
        cmocka_unit_test(distinct_points_get_no_counters),
        cmocka_unit_test(finds_a_frequent_point_among_many),
        cmocka_unit_test(forgets_old_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
