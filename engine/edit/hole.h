/* Hole: one boundary loop, and the patch of triangles that fills it. */
#ifndef GD_EDIT_HOLE_H
#define GD_EDIT_HOLE_H

#include "base/pace.h"
#include "edit/patch.h"

struct gd__hole {
    const struct gd_mesh *mesh;
    uint32_t *vertex; /* internal numbers of the vertices, in the order of the boundary sides */
    uint32_t count;
    struct gd__patch rough; /* the triangulation of least area */
    struct gd__patch patch; /* the final patch */
};

/* Reads a boundary loop. Errors: GD_NO_MEMORY. */
GD_MUST_USE enum gd_status gd__hole_read(const struct gd_mesh *mesh, uint32_t loop,
                                         struct gd__hole *out);
void gd__hole_free(struct gd__hole *hole);

/* Computes the rough patch. Errors: GD_NOT_TRIANGULABLE (all triangulations have flat triangles),
 * GD_NO_MEMORY, GD_CANCELLED, GD_DEADLINE. For n edges: O(n^3) time and 10 n^2 bytes. */
GD_MUST_USE enum gd_status gd__hole_triangulate(struct gd__hole *hole, struct gd__pace *pace,
                                                struct gd_detail *detail);

/* Computes the final patch from the rough one. Tries three forms: refined and smoothed, only
 * refined, and unchanged. Keeps the first form whose faces do not cross. Errors:
 * GD_NOT_TRIANGULABLE (faces cross in all three forms), GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. */
GD_MUST_USE enum gd_status gd__hole_finish(struct gd__hole *hole, const struct gd_control *control,
                                           struct gd_detail *detail);

/* Returns GD_NOT_TRIANGULABLE. Writes the text "a hole of 7 edges <reason>" and the vertices of the
 * hole to the detail. */
enum gd_status gd__hole_refuse(const struct gd__hole *hole, struct gd_detail *detail,
                               const char *reason);

#endif
