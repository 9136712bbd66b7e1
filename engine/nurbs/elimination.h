/* Elimination: the interior of a piece taken out of Newton's system, which leaves its length as a
 * function of the joints at its ends. */
#ifndef GD_NURBS_ELIMINATION_H
#define GD_NURBS_ELIMINATION_H

#include "nurbs/energy.h"

enum {
    GD__PART_GRADIENT,
    GD__PART_FROM,
    GD__PART_TO,
    GD__PART_SOLUTIONS
}; /* right-hand sides of a piece: its gradient, and the columns of its two joints */
/* One piece in a step. */
struct gd__part {
    struct gd__energy energy;
    double length;
    double *factor;                       /* as energy.hessian */
    double *solution[GD__PART_SOLUTIONS]; /* 2 n each */
    /* unknowns that do not move of themselves: the ends, and what is held on a border */
    bool *held;
    struct gd__curve_jet end[2]; /* of its joints */
    double slope[2];             /* dE by the joints' unknowns, interior unmoved */
    double reduced[2];           /* the same when the interior follows */
    double schur[2][2];          /* second derivatives likewise */
    bool contact;                /* something is held on a border */
    double weight[2];            /* squared speed at which the ends move by the joints' unknowns */
};

static inline uint32_t gd__piece_unknowns(const struct gd__chain *chain,
                                          const struct gd__piece *piece)
{
    return 2 * gd__piece_points(chain, piece);
}

/* From energy and ends to solution, slope, reduced, schur and weight. `scratch`: as many numbers as
 * there are unknowns. False: the Hessian is not positive definite. O(spans degree^2). */
bool gd__part_eliminate(const struct gd__chain *chain, const struct gd__piece *piece,
                        enum gd__hessian kind, double *scratch, struct gd__part *part);

#endif
