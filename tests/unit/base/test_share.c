#include "tests/support/test.h"

#include "base/share.h"

static bool keep(void *user, double fraction)
{
    *(double *)user = fraction;
    return fraction < 0.9;
}

/* A call has three parts. Each part reports progress from 0 to 1. The control of the whole call
 * gets progress from 0 to 1 once, and can cancel a part. */
static void parts_make_a_whole(void **state)
{
    (void)state;
    double at = -1;
    struct gd_control control = {.progress = keep, .user = &at};
    struct gd__share share = {.control = &control, .total = 3};
    struct gd_control own = gd__share_control(&share, 0);
    for (; share.done < 3; share.done++) {
        check_ok(gd_control_check(&own, 0), NULL);
        check_close(at, share.done / 3.0, 1e-15);
        check_ok(gd_control_check(&own, 0.5), NULL);
        check_close(at, (share.done + 0.5) / 3, 1e-15);
    }
    share.done = 2;
    assert_int_equal(gd_control_check(&own, 1), GD_CANCELLED);
    check_close(at, 1, 1e-15);
}

static void held_memory_reduces_the_budget(void **state)
{
    (void)state;
    struct gd_control control = {.budget_bytes = 1000, .deadline_ns = 1};
    struct gd__share share = {.control = &control, .total = 2};
    struct gd_control own = gd__share_control(&share, 400);
    check_ok(gd_control_afford(&own, 600), NULL);
    assert_int_equal(gd_control_afford(&own, 601), GD_BUDGET);
    assert_int_equal(gd_control_check(&own, 0), GD_DEADLINE);
    /* no memory is left for the part, but its budget must not be 0, which would mean no limit */
    own = gd__share_control(&share, 1000);
    assert_int_equal(gd_control_afford(&own, 2), GD_BUDGET);
    own = gd__share_control(&share, 5000);
    assert_int_equal(gd_control_afford(&own, 2), GD_BUDGET);
    control.budget_bytes = 0;
    own = gd__share_control(&share, 5000);
    check_ok(gd_control_afford(&own, SIZE_MAX), NULL);
}

static void without_a_control_there_are_no_limits(void **state)
{
    (void)state;
    struct gd__share share = {.total = 2};
    struct gd_control own = gd__share_control(&share, 100);
    check_ok(gd_control_check(&own, 0.5), NULL);
    check_ok(gd_control_afford(&own, SIZE_MAX), NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(parts_make_a_whole),
                                       cmocka_unit_test(held_memory_reduces_the_budget),
                                       cmocka_unit_test(without_a_control_there_are_no_limits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
