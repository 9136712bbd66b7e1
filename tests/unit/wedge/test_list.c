/* A list is the lower envelope of the windows that were offered to it: sorted, disjoint, nowhere worse than any of them. */
#include "tests/support/test.h"

#include <math.h>

#include "wedge/list.h"

#define OFFERED 12
#define WIDTH   1e-10

static struct gd__window random_window(struct rng *rng, uint32_t source)
{
    double a = rng_unit(rng), b = rng_unit(rng);
    return (struct gd__window){.b0 = fmin(a, b),
                               .b1 = fmax(a, b),
                               .x = rng_between(rng, -1, 2),
                               .y = rng_between(rng, 0.01, 1.5),
                               .sigma = rng_between(rng, 0, 0.5),
                               .source = source};
}

static double envelope(const struct gd__window *windows, uint32_t count, double t)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++)
        if (windows[i].b0 <= t && t <= windows[i].b1) least = fmin(least, gd__window_distance(&windows[i], t));
    return least;
}

static void check_sorted_and_disjoint(const struct gd__window *windows, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        assert_true(windows[i].b1 - windows[i].b0 > WIDTH);
        if (i) assert_true(windows[i].b0 >= windows[i - 1].b1 - WIDTH);
    }
}

static void check_envelope(const struct gd__window *list, uint32_t count, const struct gd__window *offered,
                           uint32_t offers)
{
    check_sorted_and_disjoint(list, count);
    for (int k = 1; k < 200; k++) {
        double t = k / 200.0 + 1e-4; /* off the ends, where a window may begin or stop */
        double expected = envelope(offered, offers, t), actual = envelope(list, count, t);
        check_close(actual, expected, 1e-12);
    }
}

static void pushing_gives_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {11};
    struct gd__stack list = {0}, scratch = {0};
    for (int round = 0; round < 2000; round++) {
        struct gd__window offered[OFFERED];
        list.count = 0;
        for (uint32_t i = 0; i < OFFERED; i++) {
            offered[i] = random_window(&rng, i);
            check_ok(gd__stack_push(&list, &offered[i], WIDTH, &scratch), NULL);
        }
        check_envelope(list.windows, list.count, offered, OFFERED);
    }
    gd__stack_destroy(&list);
    gd__stack_destroy(&scratch);
}

static void inserting_gives_the_envelope(void **state)
{
    (void)state;
    struct rng rng = {12};
    struct gd__pool pool;
    gd__pool_init(&pool, sizeof(struct gd__window), NULL, 0);
    struct gd__stack newer = {0}, scratch = {0};
    for (int round = 0; round < 2000; round++) {
        struct gd__list list = {0};
        struct gd__window offered[OFFERED];
        for (uint32_t i = 0; i < OFFERED; i++) offered[i] = random_window(&rng, i);
        for (uint32_t i = 0; i < OFFERED; i += 3) {
            newer.count = 0;
            for (uint32_t k = i; k < i + 3; k++) check_ok(gd__stack_push(&newer, &offered[k], WIDTH, &scratch), NULL);
            check_ok(gd__list_insert(&list, &pool, &newer, WIDTH, &scratch), NULL);
        }
        check_envelope(list.windows, list.count, offered, OFFERED);
        gd__pool_release(&pool, list.windows, list.size_class);
    }
    gd__pool_destroy(&pool);
    gd__stack_destroy(&newer);
    gd__stack_destroy(&scratch);
}

static void neighbours_that_see_one_source_become_one(void **state)
{
    (void)state;
    struct gd__pool pool;
    gd__pool_init(&pool, sizeof(struct gd__window), NULL, 0);
    struct gd__stack newer = {0}, scratch = {0};
    struct gd__list list = {0};
    double ends[4][2] = {{0, 0.25}, {0.75, 1}, {0.25, 0.5}, {0.5, 0.75}};
    for (int i = 0; i < 4; i++) {
        struct gd__window w = {.b0 = ends[i][0], .b1 = ends[i][1], .x = 0.5, .y = 2, .sigma = 1, .source = 3};
        newer.count = 0;
        check_ok(gd__stack_push(&newer, &w, WIDTH, &scratch), NULL);
        check_ok(gd__list_insert(&list, &pool, &newer, WIDTH, &scratch), NULL);
    }
    assert_true(list.count <= 2);
    assert_true(list.windows[0].b0 == 0);
    assert_true(list.windows[list.count - 1].b1 == 1);
    gd__pool_destroy(&pool);
    gd__stack_destroy(&newer);
    gd__stack_destroy(&scratch);
}

static void budget_is_kept(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 1 << 20};
    struct gd__pool pool;
    gd__pool_init(&pool, sizeof(struct gd__window), &control, 1000);
    while (gd__pool_take(&pool, 4)) assert_true(pool.bytes + 1000 <= control.budget_bytes);
    assert_int_equal(pool.status, GD_BUDGET);
    assert_true(pool.bytes > control.budget_bytes / 4);
    gd__pool_destroy(&pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pushing_gives_the_envelope),
        cmocka_unit_test(inserting_gives_the_envelope),
        cmocka_unit_test(neighbours_that_see_one_source_become_one),
        cmocka_unit_test(budget_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
