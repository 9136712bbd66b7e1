/* Memory budget: what one call holds of its budget, kept by all who take memory for it.
 *
 * One call, one thread. */
#ifndef GD_BASE_BUDGET_H
#define GD_BASE_BUDGET_H

#include "gd/control.h"

struct gd__budget {
    const struct gd_control *control; /* its budget; may be NULL */
    size_t held;                      /* bytes */
};

/* Takes bytes from the budget, all or none of them. A NULL budget has no end. GD_BUDGET. */
GD_MUST_USE static inline enum gd_status gd__budget_take(struct gd__budget *budget, size_t bytes)
{
    enum gd_status status =
        budget ? gd_control_afford(budget->control, budget->held + bytes) : GD_OK;
    if (!status && budget) budget->held += bytes;
    return status;
}

#endif
