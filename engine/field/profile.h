/* Profile: the exact distance along a straight segment of the surface, and the nearest source of
 * each part of the segment. The sources of a face (wedges across its edges, corners, seeds in it)
 * become windows of the segment, as if it were an edge. Contests (window/contest.h) find the
 * nearest source everywhere. Within one window the distance is a convex function. Its minimum is at
 * the position nearest to the source, its maximum at an end of the window. */
#pragma once

#include "field/layout.h"
#include "mesh/segment.h"
#include "window/stack.h"

/* An all-zero struct is empty. The memory is reused. */
struct gd__profile {
    /* sorted, disjoint, over [0, length]; only the absolute value of `y` is meaningful */
    struct gd__stack windows;
    struct gd__stack scratch;
    double length;
};

/* Computes the profile of the segment from a to b, which are different points of one face. Parts
 * without a path have no windows. Error: GD_NO_MEMORY. O(k log k) for k wedges of the face's
 * edges. */
GD_MUST_USE enum gd_status gd__profile_of(const struct gd_field *field, const struct gd_point *a,
                                          const struct gd_point *b, struct gd__profile *profile);
void gd__profile_destroy(struct gd__profile *profile);

/* The least or greatest distance of a profile that is not empty, and its parameter. */
struct gd__profile_place {
    double distance, t;
};
struct gd__profile_place gd__profile_least(const struct gd__profile *profile);
struct gd__profile_place gd__profile_greatest(const struct gd__profile *profile);
