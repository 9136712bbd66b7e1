#include "base/lanes.h"

#include <stdatomic.h>

/* The address of a thread's own copy of this variable identifies the thread. */
static _Thread_local char here;

struct run {
    const struct gd__lanes *lanes;
    struct gd_control control; /* control of each lane */
    const char *location;      /* identifies the caller's thread */
    uint32_t before;           /* number of parts of the share that were done before this call */
    bool is_cancelled;         /* true if a progress report cancelled the call */
    atomic_uint next, done;
    atomic_bool has_failed; /* stops the other lane */
};

static bool lanes_report(void *user, double fraction)
{
    struct run *run = user;
    const struct gd_control *control = run->lanes->control;
    if (atomic_load(&run->has_failed)) return false;
    if (&here != run->location || !control->progress) return true;
    run->lanes->share->done = run->before + atomic_load(&run->done);
    run->is_cancelled = !control->progress(control->user, fraction);
    return !run->is_cancelled;
}

static void run_lane(void *context, uint32_t lane)
{
    struct run *run = context;
    const struct gd__lanes *lanes = run->lanes;
    for (uint32_t i;
         !atomic_load(&run->has_failed) && (i = atomic_fetch_add(&run->next, 1)) < lanes->count;) {
        if (lanes->make(lanes->context, lane, i, &run->control))
            atomic_store(&run->has_failed, true);
        atomic_fetch_add(&run->done, 1);
    }
}

enum gd_status gd__lanes_run(const struct gd__lanes *lanes)
{
    struct run run = {.lanes = lanes,
                      .control = *lanes->control,
                      .location = &here,
                      .before = lanes->share->done};
    enum gd_status status = GD_OK;
    run.control.progress = lanes_report;
    run.control.user = &run;
    if (run.control.budget_bytes > 2) run.control.budget_bytes /= 2; /* 0 means no limit */
    atomic_init(&run.next, 0);
    atomic_init(&run.done, 0);
    atomic_init(&run.has_failed, false);
    if (lanes->executor && lanes->executor->width > 1 && lanes->count > 1)
        gd_executor_run(lanes->executor, run_lane, &run, 2);
    if (run.is_cancelled) return GD_CANCELLED;
    for (uint32_t i = 0; i < lanes->count && !status; i++) {
        lanes->share->done = run.before + i;
        status = lanes->make(lanes->context, GD__LANE_ALONE, i, lanes->control);
    }
    if (!status) lanes->share->done = run.before + lanes->count;
    return status;
}
