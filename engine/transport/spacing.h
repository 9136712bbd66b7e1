/* Spacing: computes the parameters at which a spline is sampled. */
#ifndef GD_TRANSPORT_SPACING_H
#define GD_TRANSPORT_SPACING_H

#include "transport/sampler.h"

/* A growing array of parameters. An all-zero struct is empty. */
struct gd__parameters {
    double *values; /* owned, ascending */
    uint32_t count, capacity;
    double step; /* arc length of a step, in the mesh's unit; 0 if the steps differ */
};

/* Computes the parameters of a sampling. Sets the sampler's visitor and height, so the caller must
 * set its own visitor afterwards. The caller frees `out` also on failure. Errors: GD_TOO_LARGE, and
 * those of gd__sampler_walk. */
GD_MUST_USE enum gd_status gd__spacing_find(struct gd__sampler *sampler,
                                            const struct gd_spline_sampling *sampling,
                                            struct gd__parameters *out, struct gd_detail *detail);

#endif
