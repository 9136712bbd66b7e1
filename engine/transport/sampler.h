/* Sampler: walks along a spline, leaf by leaf: polygons that are flat. */
#ifndef GD_TRANSPORT_SAMPLER_H
#define GD_TRANSPORT_SAMPLER_H

#include "gd/spline.h"
#include "transport/polygon.h"

struct gd__sampler {
    const struct gd_mesh *mesh;
    const struct gd_spline *spline;
    struct gd__straightener straightener;
    double begun, share; /* the part of the caller's work that a walk is */
    /* a leaf departs from its chord by no more; 0: by a part of its segment's length */
    double height;
    /* Called for each leaf in order, with its chord. */
    enum gd_status (*visit)(struct gd__sampler *sampler, const struct gd__polygon *leaf,
                            const struct gd__route *chord);
    void *user;
    struct gd__route route, line; /* to be used by anybody for a moment */
};

/* Walks the whole spline. Errors: those of the visitor and of gd__straighten. */
GD_MUST_USE enum gd_status gd__sampler_walk(struct gd__sampler *sampler);
void gd__sampler_free(struct gd__sampler *sampler);

#endif
