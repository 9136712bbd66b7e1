/* Seeds: paths between two curves on a tessellation, the initial guesses for smooth geodesics.
 *
 * Let d1 and d2 be the distances from the two curves on the mesh. If both halves of a locally
 * shortest path are shortest paths, the path passes through a local minimum of d1 + d2 on the set
 * d1 = d2. So each such minimum gives a seed. Each local minimum of d2 along the first curve, and
 * of d1 along the second curve, also gives a seed. */
#pragma once

#include "base/share.h"
#include "gd/geodesic_like.h"
#include "nurbs/uv_polyline.h"

struct gd__path_seed {
    double length; /* length on the mesh */
    double s[2];   /* parameters on the two curves */
    /* A polyline from the first curve to the second. Its coordinates are continuous across the
       seams of closed directions. Its ends lie exactly on the curves. */
    struct gd__uv_polyline polyline;
};

struct gd__path_seeds {
    uint32_t count, capacity;
    struct gd__path_seed *seed; /* sorted by length, the shortest first */
};

void gd__path_seeds_free(struct gd__path_seeds *seeds);

/* Moves the ends of a seed's polyline exactly onto the curves, at the parameters `s`, and measures
 * it. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__path_seed_attach(const struct gd_domain_curve *const ends[2],
                                                struct gd__path_seed *seed);

/* number of parts of a search's `share`: the field of each curve is one part */
#define GD__SEEDS_PARTS 2

/* If `all` is set, finds all seeds; otherwise finds only the seeds that may lead to the shortest
 * path. Finds at least one seed. Errors: those of gd_field_build. */
GD_MUST_USE enum gd_status gd__path_seeds_find(const struct gd_tessellation *tessellation,
                                               const struct gd_domain_curve *from,
                                               const struct gd_domain_curve *to, bool all,
                                               struct gd__share *share, struct gd__path_seeds *out,
                                               struct gd_detail *detail);
