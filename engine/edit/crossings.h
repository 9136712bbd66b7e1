/* Crossings: finds the faces of a surface that pass through other faces, or that are folded back
 * onto a neighbour. */
#pragma once

#include "gd/control.h"
#include "gd/polygons.h"
#include "gd/status.h"

/* Sets `crossed[i]` to the lowest-numbered triangle that triangle i crosses, or GD_NONE if there is
 * none. Two triangles cross if an edge of one passes through the other, or if they share an edge at
 * an angle of less than GD_TOL_EDIT_FOLD. Triangles that only touch do not cross. `crossed` has an
 * item for each triangle. Errors: those of gd_mesh_build. Cost: expected O(n log n) time, and the
 * memory of a mesh. */
GD_MUST_USE enum gd_status gd__find_crossings(const struct gd_polygons *triangles,
                                              const struct gd_control *control, uint32_t *crossed);
