/* Tracer: a geodesic as it goes from piece to piece.
 *
 * DESIGN. `spot` and (ds,dt), in the base face's coordinates, are always where it is and how it
 * moves; walker->piece is the piece that it moves in. A step stays within the piece (up to
 * GD_TOL_PATCH) or ends on its border. Then the next piece is looked for: of the same base face,
 * whose coordinates go on over the border; or of the face across the side, where the direction
 * keeps its part along the side and its part across. Where pieces get small towards a vertex and
 * the vertex is within GD_TOL_VERTEX, the path goes on from the vertex' other side. */
#ifndef GD_SUBDIV_TRACER_H
#define GD_SUBDIV_TRACER_H

#include "gd/limit_path.h"
#include "subdiv/flow.h"
#include "subdiv/walker.h"

struct gd__tracer {
    struct gd__walker *walker;
    struct gd__spot spot;
    double ds, dt;
    struct gd_vec3 direction; /* the same as a vector of unit length */
    struct gd_vec3 position;
    double skipped; /* length of way over vertices that isn't counted yet */
    bool under_way, ended;
    enum gd_limit_end end;
};

/* At a spot, in a tangent direction of unit length. GD_INVALID_ARGUMENT: nothing of the direction
 * is tangent. Where there is no tangent plane it ends at once. */
GD_MUST_USE enum gd_status gd__tracer_start(struct gd__tracer *tracer, struct gd__walker *walker,
                                            const struct gd__spot *spot, struct gd_vec3 direction);

/* One step of at most `most`, whose length is added to `*length`. GD_INTERNAL: no step is short
 * enough to be exact. */
GD_MUST_USE enum gd_status gd__tracer_step(struct gd__tracer *tracer, double most, double *length);

/* Sets the spot to the vertex that is corner `corner` of a base face, and goes on from there in
 * `direction`. */
GD_MUST_USE enum gd_status gd__tracer_leave_vertex(struct gd__tracer *tracer, uint32_t face,
                                                   uint32_t corner, struct gd_vec3 direction);

#endif
