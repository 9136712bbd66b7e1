/* Flat strip: the faces along a path, and the path itself, unfolded into the plane.
 *
 * Each face keeps its shape. It shares with the next face the edge that the path crosses. Lengths
 * in the strip equal lengths on the surface. A geodesic is a straight line in the strip, except at
 * vertices. At a vertex of the path, the strip passes the vertex on the side with fewer faces. A
 * strip may overlap itself. */
#ifndef GD_FLAT_STRIP_H
#define GD_FLAT_STRIP_H

#include "gd/control.h"
#include "gd/mesh.h"
#include "gd/path.h"

GD_EXTERN_C_BEGIN

/* A face of the strip. Its corners are counter-clockwise, as seen from outside. */
struct gd_flat_face {
    double corners[3][2];
};

/* Coordinates are in the caller's unit. The path begins at the origin and ends on the positive x
 * axis. */
struct gd_flat_strip {
    struct gd_flat_face *faces; /* owned, in the order of the path */
    uint32_t face_count;
    double (*points)[2]; /* owned; one for each point of the path */
    uint32_t point_count;
};

/* Frees the arrays and zeroes the struct. NULL is allowed. */
void gd_flat_strip_free(struct gd_flat_strip *strip);

/* Unfolds the faces of a path whose consecutive points have a common face. `control` may be NULL.
 * The caller frees `*out` by gd_flat_strip_free. Errors: GD_INVALID_ARGUMENT (no points),
 * GD_INTERNAL (two consecutive points without a common face), GD_NO_MEMORY, GD_BUDGET,
 * GD_TOO_LARGE. O(points, plus the faces around points that are vertices). Thread-safe. */
GD_MUST_USE enum gd_status gd_flat_strip_of(const struct gd_mesh *mesh, const struct gd_path *path,
                                            const struct gd_control *control,
                                            struct gd_flat_strip *out);

GD_EXTERN_C_END

#endif
