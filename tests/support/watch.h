/* Watch: what tests have a long call report to. */
#ifndef TESTS_SUPPORT_WATCH_H
#define TESTS_SUPPORT_WATCH_H

#include <stdbool.h>
#include <stdint.h>

/* All zero: a call that has not begun, and is not to be cancelled. */
struct test_watch {
    double last;          /* what was reported last */
    uint32_t calls, most; /* cancels at call number `most` */
};

/* For struct gd_control's `progress`, with a watch for its `user`: fails the test unless reports go
 * up within [0, 1]. */
bool test_watch(void *user, double fraction);

/* The same that cancels at once; `user` is not looked at. */
bool test_cancel(void *user, double fraction);

#endif
