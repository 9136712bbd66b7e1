/* Straight continuation of a line through a vertex. */
#pragma once

#include "gd/trace.h"
#include "line/turn.h"

/* Computes the turn (line/turn.h) in which a line that arrived from the turn `back` leaves a
 * vertex, by the rule of the options. Returns false if the straight continuation leaves the
 * surface, which is possible only at the boundary. O(faces around the vertex). */
bool gd__straight_on(const struct gd_mesh *mesh, uint32_t vertex, double back,
                     const struct gd_trace_options *options, double *out);

/* A line has arrived at a boundary vertex from the turn `back`, and slides along the boundary.
 * Chooses the boundary side on which it continues: forward on the side that begins at the vertex,
 * or backward on the side that ends there. Returns false if neither side forms an acute angle with
 * the direction of the line. */
bool gd__straight_slide(const struct gd_mesh *mesh, uint32_t vertex, double back, uint32_t *side,
                        bool *forward);
