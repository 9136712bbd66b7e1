/* Pace: checks a control once in many steps. It is for loops whose steps are so short that a check
 * in each step would be too slow.
 *
 *     struct gd__pace pace = {.control = control, .fraction = 0.5};
 *     for (...; gd__pace(&pace, 1); ...) step();
 *     GD__PACED (&pace, i, count) step_of_element(i);
 *     return pace.status;
 *
 * After a pace has stopped, loops that use it end at once. So the caller may run several loops, and
 * must check the status only before it reads a loop's result. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "gd/control.h"

#define GD__PACE_STEPS 8192 /* steps between two checks; a step takes about 50 ns */

struct gd__pace {
    const struct gd_control *control; /* NULL means that the pace never stops */
    double fraction;                  /* progress to report to the control */
    size_t held;                      /* bytes to check against the budget */
    uint64_t count;                   /* steps since the last check */
    enum gd_status status;            /* the error that stopped the work; not reset */
};

/* Counts steps. Returns false if the work must stop. */
static inline bool gd__pace(struct gd__pace *pace, uint64_t steps)
{
    pace->count += steps;
    if (pace->count < GD__PACE_STEPS || pace->status) return !pace->status;
    pace->count = 0;
    pace->status = gd_control_afford(pace->control, pace->held);
    if (!pace->status) pace->status = gd_control_check(pace->control, pace->fraction);
    return !pace->status;
}

/* Like gd__pace, but returns the status. */
GD_MUST_USE static inline enum gd_status gd__pace_step(struct gd__pace *pace, uint64_t steps)
{
    gd__pace(pace, steps);
    return pace->status;
}

/* Returns the end of the next slice of [0, count), which begins at `done`. The control is checked
 * between slices. Returns `done` if the loop must end. */
static inline uint32_t gd__pace_slice(struct gd__pace *pace, uint32_t done, uint32_t count)
{
    uint32_t rest = count - done, slice = rest < GD__PACE_STEPS ? rest : GD__PACE_STEPS;
    return gd__pace(pace, slice) ? done + slice : done;
}

/* Runs its body for each i in [0, count); the body must not change `count`. The inner loop is a
 * plain loop over one slice, so it counts no steps. `break` in the body ends only the current
 * slice. If the body itself calls gd__pace and the pace stops, the slice is still completed. */
#define GD__PACED(pace, i, count)                                                                  \
    for (uint32_t i = 0, i##_slice; (i##_slice = gd__pace_slice(pace, i, count)) != i;)            \
        for (; i < i##_slice; i++)

/* Sets all bits of the array. */
static inline void gd__pace_fill(struct gd__pace *pace, void *array, size_t bytes)
{
    const size_t piece = (size_t)1 << 20;
    for (size_t done = 0; done < bytes && gd__pace(pace, GD__PACE_STEPS); done += piece)
        memset((char *)array + done, 0xff, bytes - done < piece ? bytes - done : piece);
}
