/* View: finds a direction from which most of a path, or of a set of points, is visible. */
#ifndef GD_RENDER_VIEW_H
#define GD_RENDER_VIEW_H

#include "render/depth_buffer.h"

/* Positions on the surface, at least one, in the normalised unit; borrowed. */
struct gd__subject {
    const struct gd_vec3 *points;
    uint32_t count;
    bool is_path; /* the points are a polyline */
};

/* Tries the iso view, then others around the surface, at a small size, until 95 % of the subject is
 * visible. Sets *out to the best direction. Errors: GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED,
 * GD_DEADLINE. Cost: O(faces) for each of up to 16 directions. */
GD_MUST_USE enum gd_status gd__view_choose(const struct gd_mesh *mesh, struct gd_vec3 up,
                                           const struct gd__subject *subject,
                                           struct gd__budget *budget,
                                           const struct gd_control *control, struct gd_vec3 *out);

#endif
