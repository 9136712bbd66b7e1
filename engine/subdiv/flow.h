/* Flow: the geodesic equation on one polynomial patch. */
#ifndef GD_SUBDIV_FLOW_H
#define GD_SUBDIV_FLOW_H

#include "subdiv/scheme.h"

/* A place in the patch's coordinates and how it moves per length of path. */
struct gd__flow {
    double s, t, ds, dt;
};

/* Moves along the geodesic by `step`; false: not to GD_TOL_GEODESIC over the sine of the angle
 * between the derivatives, choose a shorter step. */
bool gd__flow_advance(const struct gd__scheme *rules, const struct gd__patch *patch,
                      const struct gd__flow *from, double step, struct gd__flow *out);

/* Of the angle between the derivatives: what is across them is known to rounding over this. */
double gd__sine(const struct gd__jet *jet);

/* Components of a vector's tangential part along the two derivatives of a jet. False: the
 * derivatives are no basis. */
bool gd__components(const struct gd__jet *jet, struct gd_vec3 vector, double out[2]);

#endif
