/* Lanes: makes independent items one after the other or, with an executor, two at a time. More than
 * two are not possible, because a workspace has only one partner workspace. The lanes share the
 * control's workspace, so at most one of them may use it. */
#pragma once

#include "base/share.h"
#include "gd/executor.h"

enum { GD__LANE_ALONE = 2, GD__LANES };

struct gd__lanes {                      /* all borrowed for the call */
    const struct gd_executor *executor; /* may be NULL */
    const struct gd_control *control;   /* the control of `share` */
    struct gd__share *share;            /* each item is one part */
    uint32_t count;
    /* Makes item `i`, unless it exists already. `lane` is 0 or 1 if two items are made at a time,
       otherwise GD__LANE_ALONE. A lane makes one item after the other. */
    enum gd_status (*make)(void *context, uint32_t lane, uint32_t i,
                           const struct gd_control *control);
    void *context;
};

/* Makes all items. With an executor of width 2 or more, makes two items at a time, each with half
 * of the budget. If one of them fails, the missing items are made one at a time, and the failure is
 * returned if it occurs again. Only the caller's thread reports progress. Errors: those of `make`;
 * GD_CANCELLED. */
GD_MUST_USE enum gd_status gd__lanes_run(const struct gd__lanes *lanes);
