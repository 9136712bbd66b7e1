/* Seeds: ways between two curves by exact geodesics of a tessellation, from which the smooth ones
 * are found.
 *
 * With d1 and d2 the distances from the two curves on the mesh, each way that is shortest on both
 * sides of its middle passes a local minimum of d1 + d2 along the set where d1 = d2; besides, each
 * local minimum of d2 along the first curve, and of d1 along the second, is the end of a way. */
#ifndef GD_NURBS_SEEDS_H
#define GD_NURBS_SEEDS_H

#include "base/share.h"
#include "gd/geodesic_like.h"
#include "nurbs/trail.h"

struct gd__seed {
    double length; /* on the mesh */
    double s[2];   /* parameters on the two curves */
    /* from the first curve to the second; unwound through closed directions; ends exactly on the
       curves */
    struct gd__trail trail;
};

struct gd__seeds {
    uint32_t count, capacity;
    struct gd__seed *seed; /* by length */
};

void gd__seeds_free(struct gd__seeds *seeds);

#define GD__SEEDS_PARTS 2 /* of `share`: a field from each curve */

/* All of them if `all`, else those that the mesh does not rule out for the shortest one. At least
 * one. Counts its parts of `share`. Errors of gd_field_build. */
GD_MUST_USE enum gd_status gd__seeds_find(const struct gd_tessellation *tessellation,
                                          const struct gd_domain_curve *from,
                                          const struct gd_domain_curve *to, bool all,
                                          struct gd__share *share, struct gd__seeds *out,
                                          struct gd_detail *detail);

#endif
