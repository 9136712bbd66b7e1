/* Newton: decreases the length of a chain until its gradient vanishes.
 *
 * Each step solves H d = -g by elimination. First a banded Cholesky factorisation eliminates the
 * control points inside each piece, so that the piece's length depends only on its two joints. Then
 * a tridiagonal system gives the joints' unknowns. If H is not positive definite, the matrix of the
 * Gauss-Newton method replaces it. The line search follows Armijo's rule. An unknown at the
 * domain's border is held there while the descent direction points outwards (active set method). */
#pragma once

#include "nurbs/chain.h"

struct gd__newton_report {
    double length;
    /* expected decrease of the length by a further step, relative to the length */
    double decrement;
    uint32_t iterations;
    bool converged;
    /* true if the covariant Hessian is positive definite at the end; this proves that the path is a
       local minimum */
    bool positive;
    /* True if the path belongs to a family of equally long paths: if the ends move along their
       curves, the second derivative of the length is zero. */
    bool flat;
    bool contact;      /* true if control points or joints are held on the domain's border */
    double pull[2][2]; /* derivatives of the length by the first and by the last control point */
};

struct gd__newton_limits {
    uint32_t most; /* largest number of steps */
    /* The method has converged if the next step would save less than this fraction of the length.
       With GD_TOL_STATIONARY, it iterates as far as the precision of doubles allows. */
    double stop;
};

/* Minimises the chain's length. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. If the
 * method does not converge, this is not an error; the report has `converged` false. */
GD_MUST_USE enum gd_status gd__newton(struct gd__chain *chain,
                                      const struct gd__newton_limits *limits,
                                      struct gd__newton_report *out);
