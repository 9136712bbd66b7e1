/* Parametric surface: its smooth cells. In closed directions, the numbers of the cells continue
 * through all periods. */
#pragma once

#include "base/pace.h"
#include "base/references.h"
#include "gd/parametric.h"
#include "loops/loops.h"

/* The number of pace steps (base/pace.h) for one step of this folder. Such a step, for example the
 * quadrature of a span, takes a few microseconds. */
enum { GD__STEP = GD__PACE_STEPS / 32 };

struct gd_parametric {
    struct gd_evaluator evaluator;
    const struct gd_axis *axis[2]; /* the directions u and v */
    double size;                   /* diagonal of the bounding box */
    /* largest distance of a point from the origin, which determines the rounding of positions */
    double farthest;
    size_t bytes;
    /* for a trimmed surface, its loops, and the surface whose evaluator it shares; NULL
       otherwise */
    struct gd__loops *loops;
    const struct gd_parametric *base;
    atomic_uint references;
};

/* A smooth piece of the surface. Lines and seams are those of gd/parametric.h. Cell i of an axis
 * lies between its lines i and i + 1; line 0 is `low`. In a closed direction with a seam the
 * numbers continue through all periods; without a seam there is only cell 0. */
struct gd__cell {
    int32_t index[2];
};

/* Returns the number of smooth pieces in one period. */
static inline int32_t gd__axis_cells(const struct gd_axis *axis)
{
    return (int32_t)axis->line_count + 1;
}

/* Returns the cell that contains a parameter. On a line, returns the cell above it. On a border of
 * the domain, returns the cell inside. */
int32_t gd__axis_cell(const struct gd_axis *axis, double t);

/* Returns the coordinate of the line below cell `index`. In a closed direction without a seam there
 * are no lines; returns INFINITY if the index is positive, and otherwise -INFINITY. Sets *is_line
 * to true for a line or a seam of the surface, and to false for a border. */
double gd__axis_line(const struct gd_axis *axis, int32_t index, bool *is_line);

/* Returns the parameter. In a closed direction, moves it by whole periods into [low, high). */
double gd__axis_wrap(const struct gd_axis *axis, double t);

static inline double gd__axis_period(const struct gd_axis *axis)
{
    return axis->closed ? axis->high - axis->low : 0;
}

struct gd__cell gd__surface_cell(const struct gd_parametric *surface, double u, double v);

/* Evaluates the smooth piece of a cell. The place may lie beyond the lines of the cell. */
void gd__surface_jet(const struct gd_parametric *surface, struct gd__cell cell, const double at[2],
                     struct gd_jet *out);

/* Evaluates the cell that contains the place. */
void gd__surface_at(const struct gd_parametric *surface, const double at[2], struct gd_jet *out);

struct gd_vec3 gd__surface_position(const struct gd_parametric *surface, const double at[2]);

/* Returns true if coordinate `axis` has the value t on a border that is a pole. */
bool gd__surface_pole(const struct gd_parametric *surface, int axis, double t);

/* Returns the signed distance of a place from the loops of a trimmed surface, scaled, and positive
 * inside. Also returns the nearest place of the loops. The place may be outside [low, high] in
 * closed directions. */
double gd__surface_depth(const struct gd_parametric *surface, const double at[2],
                         struct gd__loop_place *out);
