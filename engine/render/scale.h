/* Scale: chooses round levels for isolines and the legend. */
#pragma once

#include "gd/picture.h"

struct gd__scale {
    double range;   /* the largest distance, more than 0 */
    double step;    /* between two neighbouring levels: 1, 2, 2.5 or 5 times a power of ten */
    uint32_t count; /* number of levels: step, 2 step and so on, below the range */
};

/* Returns a scale with about `wanted` levels, `wanted` >= 1. Of the possible intervals between
 * levels, it has the one whose ratio to range / wanted is closest to 1. */
struct gd__scale gd__scale_of(double range, uint32_t wanted);

/* Returns the largest distance of a field's vertices, in the caller's unit. In a partial field,
 * points of faces may be farther from the source than all vertices that have a distance. So the
 * length of the longest edge is added. The sum is limited to the field's reach. Returns 1 if no
 * distance is above 0. O(vertices). */
double gd__field_range(const struct gd_field *field);
