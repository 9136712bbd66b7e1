/* Elimination: removes the interior unknowns of a piece from Newton's system. The piece's length
 * then depends only on the joints at its ends. */
#pragma once

#include "nurbs/energy.h"

enum {
    GD__PART_GRADIENT,
    GD__PART_FROM,
    GD__PART_TO,
    GD__PART_SOLUTIONS
}; /* right-hand sides of a piece: its gradient and the columns of its two joints */
/* The data of one piece in one step. */
struct gd__part {
    struct gd__energy energy;
    double length;
    double *factor;                       /* has the same layout as energy.hessian */
    double *solution[GD__PART_SOLUTIONS]; /* arrays of 2 n numbers */
    /* for each unknown, true if it is constant in this step, because it belongs to an end of the
       piece or is held on a border */
    bool *held;
    /* places of the joints, with derivatives by the joints' unknowns */
    struct gd__curve_jet end[2];
    /* derivatives of E by the joints' unknowns, if the interior points are fixed */
    double slope[2];
    /* derivatives of E by the joints' unknowns, if the interior points always minimise E */
    double reduced[2];
    double schur[2][2]; /* second derivatives, if the interior points always minimise E */
    bool contact;       /* true if some unknown is held on a border */
    /* squared speeds of the ends with respect to the joints' unknowns */
    double weight[2];
};

static inline uint32_t gd__piece_unknowns(const struct gd__chain *chain,
                                          const struct gd__piece *piece)
{
    return 2 * gd__piece_points(chain, piece);
}

/* Computes the members of `part` that are declared after `end`. Uses `energy` and `end`. `scratch`
 * has one number for each unknown. Returns false if the Hessian is not positive definite. O(spans
 * degree^2). */
bool gd__part_eliminate(const struct gd__chain *chain, const struct gd__piece *piece,
                        enum gd__hessian kind, double *scratch, struct gd__part *part);
