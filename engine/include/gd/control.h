/* Control of long calls: byte budget, deadline, progress, cancel.
 *
 * Every long call has a parameter `const struct gd_control *`. NULL and an all-zero struct mean no
 * limits and no reports. A call checks its control after at most a millisecond of work. When a
 * limit is exceeded, the call stops with GD_BUDGET, GD_DEADLINE or GD_CANCELLED and leaks
 * nothing. */
#ifndef GD_CONTROL_H
#define GD_CONTROL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gd/executor.h"
#include "gd/status.h"

GD_EXTERN_C_BEGIN

struct gd_control {
    /* largest number of bytes held at any time, including the result; 0 means no limit */
    size_t budget_bytes;
    uint64_t deadline_ns; /* time of the clock gd_now_ns(); 0 means no deadline */
    /* Called on the calling thread with the completed fraction of the work, in [0,1], which never
       decreases. Returns true to continue, and false to cancel the call. May be NULL. */
    bool (*progress)(void *user, double fraction);
    void *user;
    struct gd_workspace *workspace; /* memory reused between calls, gd/workspace.h; may be NULL */
    /* Runs the parallel tasks of gd_read_polygons, gd_mesh_build, gd_edit_deviation, gd_edit_apply,
       gd_simplify, gd_smooth_mesh, gd_fill, gd_components, gd_voronoi_trace and the functions of
       gd/picture.h. Results do not depend on it. If NULL, these tasks run on the calling thread.
       All other work always runs on the calling thread. */
    const struct gd_executor *executor;
};

/* Returns the time of the monotonic clock in nanoseconds. Thread-safe. */
uint64_t gd_now_ns(void);

/* Checks the deadline and calls `progress` with `fraction`. Returns GD_OK, GD_DEADLINE or
 * GD_CANCELLED. `control` may be NULL. O(1). */
GD_MUST_USE enum gd_status gd_control_check(const struct gd_control *control, double fraction);

/* Returns GD_OK, or GD_BUDGET if `bytes` exceed the budget. `control` may be NULL. O(1).
 * Thread-safe. */
GD_MUST_USE enum gd_status gd_control_afford(const struct gd_control *control, size_t bytes);

GD_EXTERN_C_END

#endif
