#include "tests/unit/server/support.h"

#include "server/query/distinct_points.h"

static struct gd_point face_point(uint32_t face, double a, double b)
{
    return (struct gd_point){.kind = GD_POINT_FACE, .element = face, .weight = {a, b, 1 - a - b}};
}

static void each_point_is_there_once(void **state)
{
    (void)state;
    const struct gd_point v1 = {.kind = GD_POINT_VERTEX, .element = 1},
                          v2 = {.kind = GD_POINT_VERTEX, .element = 2};
    const struct gd_point e1 = {.kind = GD_POINT_EDGE, .element = 1, .weight = {0.5}};
    const struct gd_point list[] = {
        v2, face_point(1, 0.25, 0.5), v1, v2, face_point(1, 0.5, 0.25), e1,
        v2, face_point(1, 0.25, 0.5), e1, v1};
    struct server_distinct distinct = {0};
    assert_true(server_distinct_find(list, COUNT(list), &distinct));
    assert_int_equal(distinct.count, 5);
    for (uint32_t i = 0; i < COUNT(list); i++) {
        assert_true(distinct.number[i] < distinct.count);
        assert_true(gd_point_equal(&distinct.points[distinct.number[i]], &list[i]));
    }
    for (uint32_t i = 1; i < distinct.count; i++)
        for (uint32_t j = 0; j < i; j++)
            assert_false(gd_point_equal(&distinct.points[i], &distinct.points[j]));
    server_distinct_free(&distinct);
    server_distinct_free(&distinct);
}

static void one_point_and_a_thousand_times_one(void **state)
{
    (void)state;
    struct gd_point list[1000];
    for (int i = 0; i < 1000; i++) list[i] = face_point(3, 0.25, 0.5);
    struct server_distinct distinct = {0};
    assert_true(server_distinct_find(list, 1, &distinct));
    assert_true(distinct.count == 1 && distinct.number[0] == 0);
    server_distinct_free(&distinct);
    assert_true(server_distinct_find(list, 1000, &distinct));
    assert_int_equal(distinct.count, 1);
    server_distinct_free(&distinct);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_point_is_there_once),
        cmocka_unit_test(one_point_and_a_thousand_times_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
