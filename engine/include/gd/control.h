/* Control of long calls: byte budget, deadline, progress, cancel. One mechanism for jobs, deadlines
 * and shutdown.
 *
 * Every long call takes a `const struct gd_control *`; NULL and an all-zero struct mean no limits
 * and no reports. The call looks at it at least once in a millisecond of its own work and stops
 * with GD_BUDGET, GD_DEADLINE or GD_CANCELLED, leaking nothing. */
#ifndef GD_CONTROL_H
#define GD_CONTROL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/executor.h"
#include "gd/status.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd_control {
    /* most bytes that the call may hold at a time, its result included; 0: no limit */
    size_t budget_bytes;
    uint64_t deadline_ns; /* on the clock of gd_now_ns(); 0: none */
    /* Called from the calling thread with the part done in [0,1], never decreasing; false cancels.
     * May be NULL. */
    bool (*progress)(void *user, double fraction);
    void *user;
    struct gd_workspace *workspace; /* memory of earlier calls, gd/workspace.h; NULL: none */
    /* Threads for functions that work in parallel: gd_field_build, gd_field_resume and what builds
     * fields by them. NULL: the calling thread. */
    const struct gd_executor *executor;
};

/* Nanoseconds on the monotonic clock. Thread-safe. */
uint64_t gd_now_ns(void);

/* GD_OK, GD_DEADLINE or GD_CANCELLED; reports `fraction`. `control` may be NULL. */
GD_MUST_USE enum gd_status gd_control_check(const struct gd_control *control, double fraction);

/* GD_OK, or GD_BUDGET when `bytes` exceed the budget. `control` may be NULL. */
GD_MUST_USE enum gd_status gd_control_afford(const struct gd_control *control, size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
