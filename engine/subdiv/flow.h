/* Flow: the geodesic equation on one polynomial patch. */
#ifndef GD_SUBDIV_FLOW_H
#define GD_SUBDIV_FLOW_H

#include "subdiv/scheme.h"

/* A place in the patch's coordinates and how it moves per length of path. */
struct gd__flow {
    double s, t, ds, dt;
};

/* Moves along the geodesic by `step`; false: not to GD_TOL_GEODESIC, choose a shorter step. */
bool gd__flow_advance(const struct gd__scheme *rules, const struct gd__patch *patch, const struct gd__flow *from,
                      double step, struct gd__flow *out);

/* Components of a vector along the two derivatives of a jet, by least squares. False: the derivatives are no basis. */
bool gd__components(const struct gd__jet *jet, struct gd_vec3 vector, double out[2]);

#endif
