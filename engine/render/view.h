/* View: finds a direction from which most of a path is visible. */
#ifndef GD_RENDER_VIEW_H
#define GD_RENDER_VIEW_H

#include "render/depth_buffer.h"

/* Tries the iso view, then others around the surface, at a small size, until 95 % of the path is
 * visible. Sets *out to the best direction. The path is given by at least one position. Errors:
 * GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: up to 16 times O(faces). */
GD_MUST_USE enum gd_status gd__view_choose(const struct gd_mesh *mesh, struct gd_vec3 up,
                                           const struct gd_vec3 *path, uint32_t count,
                                           struct gd__budget *budget,
                                           const struct gd_control *control, struct gd_vec3 *out);

#endif
