#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

#include "base/slices.h"
#include "tests/support/two_threads.h"

#define COUNT (20 * GD__PACE_STEPS + 3)

static uint8_t visits[COUNT];

static void visit(void *context, struct gd__pace *pace, uint32_t begin, uint32_t end)
{
    (void)context;
    (void)pace;
    for (uint32_t i = begin; i < end; i++) visits[i]++;
}

static void each_element_is_visited_once(void **state)
{
    (void)state;
    const struct gd_control on_two = {.executor = &two_threads};
    const struct gd_control *controls[] = {NULL, &on_two};
    const uint32_t counts[] = {0, 1, GD__PACE_STEPS, GD__PACE_STEPS + 1, COUNT};
    for (int c = 0; c < 2; c++)
        for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
            struct gd__pace pace = {.control = controls[c]};
            memset(visits, 0, sizeof visits);
            gd__slices_run(&pace, counts[n], visit, NULL);
            assert_int_equal(pace.status, GD_OK);
            for (uint32_t i = 0; i < COUNT; i++) assert_int_equal(visits[i], i < counts[n]);
        }
}

static bool refuse(void *user, double fraction)
{
    const pthread_t *caller = user;
    (void)fraction;
    assert_true(pthread_equal(*caller, pthread_self()));
    return false;
}

/* Progress is reported on the calling thread only. A cancelled loop skips slices. */
static void a_cancelled_loop_ends(void **state)
{
    (void)state;
    pthread_t caller = pthread_self();
    const struct gd_executor *const executors[] = {NULL, &two_threads};
    for (int e = 0; e < 2; e++) {
        const struct gd_control control = {
            .progress = refuse, .user = &caller, .executor = executors[e]};
        struct gd__pace pace = {.control = &control, .status = GD_OK};
        memset(visits, 0, sizeof visits);
        gd__slices_run(&pace, COUNT, visit, NULL);
        /* the other thread may have run all slices */
        if (!executors[e]) {
            assert_int_equal(pace.status, GD_CANCELLED);
            assert_int_equal(visits[0], 0);
        }
        pace.status = GD_CANCELLED;
        memset(visits, 0, sizeof visits);
        gd__slices_run(&pace, COUNT, visit, NULL);
        assert_int_equal(pace.status, GD_CANCELLED);
        for (uint32_t i = 0; i < COUNT; i++) assert_int_equal(visits[i], 0);
    }
}

/* The deadline ends loops on both threads. */
static void a_late_loop_ends(void **state)
{
    (void)state;
    const struct gd_control control = {.deadline_ns = 1, .executor = &two_threads};
    struct gd__pace pace = {.control = &control};
    memset(visits, 0, sizeof visits);
    gd__slices_run(&pace, COUNT, visit, NULL);
    assert_int_equal(pace.status, GD_DEADLINE);
    for (uint32_t i = 0; i < COUNT; i++) assert_int_equal(visits[i], 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_element_is_visited_once),
        cmocka_unit_test(a_cancelled_loop_ends),
        cmocka_unit_test(a_late_loop_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
