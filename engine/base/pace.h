/* Pace: checks a control now and then, in loops whose steps are too short to check it at each.
 *
 *     struct gd__pace pace = {.control = control, .fraction = 0.5};
 *     for (...; gd__pace(&pace, 1); ...) step();
 *     GD__PACED (&pace, i, count) step_of_element(i);
 *     return pace.status;
 *
 * Once a pace has stopped, its loops run no further step. So only code that reads the result of a
 * loop has to look at the status in between. */
#ifndef GD_BASE_PACE_H
#define GD_BASE_PACE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "gd/control.h"

#define GD__PACE_STEPS 8192 /* between two looks; a step takes some 50 ns */

struct gd__pace {
    const struct gd_control *control; /* NULL: none */
    double fraction;                  /* of the work, that is reported meanwhile */
    uint64_t since;                   /* steps */
    enum gd_status status;            /* GD_OK, or why it is to end */
};

/* Counts steps. False: the work must stop. */
static inline bool gd__pace(struct gd__pace *pace, uint64_t steps)
{
    pace->since += steps;
    if (pace->since < GD__PACE_STEPS || pace->status) return !pace->status;
    pace->since = 0;
    pace->status = gd_control_check(pace->control, pace->fraction);
    return !pace->status;
}

/* The end of the slice that begins at element `done` of `count`; `done` itself: the loop ends. */
static inline uint32_t gd__pace_slice(struct gd__pace *pace, uint32_t done, uint32_t count)
{
    uint32_t rest = count - done, slice = rest < GD__PACE_STEPS ? rest : GD__PACE_STEPS;
    return gd__pace(pace, slice) ? done + slice : done;
}

/* Runs its body for each i in [0, count); `count` must not change meanwhile. The inner loop is
 * plain: counting costs nothing there. `break` would end a slice only, and a body that steps the
 * pace itself runs on to the end of its slice. */
#define GD__PACED(pace, i, count)                                                                  \
    for (uint32_t i = 0, i##_slice; (i##_slice = gd__pace_slice(pace, i, count)) != i;)            \
        for (; i < i##_slice; i++)

/* Writes a zero to each page of an array that was just allocated, so that the system provides them
 * in order. Scattered writes would wait for nearly all of them within one slice. */
static inline void gd__pace_touch(struct gd__pace *pace, void *array, size_t bytes)
{
    const size_t page = 4096;
    volatile char *byte = array;
    for (size_t at = 0; at < bytes && gd__pace(pace, GD__PACE_STEPS / 64); at += page) byte[at] = 0;
}

/* Sets all bits of the array. */
static inline void gd__pace_fill(struct gd__pace *pace, void *array, size_t bytes)
{
    const size_t piece = (size_t)1 << 20;
    for (size_t done = 0; done < bytes && gd__pace(pace, GD__PACE_STEPS); done += piece)
        memset((char *)array + done, 0xff, bytes - done < piece ? bytes - done : piece);
}

#endif
