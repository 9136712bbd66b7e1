/* The inside of a parametric surface: its smooth cells, numbered through all periods of closed
 * directions. */
#ifndef GD_NURBS_SURFACE_H
#define GD_NURBS_SURFACE_H

#include <stdatomic.h>

#include "gd/parametric.h"

struct gd_parametric {
    struct gd_evaluator evaluator;
    const struct gd_axis *axis[2]; /* u, v */
    double size;                   /* diagonal of its box */
    /* of its points from the origin: what positions are rounded by */
    double farthest;
    size_t bytes;
    _Atomic uint32_t references;
};

/* A smooth piece: cell i of an axis lies between its lines i and i + 1, where line 0 is `low`; in a
 * closed direction with a seam the numbers go on below and above for the other periods; without one
 * there is only cell 0. */
struct gd__cell {
    int32_t index[2];
};

/* Number of smooth pieces in one period. */
static inline int32_t gd__axis_cells(const struct gd_axis *axis)
{
    return (int32_t)axis->line_count + 1;
}

/* The cell of a parameter; on a line the one above, on a border the one inside. */
int32_t gd__axis_cell(const struct gd_axis *axis, double t);

/* The line below a cell, in the numbering of cells: -INFINITY and INFINITY where a cell has no end.
 * `*is_line`: a line or seam of the surface, not a border. */
double gd__axis_line(const struct gd_axis *axis, int32_t index, bool *is_line);

/* The parameter moved by whole periods into [low, high). Others come back as they are. */
double gd__axis_wrap(const struct gd_axis *axis, double t);

static inline double gd__axis_period(const struct gd_axis *axis)
{
    return axis->closed ? axis->high - axis->low : 0;
}

struct gd__cell gd__surface_cell(const struct gd_parametric *surface, double u, double v);

/* The cell's jet, also beyond its lines. */
void gd__surface_jet(const struct gd_parametric *surface, struct gd__cell cell, const double at[2],
                     struct gd_jet *out);

/* The jet of the cell that the place lies in. */
void gd__surface_at(const struct gd_parametric *surface, const double at[2], struct gd_jet *out);

struct gd_vec3 gd__surface_position(const struct gd_parametric *surface, const double at[2]);

/* Is the place, in direction `axis`, on a border that is a pole? */
bool gd__surface_pole(const struct gd_parametric *surface, int axis, double t);

#endif
