/* Profile: the distance along a straight segment of the surface, exactly: which source each part of
 * it has its distance from.
 *
 * What a face sees its distances from (wedges across its edges, corners, seeds in it) is laid
 * beside the segment as windows of it, as if the segment were an edge; contests (window/contest.h)
 * find which of them is nearest where. Within one window the distance is convex: least where it
 * comes nearest to its source, greatest at its ends. */
#ifndef GD_FIELD_PROFILE_H
#define GD_FIELD_PROFILE_H

#include "field/layout.h"
#include "mesh/segment.h"
#include "window/stack.h"

/* All zero is empty; reused. */
struct gd__profile {
    /* sorted, disjoint, over [0, length]; `y` is without meaning but for its size */
    struct gd__stack windows;
    struct gd__stack scratch;
    double length;
};

/* The profile of the segment from a to b, different points of one face. Empty where no path leads.
 * GD_NO_MEMORY. O(k log k) of the k wedges around its face. */
GD_MUST_USE enum gd_status gd__profile_of(const struct gd_field *field, const struct gd_point *a,
                                          const struct gd_point *b, struct gd__profile *profile);
void gd__profile_destroy(struct gd__profile *profile);

/* Least and greatest distance of a profile that is not empty, and where. */
struct gd__profile_place {
    double distance, t;
};
struct gd__profile_place gd__profile_least(const struct gd__profile *profile);
struct gd__profile_place gd__profile_greatest(const struct gd__profile *profile);

#endif
