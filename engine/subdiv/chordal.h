/* Chordal: how fine a face must be cut so that its triangles are near to the surface. */
#ifndef GD_SUBDIV_CHORDAL_H
#define GD_SUBDIV_CHORDAL_H

#include "subdiv/grid.h"
#include "subdiv/tiling.h"

/* Room for grids of `level`. GD_NO_MEMORY; free by free. */
GD_MUST_USE enum gd_status gd__grid_room(uint32_t level, struct gd__grid_room *out);
void gd__grid_room_free(struct gd__grid_room *room);

/* Sets the faces' levels of a tiling to the coarsest that keep to `tolerance`. A level is measured
 * at the vertices of the grid two levels finer: inside, how far they are off the triangles along
 * their normals, at the sides, how far off the chords. GD_TOO_LARGE: beyond GD__LEVEL_MOST. */
GD_MUST_USE enum gd_status gd__chordal_levels(const struct gd_subdivision *surface,
                                              double tolerance, const struct gd_control *control,
                                              struct gd__tiling *tiling);

#endif
