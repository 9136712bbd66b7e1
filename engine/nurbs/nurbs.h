/* The inside of a NURBS surface. */
#ifndef GD_NURBS_NURBS_H
#define GD_NURBS_NURBS_H

#include "gd/nurbs.h"

/* One direction: all n + degree + 1 knots, and the spans that are not empty, which are the
 * surface's cells. */
struct gd__knots {
    uint32_t degree, count;
    double *knots;
    double *lines;   /* interior ones, without repetition */
    uint32_t *spans; /* line_count + 1 */
    uint32_t line_count;
};

struct gd__nurbs {
    struct gd__knots u, v;
    double (*control)[4]; /* homogeneous: (w x, w y, w z, w), relative to `centre` */
    double centre[3];     /* so that far from the origin no digits are lost */
};

/* gd_evaluator's `jet` and `destroy` for a struct gd__nurbs. */
void gd__nurbs_jet(const void *shape, uint32_t cell_u, uint32_t cell_v, double u, double v,
                   struct gd_jet *out);
void gd__nurbs_destroy(void *shape);

#endif
