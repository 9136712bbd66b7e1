/* Patch: the triangles that fill one hole, refined and smoothed. */
#pragma once

#include "gd/edit.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gd__patch {
    /* in the unit box; the vertices of the loop come first and are not moved */
    double (*positions)[3];
    uint32_t position_count, loop_count;
    uint32_t *corners; /* vertex numbers, three for each triangle */
    uint32_t face_count;
};

struct gd__patch_options {
    bool is_smooth; /* true if the new vertices are moved, so that the patch is smooth */
    /* returns true if an edge outside the patch joins two vertices of the loop */
    bool (*is_taken)(const void *user, uint32_t a, uint32_t b);
    const void *user;
};

/* Divides the triangles of a rough patch that are large compared with the edges of the loop. The
 * caller frees the arrays of `*out`. Errors: GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE,
 * GD_NON_MANIFOLD_EDGE (OpenMesh rejects triangles). */
GD_MUST_USE enum gd_status gd__patch_refine(const struct gd__patch *rough,
                                            const struct gd__patch_options *options,
                                            const struct gd_control *control,
                                            struct gd__patch *out);

#ifdef __cplusplus
}
#endif
