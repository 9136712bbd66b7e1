/* Sampler: walks along a spline, leaf by leaf. A leaf is a control polygon that is almost
 * straight. */
#pragma once

#include "gd/spline.h"
#include "transport/polygon.h"

struct gd__sampler {
    const struct gd_mesh *mesh;
    const struct gd_spline *spline;
    struct gd__straightener straightener;
    /* progress before the walk, and the walk's part of the whole progress */
    double progress, share;
    /* largest distance of a leaf from its chord; if 0, it is a fixed fraction of the length of the
       segment's polygon */
    double height;
    bool is_whole; /* true if each segment is one leaf */
    /* Called for each leaf in order, with its chord. */
    enum gd_status (*visit)(struct gd__sampler *sampler, const struct gd__polygon *leaf,
                            const struct gd__route *chord);
    void *user;
    struct gd__route route, line; /* scratch */
};

/* Walks the whole spline. Errors: those of the visitor and of gd__straighten. */
GD_MUST_USE enum gd_status gd__sampler_walk(struct gd__sampler *sampler);
void gd__sampler_free(struct gd__sampler *sampler);
