/* Flat strip: the faces that a path runs through, laid into the plane one beside the other, and the
 * path in them.
 *
 * Each face keeps its shape, and shares the edge over which the path leaves it with the next: what
 * is measured along the strip is as on the surface. So a geodesic is a straight line but for the
 * vertices that it passes through, where the strip goes the way of fewer faces around. A strip may
 * lie across itself. */
#ifndef GD_FLAT_STRIP_H
#define GD_FLAT_STRIP_H

#include "gd/control.h"
#include "gd/mesh.h"
#include "gd/path.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Counter-clockwise, as the face is from outside. */
struct gd_flat_face {
    double corners[3][2];
};

/* In the caller's unit. The path begins at the origin and ends on the positive x axis. */
struct gd_flat_strip {
    struct gd_flat_face *faces; /* owned, in the order of the path */
    uint32_t face_count;
    double (*points)[2]; /* owned, one for each of the path's */
    uint32_t point_count;
};

/* frees the arrays and zeroes; NULL is harmless */
void gd_flat_strip_free(struct gd_flat_strip *strip);

/* Lays out the faces of a path whose consecutive points have a face in common. `control` may be
 * NULL; `*out` is the caller's to free. Thread-safe. Errors: GD_INVALID_ARGUMENT (no points),
 * GD_INTERNAL (two points that follow each other have no face in common), GD_NO_MEMORY, GD_BUDGET,
 * GD_TOO_LARGE. O(points, and faces around the vertices among them). */
GD_MUST_USE enum gd_status gd_flat_strip_of(const struct gd_mesh *mesh, const struct gd_path *path,
                                            const struct gd_control *control,
                                            struct gd_flat_strip *out);

#ifdef __cplusplus
}
#endif

#endif
