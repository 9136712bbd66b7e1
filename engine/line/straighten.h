/* Straighten: moves a polyline across the surface, with its ends fixed, until it is a geodesic.
 * Normalised unit. */
#ifndef GD_LINE_STRAIGHTEN_H
#define GD_LINE_STRAIGHTEN_H

#include "line/strip.h"

/* Memory that is reused from line to line. All zero at first. */
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

/* Computes the locally shortest line into which `route` can be moved. It is no longer than the
 * route. Where it bends, it touches the boundary, or it passes a vertex and the angle on each side
 * of the line is at least pi. Method: find the shortest line in the strip of faces. At each vertex
 * with less than pi on the side outside the strip, move the strip to that side. Repeat until there
 * is no such vertex. A route and its reverse give the same line. Replaces the content of `out`.
 * Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL (not a valid route). */
GD_MUST_USE enum gd_status gd__straighten(struct gd__straightener *straightener,
                                          const struct gd__route *route, struct gd__route *out);

/* Computes the length of a line on the surface into which `route` can be moved. Stops when a round
 * shortens the line by less than `least_gain` of its length. Usually the result is little longer
 * than the locally shortest line. Errors: those of gd__straighten. */
GD_MUST_USE enum gd_status gd__straighten_length(struct gd__straightener *straightener,
                                                 const struct gd__route *route, double least_gain,
                                                 double *out);

/* The angles on both sides of a line at a point. `back` is the turn towards the line before the
 * point, `ahead` the turn in which it leaves. INFINITY on the side of a boundary. */
struct gd__bend {
    double right, left;
};
struct gd__bend gd__bend_of_turns(const struct gd_mesh *mesh, const struct gd_point *at,
                                  double back, double ahead);

#endif
