/* Flow: integrates the geodesic equation on one polynomial patch. */
#ifndef GD_SUBDIV_FLOW_H
#define GD_SUBDIV_FLOW_H

#include "subdiv/scheme.h"

/* A place in the patch's coordinates, and its derivative by the path's arc length (the
 * velocity). */
struct gd__flow {
    double s, t, ds, dt;
};

/* Moves along the geodesic by the arc length `step`. Returns false if the error exceeds
 * GD_TOL_GEODESIC divided by the sine of the angle between the derivatives. The caller must then
 * try a shorter step. */
bool gd__flow_advance(const struct gd__scheme *rules, const struct gd__patch *patch,
                      const struct gd__flow *from, double step, struct gd__flow *out);

/* Returns the sine of the angle between the derivatives. Rounding errors are multiplied by its
 * inverse. */
double gd__sine(const struct gd__jet *jet);

/* Computes the components of a vector's tangential part along the two derivatives of a jet. Returns
 * false if the derivatives are parallel. */
bool gd__components(const struct gd__jet *jet, struct gd_vec3 vector, double out[2]);

#endif
