/* Purse: what one call holds of its budget, kept by all who take memory for it.
 *
 * One call, one thread. */
#ifndef GD_BASE_PURSE_H
#define GD_BASE_PURSE_H

#include "gd/control.h"

struct gd__purse {
    const struct gd_control *control; /* its budget; may be NULL */
    size_t held;                      /* bytes */
};

/* Takes bytes from the budget, all or none of them. A NULL purse has no end. GD_BUDGET. */
GD_MUST_USE static inline enum gd_status gd__purse_take(struct gd__purse *purse, size_t bytes)
{
    enum gd_status status = purse ? gd_control_afford(purse->control, purse->held + bytes) : GD_OK;
    if (!status && purse) purse->held += bytes;
    return status;
}

#endif
