#include "tests/unit/window/model.h"

static bool is_same(const struct gd__window *a, const struct gd__window *b)
{
    return a->b0 == b->b0 && a->b1 == b->b1 && a->x == b->x && a->y == b->y &&
           a->sigma == b->sigma && a->source == b->source;
}

static void a_growing_builder_keeps_its_windows(void **state)
{
    (void)state;
    struct rng rng = {1};
    struct gd__window_builder builder = {0};
    struct gd__stack model = {0};
    for (uint32_t count = 1; count < 3000; count += 1 + count / 7) {
        check_ok(gd__window_builder_reserve(&builder, count), NULL);
        assert_true(builder.capacity >= count);
        while (model.count < builder.capacity) { /* up to the capacity */
            append_window(&model, random_window(&rng, model.count));
            gd__windows_put(&builder.at, model.count - 1, &model.windows[model.count - 1]);
        }
        for (uint32_t i = 0; i < model.count; i++) {
            struct gd__window w = gd__windows_get(&builder.at, i);
            assert_true(is_same(&w, &model.windows[i]));
        }
        assert_int_equal((uintptr_t)builder.at.b0 % 64, 0);
    }
    gd__window_builder_destroy(&builder);
    assert_null(builder.block);
    gd__window_builder_destroy(&builder);
    gd__stack_destroy(&model);
}

/* The code may write a whole group after the last window, and may read a whole group before the
 * first window. AddressSanitizer checks this. */
static void arrays_have_a_spare_group_on_both_sides(void **state)
{
    (void)state;
    struct gd__window_builder builder = {0};
    struct gd__window w = {0, 1, 2, 3, 4, 5, 0};
    check_ok(gd__window_builder_reserve(&builder, 9), NULL);
    for (uint32_t i = 0; i < builder.capacity + GD__WINDOWS_GROUP; i++)
        gd__windows_put(&builder.at, i, &w);
    const char *first = builder.block, *before = (const char *)(builder.at.b0 - GD__WINDOWS_GROUP);
    assert_true(before >= first);
    gd__window_builder_destroy(&builder);
}

static void copies_any_part(void **state)
{
    (void)state;
    struct rng rng = {2};
    struct gd__window_builder from = {0}, to = {0};
    struct gd__stack source = {0}, model = {0};
    check_ok(gd__window_builder_reserve(&to, 200), NULL);
    for (uint32_t i = 0; i < 100; i++) append_window(&source, random_window(&rng, i));
    for (uint32_t i = 0; i < 200; i++) append_window(&model, random_window(&rng, 100 + i));
    build_windows(&source, &from);
    for (int round = 0; round < 2000; round++) {
        uint32_t count = rng_below(&rng, 41), first = rng_below(&rng, 101 - count),
                 at = rng_below(&rng, 201 - count);
        build_windows(&model, &to);
        gd__windows_copy(&to.at, at, &from.at, first, count);
        /* up to a group beyond the end is undefined */
        for (uint32_t i = 0; i < at + count; i++) {
            struct gd__window w = gd__windows_get(&to.at, i);
            assert_true(is_same(&w, i < at ? &model.windows[i] : &source.windows[first + i - at]));
        }
        for (uint32_t i = at + count + GD__WINDOWS_GROUP; i < 200; i++) {
            struct gd__window w = gd__windows_get(&to.at, i);
            assert_true(is_same(&w, &model.windows[i]));
        }
    }
    gd__window_builder_destroy(&from);
    gd__window_builder_destroy(&to);
    gd__stack_destroy(&source);
    gd__stack_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_growing_builder_keeps_its_windows),
        cmocka_unit_test(arrays_have_a_spare_group_on_both_sides),
        cmocka_unit_test(copies_any_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
