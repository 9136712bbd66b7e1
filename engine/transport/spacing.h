/* Spacing: the parameters at which a spline is to be looked at. */
#ifndef GD_TRANSPORT_SPACING_H
#define GD_TRANSPORT_SPACING_H

#include "transport/sampler.h"

/* Numbers that grow in number. All zero is none. */
struct gd__parameters {
    double *values; /* owned, ascending */
    uint32_t count, capacity;
    double step; /* of equal arc lengths, in the mesh's unit; 0: they are not equal */
};

/* Those of a sampling, for a sampler that has no visitor as yet and is to be used for nothing else
 * meanwhile; its height is set for the sampling. On failure too `out` is to be freed by its owner.
 * GD_TOO_LARGE, and what gd__sampler_walk says. */
GD_MUST_USE enum gd_status gd__spacing_find(struct gd__sampler *sampler,
                                            const struct gd_spline_sampling *sampling,
                                            struct gd__parameters *out, struct gd_detail *detail);

#endif
