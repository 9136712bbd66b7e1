/* Watch: looks at the caller's control from loops that return numbers. Once the control says stop,
 * `status` says why, those loops end early, and the numbers count for nothing: who asked for them
 * looks at `status` before they are used. */
#ifndef GD_NURBS_WATCH_H
#define GD_NURBS_WATCH_H

#include "gd/control.h"

enum {
    GD__WATCH_STEPS = 32
}; /* between two looks: steps of some microseconds each, a span's quadrature for instance */

struct gd__watch {
    const struct gd_control *control; /* may be NULL */
    double fraction;                  /* done: what is reported */
    enum gd_status status;
    uint32_t steps;
};

/* One step more. False: stop. */
static inline bool gd__watch_step(struct gd__watch *watch)
{
    if (!watch->status && ++watch->steps % GD__WATCH_STEPS == 0)
        watch->status = gd_control_check(watch->control, watch->fraction);
    return !watch->status;
}

#endif
