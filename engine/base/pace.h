/* Pace: looks at a control now and then, in loops whose steps are too short to look at each.
 *
 *     struct gd__pace pace = {.control = control, .fraction = 0.5};
 *     for (...; gd__pace(&pace, 1); ...) step();
 *     return pace.status; */
#ifndef GD_BASE_PACE_H
#define GD_BASE_PACE_H

#include <stdbool.h>
#include <stdint.h>

#include "gd/control.h"

#define GD__PACE_STEPS 8192 /* between two looks; a step takes some 50 ns */

struct gd__pace {
    const struct gd_control *control; /* NULL: none */
    double fraction;                  /* of the work, that is reported meanwhile */
    uint64_t since;                   /* steps */
    enum gd_status status;            /* GD_OK, or why it is to end */
};

/* Counts steps. False: it is to end. */
static inline bool gd__pace(struct gd__pace *pace, uint64_t steps)
{
    pace->since += steps;
    if (pace->since < GD__PACE_STEPS || pace->status) return !pace->status;
    pace->since = 0;
    pace->status = gd_control_check(pace->control, pace->fraction);
    return !pace->status;
}

#endif
