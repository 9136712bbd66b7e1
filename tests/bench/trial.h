/* Trial: one propagation from one source with chosen methods, timed and counted. */
#pragma once

#include "wavefront/wavefront.h"

struct trial_request {
    struct gd_point source;
    /* the propagation stops when this point's distance is final; NULL propagates over the whole
       mesh */
    const struct gd_point *target;
    struct gd__variant methods;
    /* receives the distance at every vertex index, NAN at unreferenced ones; may be NULL */
    double *distances;
};

struct trial {
    /* processor time of propagation, without the merge at the end */
    double ms;
    uint64_t produced;   /* number of windows offered to the lists */
    uint64_t propagated; /* number of windows propagated across a face */
    /* final number of wedges in the lists of the sides, and in one merged list for each edge */
    uint64_t kept_half, kept_merged;
};

/* Runs a trial. Ends the program on failure. */
struct trial trial_run(const struct gd_mesh *mesh, const struct trial_request *request);
