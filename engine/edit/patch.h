/* Patch: the triangles that fill one hole, refined and smoothed. */
#ifndef GD_EDIT_PATCH_H
#define GD_EDIT_PATCH_H

#include "gd/edit.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd__patch {
    double (*positions)[3]; /* in the unit box; the vertices of the loop come first and are fixed */
    uint32_t position_count, loop_count;
    uint32_t *corners; /* three for each triangle */
    uint32_t face_count;
};

/* Divides triangles that are large compared with the edges of the loop, and moves the new vertices
 * so that the patch is smooth. `is_taken(user, a, b)` returns true if an edge outside the patch
 * joins two vertices of the loop. Replaces the arrays, which must be malloc'ed. On failure the
 * patch is unchanged: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE, GD_NON_MANIFOLD_EDGE (OpenMesh
 * rejects triangles). */
GD_MUST_USE enum gd_status gd__patch_refine(struct gd__patch *patch,
                                            bool (*is_taken)(const void *user, uint32_t a,
                                                             uint32_t b),
                                            const void *user, const struct gd_control *control);

#ifdef __cplusplus
}
#endif

#endif
