#include "tests/unit/io/reading.h"

#include "io/weld.h"

/* Welds grid points in scattered order, each of them several times. Vertices are numbered in order
 * of first appearance. */
static void numbers_by_first_appearance(void **state)
{
    (void)state;
    enum { SIDE = 20, POINTS = SIDE * SIDE * SIDE, VISITS = 4 * POINTS };
    struct gd__scan scan = gd__scan_begin("", 0, NULL);
    struct gd__builder builder = gd__builder_begin(&scan, NULL);
    struct gd__weld weld = gd__weld_begin(&builder);
    static uint32_t number[POINTS];
    memset(number, 0xFF, sizeof number);
    uint32_t next = 0;
    for (uint32_t visit = 0; visit < VISITS; visit++) {
        uint32_t point = (visit * 2654435761u >> 7) % POINTS, vertex = GD_NONE;
        double xyz[3] = {point % SIDE * 0.5, point / SIDE % SIDE - 7.0,
                         point / SIDE / SIDE * 1e-300};
        if (number[point] == GD_NONE) number[point] = next++;
        assert_int_equal(gd__weld_vertex(&weld, xyz, scan.at, &vertex), GD_OK);
        assert_int_equal(vertex, number[point]);
        assert_memory_equal(builder.positions[vertex], xyz, sizeof xyz);
    }
    assert_int_equal(builder.position_count, next);
    assert_true(next > POINTS / 2);
    gd__weld_free(&weld);
    gd__builder_free(&builder);
}

static void treats_both_zeros_as_equal(void **state)
{
    (void)state;
    struct gd__scan scan = gd__scan_begin("", 0, NULL);
    struct gd__builder builder = gd__builder_begin(&scan, NULL);
    struct gd__weld weld = gd__weld_begin(&builder);
    static const double same[][3] = {{-0.0, 1, 0}, {0, 1, 0}, {-0.0, 1, -0.0}, {0, 1, -0.0}};
    for (size_t i = 0; i < COUNT_OF(same); i++) {
        uint32_t vertex = GD_NONE;
        assert_int_equal(gd__weld_vertex(&weld, same[i], scan.at, &vertex), GD_OK);
        assert_int_equal(vertex, 0);
    }
    uint32_t vertex = GD_NONE;
    assert_int_equal(gd__weld_vertex(&weld, (double[]){0, 1, 5e-324}, scan.at, &vertex), GD_OK);
    assert_int_equal(vertex, 1);
    assert_memory_equal(builder.positions[0], same[0], sizeof same[0]);
    gd__weld_free(&weld);
    gd__builder_free(&builder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_by_first_appearance),
        cmocka_unit_test(treats_both_zeros_as_equal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
