/* Chordal: finds, for each face, the level at which its triangles are within a tolerance of the
 * surface. */
#ifndef GD_SUBDIV_CHORDAL_H
#define GD_SUBDIV_CHORDAL_H

#include "subdiv/grid.h"
#include "subdiv/tiling.h"

/* Allocates the arrays of a grid of `level`; gd__grid_room_free frees them. Error: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__grid_room(uint32_t level, struct gd__grid_room *out);
void gd__grid_room_free(struct gd__grid_room *room);

/* Sets the level of each face of a tiling to the coarsest level that satisfies `tolerance`. The
 * error of a level is measured at the vertices of the grid that is two levels finer. For a vertex
 * inside the face, the error is the distance from the triangles along the normal. For a vertex on a
 * side, it is the distance from the chord of the coarse edge. Error: GD_TOO_LARGE (a level beyond
 * GD__LEVEL_MOST is needed). */
GD_MUST_USE enum gd_status gd__chordal_levels(const struct gd_subdivision *surface,
                                              double tolerance, const struct gd_control *control,
                                              struct gd__tiling *tiling);

#endif
