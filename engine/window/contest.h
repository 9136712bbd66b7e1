/* Contest: computes which of two windows gives the shorter distance where they overlap (rules C1
 * and C2 of the paper, equation (1)). */
#pragma once

#include "window/window.h"

/* The result of a contest. The overlap [lo, hi] is cut into pieces, and the winner alternates from
 * piece to piece. */
struct gd__contest_result {
    bool challenger_first;
    int switches; /* number of changes of the winner: 0, 1 or 2 (Property 6) */
    /* parameters of the changes, increasing, strictly inside (lo, hi) up to rounding */
    double at[2];
};

/* Compares two windows that both cover [lo, hi], lo < hi. The owner wins ties. If equation (1) has
 * infinitely many solutions, the owner wins the whole overlap. */
struct gd__contest_result gd__contest(const struct gd__window *challenger,
                                      const struct gd__window *owner, double lo, double hi);
