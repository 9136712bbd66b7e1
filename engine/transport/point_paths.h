/* Point paths: searches the shortest paths between the points of a spline, one after the other or,
 * with an executor, two at a time. */
#ifndef GD_TRANSPORT_POINT_PATHS_H
#define GD_TRANSPORT_POINT_PATHS_H

#include "base/share.h"
#include "gd/spline.h"

/* One path to search. */
struct gd__point_path {
    uint32_t from, to;   /* indices of points; if they are equal, no path is searched */
    struct gd_path path; /* owned; empty until it is found */
    bool is_cut;         /* true if other paths are equally short */
};

/* Searches `count` paths between the points of the request, the longest first. Each path is one
 * part of the share. On failure, the paths found so far stay in `paths`. Two simultaneous searches
 * get half of the budget each. If this is too little, the searches run one after the other. Only
 * the caller's thread reports progress. Errors: GD_INVALID_ARGUMENT (no path joins two of the
 * points), and those of gd_pair_solve. */
GD_MUST_USE enum gd_status gd__point_paths_search(const struct gd_mesh *mesh,
                                                  const struct gd_spline_request *request,
                                                  struct gd__share *share,
                                                  struct gd__point_path *paths, uint32_t count,
                                                  struct gd_detail *detail);

/* Frees the paths and the array. Accepts NULL. */
void gd__point_paths_free(struct gd__point_path *paths, uint32_t count);

#endif
