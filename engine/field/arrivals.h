/* Arrivals: how many shortest paths there are to a point. Where there are several the point lies on
 * the cut locus: directions of paths jump there. */
#ifndef GD_FIELD_ARRIVALS_H
#define GD_FIELD_ARRIVALS_H

#include "field/layout.h"

/* *out: do paths that are as short as the shortest one, to GD_TOL_CUT of its length aside, come to
 * the point from directions that are GD_TOL_CUT_ANGLE apart or more? False at the seeds and where
 * no path leads. GD_NO_MEMORY. O(wedges of the edges of the faces that contain it). */
GD_MUST_USE enum gd_status gd__field_is_cut(const struct gd_field *field,
                                            const struct gd_point *point, bool *out);

/* The same of a path that the field gave, at its first point or at any vertex that it passes:
 * others may join it before the end. */
GD_MUST_USE enum gd_status gd__field_path_is_cut(const struct gd_field *field,
                                                 const struct gd_path *path, bool *out);

#endif
