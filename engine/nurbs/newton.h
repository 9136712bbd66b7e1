/* Newton: minimises the length of a chain, down to a critical point.
 *
 * Each step solves H d = -g by elimination: first the control points inside each piece by a banded
 * Cholesky factorisation, which leaves the length of a geodesic as a function of its two ends; then
 * the joints' unknowns by a tridiagonal system. If H is not positive definite, Gauss-Newton's
 * matrix replaces it. The line search follows Armijo's rule. Unknowns at the domain's border are
 * held there while the descent direction points outwards (active set). */
#ifndef GD_NURBS_NEWTON_H
#define GD_NURBS_NEWTON_H

#include "nurbs/chain.h"

struct gd__newton_report {
    double length;
    double decrement; /* expected saving of a further step, relative to the length */
    uint32_t iterations;
    bool converged;
    /* the covariant Hessian at the end is positive definite: a proven local minimum */
    bool positive;
    /* The second derivative vanishes as the path moves sideways with its ends on their curves: it
       is one of a family of equally long paths. */
    bool flat;
    bool contact;      /* control points or joints are held on the domain's border */
    double pull[2][2]; /* derivatives of the length by the first and by the last control point */
};

struct gd__newton_limits {
    uint32_t most; /* steps */
    /* Converged if the next step would save less than this fraction of the length.
       GD_TOL_STATIONARY: iterates as far as doubles allow. */
    double stop;
};

/* Minimises the chain's length. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Missing
 * convergence is not an error; the report states it. */
GD_MUST_USE enum gd_status gd__newton(struct gd__chain *chain,
                                      const struct gd__newton_limits *limits,
                                      struct gd__newton_report *out);

#endif
