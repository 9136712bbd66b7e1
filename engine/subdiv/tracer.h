/* Tracer: traces a geodesic from piece to piece.
 *
 * DESIGN. `local` and (ds,dt) are the current place and velocity in the base face's coordinates;
 * walker->piece is the current piece. A step stays within the piece (up to GD_TOL_PATCH) or ends on
 * its border. The next piece may lie in the same base face, whose coordinates continue across the
 * border. Or it lies in the face across a side; the direction then keeps its components along and
 * across the side. Near a vertex, pieces become very small. So a path that passes within
 * GD_TOL_VERTEX of the vertex jumps to the vertex' other side. */
#pragma once

#include "gd/limit_path.h"
#include "subdiv/walker.h"

struct gd__tracer {
    struct gd__walker *walker;
    struct gd__face_place local;
    double ds, dt;
    struct gd_vec3 direction; /* the velocity as a unit vector */
    struct gd_vec3 position;
    double skipped; /* length of jumps across vertices that is not yet part of the path's length */
    bool under_way, ended;
    enum gd_limit_end end;
};

/* Starts at a place in a direction, which is projected onto the tangent plane. If there is no
 * tangent plane, the path ends at once. Error: GD_INVALID_ARGUMENT (the direction has no tangential
 * component). */
GD_MUST_USE enum gd_status gd__tracer_start(struct gd__tracer *tracer, struct gd__walker *walker,
                                            const struct gd__face_place *local,
                                            struct gd_vec3 direction);

/* Makes one step of at most the length `most`, and adds the step's length to *length. Error:
 * GD_INTERNAL (no step is short enough for the error bound). */
GD_MUST_USE enum gd_status gd__tracer_step(struct gd__tracer *tracer, double most, double *length);

/* Moves to the vertex at corner `corner` of a base face, and continues from the vertex in
 * `direction`. */
GD_MUST_USE enum gd_status gd__tracer_leave_vertex(struct gd__tracer *tracer, uint32_t face,
                                                   uint32_t corner, struct gd_vec3 direction);
