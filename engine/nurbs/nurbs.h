/* NURBS surface: knots and control points. */
#pragma once

#include "base/arena.h"
#include "gd/nurbs.h"

/* One direction of the surface: all n + degree + 1 knots, and the non-empty spans, which are the
 * surface's cells. */
struct gd__knots {
    uint32_t degree, count;
    double *knots;
    double *lines;   /* interior knots, without repetition */
    uint32_t *spans; /* line_count + 1 entries: the knot span of each cell */
    uint32_t line_count;
};

struct gd__nurbs {
    struct gd__arena arena;
    struct gd__knots u, v;
    /* homogeneous coordinates (w x, w y, w z, w), where (x, y, z) is relative to `centre` */
    double (*control)[4];
    /* subtracted from all points, so that surfaces far from the origin lose no digits */
    double centre[3];
};

/* The members `jet` and `destroy` of a gd_evaluator whose shape is a struct gd__nurbs. */
void gd__nurbs_jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                   struct gd_jet *out);
void gd__nurbs_destroy(void *shape);
