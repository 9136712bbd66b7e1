/* Memory budget of one call: counts the bytes that all its allocations have charged.
 *
 * A budget belongs to one call and one thread. */
#pragma once

#include "gd/control.h"

struct gd__budget {
    const struct gd_control *control; /* the control whose memory limit applies; may be NULL */
    size_t held;                      /* bytes charged */
};

/* Charges `bytes`. On GD_BUDGET it charges nothing. A NULL budget is unlimited. */
GD_MUST_USE static inline enum gd_status gd__budget_take(struct gd__budget *budget, size_t bytes)
{
    enum gd_status status =
        budget ? gd_control_afford(budget->control, budget->held + bytes) : GD_OK;
    if (!status && budget) budget->held += bytes;
    return status;
}
