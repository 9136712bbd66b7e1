/* Lattice: places of the parameter plane are rounded to integers, so that predicates are exact. */
#pragma once

#include <math.h>

#include "plane/site.h"

/* Largest coordinate of a point. The triangle around all points has coordinates up to 4 times as
 * large. So an in-circle determinant is less than 2^127. */
#define GD__LATTICE_EXTENT (INT64_C(1) << 26)

struct gd__lattice {
    double low[2], scale[2];
};

static inline struct gd__site gd__lattice_round(const struct gd__lattice *lattice,
                                                const double at[2])
{
    return (struct gd__site){llround((at[0] - lattice->low[0]) * lattice->scale[0]),
                             llround((at[1] - lattice->low[1]) * lattice->scale[1])};
}
