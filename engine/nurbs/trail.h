/* Trail: a polyline in the parameter domain with its arc length in space, from which chains
 * begin. */
#ifndef GD_NURBS_TRAIL_H
#define GD_NURBS_TRAIL_H

#include "nurbs/chain.h"

struct gd__trail {
    uint32_t count, capacity; /* at least 2 once it is in use */
    double (*at)[2];
    double *run; /* length up to here along chords in space */
};

void gd__trail_free(struct gd__trail *trail);

/* Appends a place. GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__trail_add(struct gd__trail *trail, const double at[2]);

/* Measures `run`; of places that are one in space the first stays. */
void gd__trail_measure(const struct gd_parametric *surface, struct gd__trail *trail);

/* The place at a fractional position i + f. */
void gd__trail_place(const struct gd__trail *trail, double position, double at[2]);

/* The fractional position at which `run` is so long, not before `from`. */
double gd__trail_position(const struct gd__trail *trail, double run, uint32_t from);

/* Many places of a chain, its spans' ends among them. */
GD_MUST_USE enum gd_status gd__trail_of_chain(const struct gd__chain *chain, struct gd__trail *out);

/* What a chain is to be made with. */
struct gd__fit {
    uint32_t degree, spans; /* in all, shared out by length; at least one a piece */
    struct gd__joint from, to;
    bool whole; /* one piece through all cells */
    /* part of a cell's width: closer than this to a corner of cells a path goes straight to the
       opposite cell */
    double corner;
};

/* A chain along a trail, cut where it crosses lines of the surface. Excursions of less than
 * GD_TOL_CELL of a cell are not followed. Errors: GD_NO_MEMORY, GD_BUDGET, GD_INTERNAL (a trail
 * that crosses more lines than it can). */
GD_MUST_USE enum gd_status gd__trail_fit(const struct gd_parametric *surface,
                                         const struct gd__trail *trail, const struct gd__fit *fit,
                                         struct gd__watch *watch, struct gd__chain **out);

/* Does each piece stay in its cell, but for GD_TOL_CELL of its width? Ends early when the chain's
 * watch says so. */
bool gd__chain_is_proper(const struct gd__chain *chain);

#endif
