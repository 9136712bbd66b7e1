/* Contest: which of two windows gives the shorter distance where they overlap (rules C1 and C2 of
 * the paper, equation (1)). */
#ifndef GD_WINDOW_CONTEST_H
#define GD_WINDOW_CONTEST_H

#include "window/window.h"

/* The overlap [lo, hi] cut into pieces that are won in turns: by the challenger first, or by the
 * owner first. */
struct gd__verdict {
    bool challenger_first;
    int switches; /* 0, 1 or 2: how often the winner changes (Property 6) */
    double at[2]; /* where, increasing, strictly inside (lo, hi) up to rounding */
};

/* Both windows cover [lo, hi], lo < hi. Ties stay with the owner: infinitely many solutions of
 * equation (1) are a tie everywhere. */
struct gd__verdict gd__contest(const struct gd__window *challenger, const struct gd__window *owner,
                               double lo, double hi);

#endif
