/* Knots: of a spline's points the shortest paths between them, their parameters and their
 * tangents. */
#ifndef GD_TRANSPORT_KNOTS_H
#define GD_TRANSPORT_KNOTS_H

#include "transport/hops.h"

/* The work on a spline. */
struct gd__knotting {
    const struct gd_mesh *mesh;
    const struct gd_spline_request *request;
    struct gd__share *share;          /* of the whole; each search is a part */
    const struct gd_control *control; /* of it */
    struct gd_detail *detail;
    uint32_t hop_count, total_count;
    /* total_count: hop i goes from point i to the next one; by the paper's rule hop hop_count + i
       past point i, from the one before it to the next one */
    struct gd__hop *hops;
    struct gd_spline_knot *knots; /* hop_count + 1, to be filled in */
};

/* Searches the hops. Errors: GD_INVALID_ARGUMENT (points that are one), and those of
 * gd__hops_search. */
GD_MUST_USE enum gd_status gd__knots_search(struct gd__knotting *knotting);

/* Parameters and tangents from the hops. Errors: GD_NO_MEMORY, GD_BUDGET, GD_INTERNAL. */
GD_MUST_USE enum gd_status gd__knots_fill(const struct gd__knotting *knotting);

#endif
