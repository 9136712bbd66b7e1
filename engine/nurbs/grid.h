/* Grid: the parameters at which a surface is tessellated, in both directions. */
#pragma once

#include "base/arena.h"
#include "gd/tessellation.h"
#include "nurbs/surface.h"

struct gd__grid {
    uint32_t steps[2]; /* numbers of steps, at least 3 */
    /* steps + 1 increasing parameters from low to high; they include all lines unless options.steps
       is set */
    double *at[2];
};

/* Divides each cell into equal steps, whose lengths in space are about the same for all cells. If
 * options->steps is set, divides the whole domain into equal steps instead. Errors: GD_TOO_LARGE,
 * GD_NO_MEMORY, GD_BUDGET. */
GD_MUST_USE enum gd_status gd__grid_make(const struct gd_parametric *surface,
                                         const struct gd_tessellation_options *options,
                                         struct gd__arena *arena, struct gd__grid *out);

/* Returns the step that contains a parameter in [low, high]. Sets *part to the position of the
 * parameter in this step, from 0 to 1. */
uint32_t gd__grid_step(const struct gd__grid *grid, int axis, double t, double *part);
