#include "tests/support/watch.h"

#include "tests/support/test.h"

bool test_watch(void *user, double fraction)
{
    struct test_watch *watch = user;
    assert_true(fraction >= watch->last && fraction <= 1);
    watch->last = fraction;
    return ++watch->calls != watch->most;
}

bool test_cancel(void *user, double fraction)
{
    (void)user, (void)fraction;
    return false;
}
