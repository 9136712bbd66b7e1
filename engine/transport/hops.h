/* Hops: the shortest paths between a spline's points, searched one after the other or, with an
 * executor, two at a time. */
#ifndef GD_TRANSPORT_HOPS_H
#define GD_TRANSPORT_HOPS_H

#include "base/share.h"
#include "gd/spline.h"

/* One path that is wanted. */
struct gd__hop {
    uint32_t from, to;   /* numbers of points; the same: none is wanted */
    struct gd_path path; /* owned; of no points until it is found */
    bool is_cut;         /* others are as short */
};

/* Searches `count` hops between the request's points, each a part of the share, the farthest ends
 * first; on failure those that were found are there all the same. Where two searches run at a time,
 * each has half of the budget; if that is too little they run one after the other. The caller's
 * progress is reported from its own thread only. Errors: GD_INVALID_ARGUMENT (points that no path
 * joins), and those of gd_pair_solve. */
GD_MUST_USE enum gd_status gd__hops_search(const struct gd_mesh *mesh,
                                           const struct gd_spline_request *request,
                                           struct gd__share *share, struct gd__hop *hops,
                                           uint32_t count, struct gd_detail *detail);

/* the paths and the array; NULL is harmless */
void gd__hops_free(struct gd__hop *hops, uint32_t count);

#endif
