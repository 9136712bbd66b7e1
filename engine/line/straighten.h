/* Straighten: moves a polyline across the surface, with its ends fixed, until it is a geodesic.
 * Normalised unit. */
#pragma once

#include "line/strip.h"

/* Memory that is reused from line to line. The struct must be all zero at first. */
struct gd__straightener {
    const struct gd_mesh *mesh;
    const struct gd_control *control;
    double progress; /* progress to report to the control */
    uint64_t laid;   /* portals unfolded since the last report */
    struct gd__strip strip, other;
    struct gd__corner *corners;
    uint32_t corner_capacity;
    struct gd__route line;
};

void gd__straightener_free(struct gd__straightener *straightener);

/* Computes a locally shortest line into which `route` can be moved continuously. This line is no
 * longer than the route. It bends only at the boundary, and at vertices where the angle on each
 * side of the line is at least pi. Method: find the shortest line in the strip of faces. At each
 * vertex of the line where the angle outside the strip is less than pi, move the strip to the other
 * side of the vertex. Repeat until there is no such vertex. A route and its reverse give the same
 * line. Replaces the content of `out`. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE,
 * GD_INTERNAL (not a valid route). */
GD_MUST_USE enum gd_status gd__straighten(struct gd__straightener *straightener,
                                          const struct gd__route *route, struct gd__route *out);

/* Computes the length of a line on the surface into which `route` can be moved continuously. Stops
 * when a round shortens the line by less than `least_gain` times its length. Usually the result is
 * little longer than the locally shortest line. Errors: those of gd__straighten. */
GD_MUST_USE enum gd_status gd__straighten_length(struct gd__straightener *straightener,
                                                 const struct gd__route *route, double least_gain,
                                                 double *out);

/* The angles on both sides of a line at a point. `back` is the turn of the direction back along the
 * line, `ahead` the turn in which the line leaves the point. If the boundary is on a side of the
 * line, the angle on this side is INFINITY. */
struct gd__bend {
    double right, left;
};
struct gd__bend gd__bend_of_turns(const struct gd_mesh *mesh, const struct gd_point *at,
                                  double back, double ahead);
