/* Way: a path from curve to curve in the making: one solution, or two that meet in a pole. */
#ifndef GD_NURBS_WAY_H
#define GD_NURBS_WAY_H

#include "nurbs/seeds.h"
#include "nurbs/solve.h"

#define GD__WAYS_MOST 4

struct gd__way {
    uint32_t parts; /* 2: through a pole, where the first ends and the second begins */
    bool tip;       /* it ends where a curve passes a pole */
    /* through a pole or close by: a coarse curve there is much too long, and says little */
    bool by_pole;
    struct gd__solution part[2];
    /* length and middle: by these ways are told apart, coarse ones before they are finished */
    double coarse;
    struct gd_vec3 middle;
};

/* Coarse ways along a seed, GD__WAYS_MOST at most. A seed that comes near a pole is also tried
 * straight through it and on its other side, one that ends in a pole also with its end held there:
 * in the domain a curve's end could only creep towards it. Errors of gd__newton. */
GD_MUST_USE enum gd_status gd__ways_of_seed(const struct gd__task *task,
                                            const struct gd_domain_curve *const ends[2],
                                            const struct gd__seed *seed, struct gd__way *out,
                                            uint32_t *count);

GD_MUST_USE enum gd_status gd__way_finish(const struct gd__task *task, struct gd__way *way);

void gd__way_free(struct gd__way *way);

double gd__way_length(const struct gd__way *way);

/* Newton's method arrived at a positive definite Hessian. */
bool gd__way_is_minimum(const struct gd__way *way);

/* Not bent; a way through a pole must be straight there; where it ends in a pole that a curve
 * passes, no way to a place beside it is shorter. */
bool gd__way_is_geodesic(const struct gd__task *task, const struct gd__way *way);

/* The point of space halfway. */
struct gd_vec3 gd__way_middle(const struct gd_parametric *surface, const struct gd__way *way);

#endif
