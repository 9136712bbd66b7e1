/* View: the direction from which most of a path can be seen. */
#ifndef GD_RENDER_VIEW_H
#define GD_RENDER_VIEW_H

#include "render/cover.h"

/* Tries the iso view, then others around the surface, at a small size, until all but a twentieth of
 * the path is seen, and keeps the best: `*out` is the direction. The path is given by its positions
 * inside the mesh, at least one. GD_NO_MEMORY, GD_BUDGET, GD_CANCELLED, GD_DEADLINE. Cost: up to 16
 * times O(faces). */
GD_MUST_USE enum gd_status gd__view_choose(const struct gd_mesh *mesh, struct gd_vec3 up,
                                           const struct gd_vec3 *path, uint32_t count,
                                           struct gd__budget *budget,
                                           const struct gd_control *control, struct gd_vec3 *out);

#endif
