/* Alter: makes a triangle mesh finer or rougher, in place, so that one model gives meshes of many
 * sizes. */
#pragma once

#include "gd/polygons.h"
#include "gd/status.h"

/* Splits every triangle at the midpoints of its edges, `levels` times. Errors: GD_TOO_LARGE (more
 * than 2^28 triangles), GD_NO_MEMORY. */
GD_MUST_USE enum gd_status alter_subdivide(struct gd_polygons *mesh, uint32_t levels);

/* Moves every vertex along its normal, which is the area-weighted mean of its faces' normals. The
 * distance is random, uniformly distributed up to `amplitude` mean edge lengths in either
 * direction. The seed is fixed. On GD_NO_MEMORY the mesh is unchanged. */
GD_MUST_USE enum gd_status alter_roughen(struct gd_polygons *mesh, double amplitude);
