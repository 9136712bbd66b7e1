/* Control points: the paths between the points of a spline, and the parameter and the tangent of
 * each point. */
#pragma once

#include "base/share.h"
#include "gd/spline.h"

/* One path to search. */
struct gd__point_path {
    uint32_t from, to;   /* indices of points; if they are equal, no path is searched */
    struct gd_path path; /* owned; empty until it is found */
    bool is_cut;         /* true if other paths are equally short */
};

/* Frees the paths and the array. Accepts NULL. */
void gd__point_paths_free(struct gd__point_path *paths, uint32_t count);

/* The state of one spline under construction. */
struct gd__spline_work {
    const struct gd_mesh *mesh;
    const struct gd_spline_request *request;
    /* progress of the whole call; each search is one part of it */
    struct gd__share *share;
    const struct gd_control *control; /* the control of `share` */
    struct gd_detail *detail;
    uint32_t path_count, total_count;
    /* total_count entries. Path i joins point i to the next point. With GD_TANGENT_PAPER, path
       path_count + i joins the two neighbours of point i. */
    struct gd__point_path *paths;
    struct gd_spline_knot *knots; /* path_count + 1 entries, filled by the calls below */
};

/* Searches the paths. Errors: GD_INVALID_ARGUMENT (two points coincide, or no path joins
 * them), and those of gd_pair_solve. */
GD_MUST_USE enum gd_status gd__control_points_search(struct gd__spline_work *work);

/* Computes parameters and tangents from the paths. Errors: GD_NO_MEMORY, GD_BUDGET, GD_INTERNAL. */
GD_MUST_USE enum gd_status gd__control_points_fill(const struct gd__spline_work *work);
