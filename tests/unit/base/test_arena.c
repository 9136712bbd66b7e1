#include "tests/support/test.h"

#include <stdint.h>
#include <string.h>

#include "base/arena.h"

/* The arrays of one owner are charged to one budget. The first failure stays. */

static void arrays_are_separate(void **state)
{
    (void)state;
    struct gd__arena arena = {0};
    double *first = gd__arena_take(&arena, 100, sizeof *first);
    char *empty = gd__arena_take(&arena, 0, 8);
    int *second = gd__arena_zeroed(&arena, 100, sizeof *second);
    char *large = gd__arena_large(&arena, 5 << 20, 1);
    assert_int_equal(arena.status, GD_OK);
    assert_non_null(empty);
    memset(first, 255, 100 * sizeof *first);
    memset(large, 255, 5 << 20);
    for (int i = 0; i < 100; i++) assert_int_equal(second[i], 0);
    assert_int_equal(arena.budget.held, 1200 + (5 << 20));
    gd__arena_free(&arena);
    assert_int_equal(arena.budget.held, 0);
}

static void the_first_failure_stays(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 1000};
    struct gd__arena arena = {.budget.control = &control};
    assert_non_null(gd__arena_take(&arena, 100, 8));
    assert_null(gd__arena_take(&arena, 100, 8));
    assert_int_equal(arena.status, GD_BUDGET);
    assert_null(gd__arena_take(&arena, 1, 1));
    gd__arena_free(&arena);
    assert_int_equal(arena.status, GD_BUDGET);
}

static void an_impossible_size_is_no_memory(void **state)
{
    (void)state;
    struct gd__arena arena = {0};
    assert_null(gd__arena_zeroed(&arena, SIZE_MAX / 4, 8));
    assert_int_equal(arena.status, GD_NO_MEMORY);
    gd__arena_free(&arena);
}

static void arrays_grow_within_the_budget(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 10000};
    struct gd__arena arena = {.budget.control = &control};
    uint32_t *grown = NULL, count = 0, capacity = 0;
    int *before = gd__arena_zeroed(&arena, 4, sizeof *before);
    enum gd_status status = GD_OK;
    for (uint32_t i = 0; !status; i++) {
        status = gd__arena_append(&arena, &grown, &count, &capacity, &i, sizeof i);
        if (i == 70) before = gd__arena_take(&arena, 4, sizeof *before);
    }
    assert_int_equal(status, GD_BUDGET);
    assert_int_equal(arena.status, GD_OK);
    assert_int_equal(count, 1024);
    for (uint32_t i = 0; i < count; i++) assert_int_equal(grown[i], i);
    assert_int_equal(arena.budget.held, 1024 * 4 + 2 * 16);
    gd__arena_free(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_are_separate),
        cmocka_unit_test(the_first_failure_stays),
        cmocka_unit_test(arrays_grow_within_the_budget),
        cmocka_unit_test(an_impossible_size_is_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
