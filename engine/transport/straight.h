/* Straight: how a line goes on that comes to a vertex. */
#ifndef GD_TRANSPORT_STRAIGHT_H
#define GD_TRANSPORT_STRAIGHT_H

#include "gd/trace.h"
#include "line/turn.h"

/* The turn in which a line leaves a vertex that came from the turn `back`, by the rule of the
 * options. False, at the boundary only: straight on is not on the surface. O(faces of the
 * vertex). */
bool gd__straight_on(const struct gd_mesh *mesh, uint32_t vertex, double back,
                     const struct gd_trace_options *options, double *out);

/* Where a line slides on along the boundary that came to a vertex of it from the turn `back`:
 * forward, along the boundary side that begins there, or backward, along the one that ends there.
 * False: it makes no acute angle with either. */
bool gd__straight_slide(const struct gd_mesh *mesh, uint32_t vertex, double back, uint32_t *side,
                        bool *forward);

#endif
