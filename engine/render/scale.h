/* Scale: round distances for isolines and a legend. */
#ifndef GD_RENDER_SCALE_H
#define GD_RENDER_SCALE_H

#include "gd/picture.h"

struct gd__scale {
    double range;   /* the largest distance, more than 0 */
    double step;    /* between two neighbouring levels: 1, 2, 2.5 or 5 times a power of ten */
    uint32_t count; /* levels: step, 2 step and so on, below the range */
};

/* About `wanted` >= 1 levels: as many as come nearest by ratio. */
struct gd__scale gd__scale_of(double range, uint32_t wanted);

/* The largest distance of a field, the caller's unit, at a vertex or where the field ends; 1 where
 * there is none. O(vertices). */
double gd__field_range(const struct gd_field *field);

#endif
