#include "tests/unit/server/support.h"

#include "server/fields/hot_points.h"

static void counts_what_comes_again(void **state)
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

/* A hash of 0 is one like any other. */
static void zero_is_no_special_hash(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    assert_int_equal(server_hot_points_count(&hot_points, 0), 0);
    server_hot_points_note(&hot_points, 0);
    assert_int_equal(server_hot_points_count(&hot_points, 0), 1);
}

static void a_crowd_leaves_nothing_behind(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    for (uint64_t i = 0; i < 100000; i++) {
        server_hot_points_note(&hot_points, i);
        assert_true(server_hot_points_count(&hot_points, i) <= 1);
    }
}

/* One question in ten is about the same point, the others come from everywhere. */
static void finds_the_one_in_a_crowd(void **state)
{
    (void)state;
    struct server_hot_points hot_points = {0};
    for (uint64_t i = 0; i < 2000; i++) server_hot_points_note(&hot_points, i % 10 ? i : 1000000);
    assert_in_range(server_hot_points_count(&hot_points, 1000000),
                    200 - 2000 / (SERVER_HOT_POINTS + 1), 200);
}

/* What was asked for long ago makes room for what is asked for now. */
static void forgets_in_the_end(void **state)
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
        cmocka_unit_test(counts_what_comes_again),
        cmocka_unit_test(zero_is_no_special_hash),
        cmocka_unit_test(a_crowd_leaves_nothing_behind),
        cmocka_unit_test(finds_the_one_in_a_crowd),
        cmocka_unit_test(forgets_in_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
