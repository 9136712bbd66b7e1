/* Straighten: a polyline made a geodesic by moving it across the surface, its ends held. Inside
 * unit. */
#ifndef GD_LINE_STRAIGHTEN_H
#define GD_LINE_STRAIGHTEN_H

#include "line/strip.h"

/* Memory that is used again from one line to the next. All zero to begin with. */
struct gd__straightener {
    const struct gd_mesh *mesh;
    const struct gd_control *control;
    double progress; /* of the caller's work, to tell the control */
    uint64_t laid;   /* gates since it was told */
    struct gd__strip strip, other;
    struct gd__corner *corners;
    uint32_t corner_capacity;
    struct gd__route line;
};

void gd__straightener_free(struct gd__straightener *straightener);

/* The locally shortest line that `route` becomes when it is pulled tight: it is no longer than the
 * route, and where it bends it passes a vertex with at least half a turn on either side, or the
 * boundary. In its strip the shortest line is found; at each vertex where that leaves less than
 * half a turn on the side where the strip is not, the strip goes round there instead; until there
 * is none. A route and its reverse give the same line. `out` is filled anew. GD_NO_MEMORY,
 * GD_BUDGET, GD_CANCELLED, GD_DEADLINE, GD_INTERNAL (the route is none). */
GD_MUST_USE enum gd_status gd__straighten(struct gd__straightener *straightener,
                                          const struct gd__route *route, struct gd__route *out);

/* The length of a line that `route` becomes when it is pulled only until a round makes it shorter
 * by less than `least_gain` of its length: that of a line on the surface, too, and for most routes
 * little more than the locally shortest one's. Its errors. */
GD_MUST_USE enum gd_status gd__straighten_length(struct gd__straightener *straightener,
                                                 const struct gd__route *route, double least_gain,
                                                 double *out);

/* The angles between a line that came from the turn `back` and goes on in the turn `ahead`, on
 * either side; INFINITY where the boundary is. */
struct gd__bend {
    double right, left;
};
struct gd__bend gd__bend_of_turns(const struct gd_mesh *mesh, const struct gd_point *at,
                                  double back, double ahead);

#endif
