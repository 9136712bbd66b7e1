/* Watch: a progress callback for tests of long calls. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* If all members are zero, the struct is ready for a call and never cancels it. */
struct test_watch {
    double last;          /* the last reported fraction */
    uint32_t calls, most; /* cancels at callback number `most`; 0 never cancels */
};

/* Callback for struct gd_control's `progress`; `user` is a struct test_watch. Fails the test unless
 * the fractions ascend within [0, 1]. */
bool test_watch(void *user, double fraction);

/* Callback that cancels at once. `user` is ignored. */
bool test_cancel(void *user, double fraction);
