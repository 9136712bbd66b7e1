/* Newton: brings a chain to a critical point of its length, downhill.
 *
 * Each step solves H d = -g by elimination: the control points inside a piece by a banded Cholesky
 * factorisation, which leaves the length of a geodesic as a function of its two ends; then the
 * joints' unknowns by a tridiagonal system. Where H is not positive definite, Gauss-Newton's matrix
 * takes its place. Armijo's line search; what leaves the domain is held on its border as long as
 * the gradient points outwards (an active set). */
#ifndef GD_NURBS_NEWTON_H
#define GD_NURBS_NEWTON_H

#include "nurbs/chain.h"

struct gd__newton_report {
    double length;
    double decrement; /* what a further step would save, relative to the length */
    uint32_t iterations;
    bool converged;
    /* the covariant Hessian at the end is positive definite: a proved local minimum */
    bool positive;
    bool contact;      /* control points or joints are held on the domain's border */
    double pull[2][2]; /* derivative of the length by the first and by the last control point */
};

struct gd__newton_limits {
    uint32_t most; /* steps */
    /* arrived when the next step promises less than this part of the length; GD_TOL_STATIONARY: as
       far as doubles go */
    double stop;
};

/* Moves the chain. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE; no convergence is
 * none, the report says it. */
GD_MUST_USE enum gd_status gd__newton(struct gd__chain *chain,
                                      const struct gd__newton_limits *limits,
                                      struct gd__newton_report *out);

#endif
