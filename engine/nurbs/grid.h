/* Grid: the parameters at which a surface is tessellated, in both directions. */
#ifndef GD_NURBS_GRID_H
#define GD_NURBS_GRID_H

#include "gd/tessellation.h"
#include "nurbs/surface.h"

struct gd__grid {
    uint32_t steps[2]; /* at least 3 each */
    double *at[2];     /* steps + 1 increasing parameters from low to high, all lines among them */
};

/* Even steps of about equal length within each cell, or of the domain where their number is given.
 * GD_TOO_LARGE, GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__grid_make(const struct gd_parametric *surface,
                                         const struct gd_tessellation_options *options,
                                         struct gd__grid *out);

void gd__grid_free(struct gd__grid *grid);

/* The step that a parameter within [low, high] falls into, and the part of it that lies below. */
uint32_t gd__grid_step(const struct gd__grid *grid, int axis, double t, double *part);

#endif
