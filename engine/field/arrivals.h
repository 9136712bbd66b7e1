/* Arrivals: the number of shortest paths to a point. If there are several, the point lies on the
 * cut locus, where the direction of the shortest path jumps. */
#pragma once

#include "field/layout.h"

/* Sets *out to true if a second path arrives that satisfies two conditions. Its direction differs
 * from that of the shortest path by at least GD_TOL_CUT_ANGLE. Both paths are equally long at a
 * position that is nearer to the point than GD_TOL_CUT times the distance. *out is false at seeds
 * and at points without a path. Errors: GD_NO_MEMORY. O(wedges of the edges of the faces that
 * contain the point). */
GD_MUST_USE enum gd_status gd__field_is_cut(const struct gd_field *field,
                                            const struct gd_point *point, bool *out);

/* Like gd__field_is_cut, for a path of the field. Tests the path's first point and each vertex of
 * the path, because other paths may join there. */
GD_MUST_USE enum gd_status gd__field_path_is_cut(const struct gd_field *field,
                                                 const struct gd_path *path, bool *out);
